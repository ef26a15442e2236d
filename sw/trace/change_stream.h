#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>

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
  void add(std::uint64_t time_ps, std::uint32_t signal, std::uint32_t value);
  // Goes to the first change. Nothing may be added after it.
  void rewind();
  // The current change; nullopt behind the last one.
  const std::optional<Change>& change() const { return change_; }
  void advance();

 private:
  [[noreturn]] void fail() const;

  std::filesystem::path beside_;
  std::FILE* file_;
  std::optional<Change> change_;
};

}  // namespace stereotlm::trace
