#pragma once

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace stereotlm::trace {

// Changes of the values of signals in the order of their times. They wait in a temporary file without a name,
// which vanishes with the object or with the process. All functions throw std::runtime_error if a byte cannot
// be stored.
class ChangeStream {
 public:
  struct Change {
    std::uint64_t time_ps;
    std::uint32_t signal;
    std::uint32_t value;
  };

  // The temporary file is made in the folder of this file, which messages name.
  explicit ChangeStream(std::filesystem::path beside) : beside_(std::move(beside)) {
    std::string name = (beside_.parent_path() / ".changes_XXXXXX").string();
    const int descriptor = mkostemp(name.data(), O_CLOEXEC);
    if (descriptor < 0) fail();
    unlink(name.c_str());
    file_ = fdopen(descriptor, "w+b");
    std::setvbuf(file_, nullptr, _IONBF, 0);
  }
  ~ChangeStream() { std::fclose(file_); }
  ChangeStream(const ChangeStream&) = delete;
  ChangeStream& operator=(const ChangeStream&) = delete;

  // Times must not decrease.
  void add(std::uint64_t time_ps, std::uint32_t signal, std::uint32_t value) {
    buffer_.push_back({time_ps, signal, value});
    if (buffer_.size() == kBuffered) store();
  }
  // Goes to the first change. Nothing may be added after it.
  void rewind() {
    store();
    if (std::fseek(file_, 0, SEEK_SET) != 0) fail();
    load();
  }
  // The current change; null behind the last one.
  const Change* change() const { return next_ != buffer_.size() ? &buffer_[next_] : nullptr; }
  void advance() {
    if (++next_ == buffer_.size()) load();
  }

 private:
  static constexpr std::size_t kBuffered = std::size_t{1} << 16U;

  void store() {
    if (buffer_.empty()) return;
    if (std::fwrite(buffer_.data(), sizeof(Change), buffer_.size(), file_) != buffer_.size()) fail();
    buffer_.clear();
  }
  // Leaves the buffer empty at the end of the file.
  void load() {
    buffer_.resize(kBuffered);
    buffer_.resize(std::fread(buffer_.data(), sizeof(Change), kBuffered, file_));
    if (std::ferror(file_) != 0) fail();
    next_ = 0;
  }
  [[noreturn]] void fail() const {
    throw std::runtime_error(fmt::format("{}: temporary file: {}", beside_.string(), std::strerror(errno)));
  }

  std::filesystem::path beside_;
  std::FILE* file_;
  std::vector<Change> buffer_;
  std::size_t next_ = 0;  // of the buffer, while the changes are read
};

}  // namespace stereotlm::trace
