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
    if (time_ps != time_ps_)
      add_record({kIsTime | static_cast<std::uint32_t>(time_ps >> 32U), static_cast<std::uint32_t>(time_ps)});
    time_ps_ = time_ps;
    add_record({signal, value});
  }
  // Goes to the first change. Nothing may be added after it.
  void rewind();
  // The current change; null behind the last one.
  const Change* change() const { return is_at_end_ ? nullptr : &change_; }
  void advance() {
    while (next_ != buffer_.size() || load()) {
      const Record record = buffer_[next_++];
      if ((record.signal & kIsTime) == 0) {
        change_ = {time_ps_, record.signal, record.value};
        return;
      }
      time_ps_ = std::uint64_t{record.signal & ~kIsTime} << 32U | record.value;
    }
    is_at_end_ = true;
  }

 private:
  // A change at the time of the record before, or, with kIsTime, the upper and the lower half of the time of
  // the next changes. Half as many bytes as a Change are written.
  struct Record {
    std::uint32_t signal;
    std::uint32_t value;
  };
  static constexpr std::uint32_t kIsTime = 0x80000000;
  static constexpr std::size_t kBuffered = std::size_t{1} << 17U;  // records

  void add_record(Record record) {
    buffer_.push_back(record);
    if (buffer_.size() == kBuffered) store();
  }
  void store();
  bool load();
  [[noreturn]] void fail() const;

  std::filesystem::path beside_;
  std::FILE* file_;
  std::vector<Record> buffer_;
  std::uint64_t time_ps_ = UINT64_MAX;  // of the last record
  // While the changes are read.
  std::size_t next_ = 0;  // in the buffer
  Change change_{};
  bool is_at_end_ = false;
};

}  // namespace stereotlm::trace
