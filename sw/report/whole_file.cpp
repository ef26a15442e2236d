#include "sw/report/whole_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>
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

std::string read_whole_file(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  const auto refuse = [&path](const std::string& cause) {
    throw std::runtime_error("'" + path.string() + "': " + cause);
  };
  std::error_code error;
  const auto status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) refuse("no such file");
  if (error) refuse(error.message());
  if (!fs::is_regular_file(status)) refuse("must be a regular file");
  std::ifstream file(path, std::ios::binary);
  std::string content((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (!file.is_open() || file.bad()) refuse(std::strerror(errno));
  return content;
}

void replace_file(const std::filesystem::path& path, std::string_view bytes) {
  const std::filesystem::path aside = path.string() + ".part";
  std::filesystem::remove(aside);
  write_whole_file(aside, bytes);
  std::filesystem::rename(aside, path);
}

void sync_folder(const std::filesystem::path& folder) {
  Descriptor opened(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  opened.sync();
}

}  // namespace stereotlm::report
