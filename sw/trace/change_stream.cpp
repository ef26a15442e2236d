#include "sw/trace/change_stream.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

namespace stereotlm::trace {

ChangeStream::ChangeStream(std::filesystem::path beside) : beside_(std::move(beside)) {
  std::string name = (beside_.parent_path() / ".changes_XXXXXX").string();
  const int descriptor = mkostemp(name.data(), O_CLOEXEC);
  if (descriptor < 0) fail();
  unlink(name.c_str());
  file_ = fdopen(descriptor, "w+b");
  std::setvbuf(file_, nullptr, _IONBF, 0);
}

void ChangeStream::fail() const {
  throw std::runtime_error(fmt::format("{}: temporary file: {}", beside_.string(), std::strerror(errno)));
}

void ChangeStream::store() {
  if (std::fwrite(buffer_.data(), sizeof(Record), buffer_.size(), file_) != buffer_.size()) fail();
  buffer_.clear();
}

void ChangeStream::rewind() {
  store();
  if (std::fseek(file_, 0, SEEK_SET) != 0) fail();
  advance();
}

// Leaves the buffer empty at the end of the file, and returns false then.
bool ChangeStream::load() {
  buffer_.resize(kBuffered);
  buffer_.resize(std::fread(buffer_.data(), sizeof(Record), kBuffered, file_));
  if (std::ferror(file_) != 0) fail();
  next_ = 0;
  return !buffer_.empty();
}

}  // namespace stereotlm::trace
