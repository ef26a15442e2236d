#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
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
  explicit ChangeStream(std::filesystem::path beside);
  ~ChangeStream() { std::fclose(file_); }
  ChangeStream(const ChangeStream&) = delete;
  ChangeStream& operator=(const ChangeStream&) = delete;

  // Times must not decrease.
  void add(std::uint64_t time_ps, std::uint32_t signal, std::uint32_t value) {
    buffer_.push_back({time_ps, signal, value});
    if (buffer_.size() == kBuffered) store();
  }
  // Goes to the first change. Nothing may be added after it.
  void rewind();
  // The current change; null behind the last one.
  const Change* change() const { return change_; }
  void advance() {
    if (next_ == buffer_.size()) load();
    change_ = next_ == buffer_.size() ? nullptr : &buffer_[next_++];
  }

 private:
  static constexpr std::size_t kBuffered = std::size_t{1} << 16U;  // changes

  void store();
  void load();
  [[noreturn]] void fail() const;

  std::filesystem::path beside_;
  std::FILE* file_;
  std::vector<Change> buffer_;
  // While the changes are read.
  std::size_t next_ = 0;  // in the buffer
  const Change* change_ = nullptr;
};

}  // namespace stereotlm::trace
