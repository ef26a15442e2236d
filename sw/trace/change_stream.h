#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace stereotlm::trace {

// Changes of the values of signals in the order of their times. They are kept in memory while they are few, else in a
// temporary file without a name, which vanishes with the object or with the process. All functions throw
// std::runtime_error if a byte cannot be stored.
class ChangeStream {
 public:
  struct Change {
    std::uint64_t time_ps;
    std::uint32_t signal;
    std::uint32_t value;
  };

  // The temporary file is made in the folder of this file, which messages name.
  explicit ChangeStream(std::filesystem::path beside) : beside_(std::move(beside)) {}
  ~ChangeStream();
  ChangeStream(const ChangeStream&) = delete;
  ChangeStream& operator=(const ChangeStream&) = delete;

  // Times must not decrease.
  void add(std::uint64_t time_ps, std::uint32_t signal, std::uint32_t value) {
    if (time_ps != time_ps_ || is_empty_) add_time(time_ps);
    add_record({signal, value});
  }

  // Goes to the first change. Nothing may be added after it.
  void rewind();
  // The current change.
  const Change& change() const { return change_; }
  bool at_end() const { return at_end_; }
  void advance() {
    while (next_ != buffer_.size() || load()) {
      const Record& record = buffer_[next_++];
      if ((record.signal & kIsTime) == 0) {
        change_.signal = record.signal;
        change_.value = record.value;
        return;
      }
      change_.time_ps = static_cast<std::uint64_t>(record.signal & ~kIsTime) << 32U | record.value;
    }
    at_end_ = true;
  }

 private:
  // A change, or, with kIsTime, the upper and the lower half of the time of the next changes.
  struct Record {
    std::uint32_t signal;
    std::uint32_t value;
  };
  static constexpr std::uint32_t kIsTime = 0x80000000;
  static constexpr std::size_t kRecords = std::size_t{1} << 17U;  // of the buffer: 1 MiB

  void add_time(std::uint64_t time_ps);
  void add_record(Record record) {
    buffer_.push_back(record);
    if (buffer_.size() == kRecords) store();
  }
  void store();
  bool load();
  [[noreturn]] void fail() const;

  std::filesystem::path beside_;
  int file_ = -1;
  std::vector<Record> buffer_;
  bool is_empty_ = true;
  std::uint64_t time_ps_ = 0;
  // While the changes are read.
  std::size_t next_ = 0;
  Change change_{};
  bool at_end_ = false;
};

}  // namespace stereotlm::trace
