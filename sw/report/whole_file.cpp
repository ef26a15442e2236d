#include "sw/report/whole_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace stereotlm::report {
namespace {

[[noreturn]] void fail(int error, const std::filesystem::path& path) {
  throw std::system_error(error, std::generic_category(), path.string());
}

class Descriptor {
 public:
  Descriptor(const std::filesystem::path& path, int flags)
      : path_(path), value_(open(path.c_str(), flags, 0666)) {
    if (value_ < 0) fail(errno, path);
  }
  ~Descriptor() {
    if (value_ >= 0) ::close(value_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  void write(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t count = ::write(value_, bytes.data(), bytes.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) fail(errno, path_);
      if (count == 0) fail(ENOSPC, path_);
      bytes.remove_prefix(static_cast<std::size_t>(count));
    }
  }

  // File systems that have nothing to sync answer EINVAL or ENOTSUP.
  void sync() {
    if (fsync(value_) != 0 && errno != EINVAL && errno != ENOTSUP) fail(errno, path_);
  }

  void close() {
    const int closed = ::close(value_);
    value_ = -1;
    if (closed != 0 && errno != EINTR) fail(errno, path_);
  }

 private:
  const std::filesystem::path& path_;
  int value_;
};

}  // namespace

void write_whole_file(const std::filesystem::path& path, std::string_view bytes) {
  Descriptor file(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC);
  file.write(bytes);
  file.sync();
  file.close();
}

void sync_folder(const std::filesystem::path& folder) {
  Descriptor opened(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  opened.sync();
}

}  // namespace stereotlm::report
