#include "sw/trace/change_stream.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/types.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>

namespace stereotlm::trace {

ChangeStream::~ChangeStream() {
  if (file_ >= 0) close(file_);
}

void ChangeStream::fail() const {
  throw std::runtime_error(fmt::format("{}: temporary file: {}", beside_.string(), std::strerror(errno)));
}

void ChangeStream::add_time(std::uint64_t time_ps) {
  is_empty_ = false;
  time_ps_ = time_ps;
  add_record({kIsTime | static_cast<std::uint32_t>(time_ps >> 32U), static_cast<std::uint32_t>(time_ps)});
}

// Appends the buffer to the file.
void ChangeStream::store() {
  if (file_ < 0) {
    buffer_.reserve(kRecords);
    std::string name = (beside_.parent_path() / ".changes_XXXXXX").string();
    file_ = mkostemp(name.data(), O_CLOEXEC);
    if (file_ < 0) fail();
    unlink(name.c_str());
  }
  const auto* bytes = reinterpret_cast<const char*>(buffer_.data());
  std::size_t left = buffer_.size() * sizeof(Record);
  while (left > 0) {
    const ssize_t count = write(file_, bytes, left);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) fail();
    bytes += count;
    left -= static_cast<std::size_t>(count);
  }
  buffer_.clear();
}

void ChangeStream::rewind() {
  if (file_ >= 0) {
    store();
    if (lseek(file_, 0, SEEK_SET) != 0) fail();
  }
  advance();
}

// Fills the buffer from the file. Returns false at the end of the file.
bool ChangeStream::load() {
  if (file_ < 0) return false;
  buffer_.resize(kRecords);
  auto* const bytes = reinterpret_cast<char*>(buffer_.data());
  std::size_t size = 0;
  while (size < kRecords * sizeof(Record)) {
    const ssize_t count = read(file_, bytes + size, kRecords * sizeof(Record) - size);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail();
    if (count == 0) break;
    size += static_cast<std::size_t>(count);
  }
  buffer_.resize(size / sizeof(Record));
  next_ = 0;
  return !buffer_.empty();
}

}  // namespace stereotlm::trace
