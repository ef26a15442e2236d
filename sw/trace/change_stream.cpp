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
  constexpr std::size_t kBufferBytes = std::size_t{1} << 18U;
  std::string name = (beside_.parent_path() / ".changes_XXXXXX").string();
  const int descriptor = mkostemp(name.data(), O_CLOEXEC);
  if (descriptor < 0) fail();
  unlink(name.c_str());
  file_ = fdopen(descriptor, "w+b");
  std::setvbuf(file_, nullptr, _IOFBF, kBufferBytes);
}

void ChangeStream::fail() const {
  throw std::runtime_error(fmt::format("{}: temporary file: {}", beside_.string(), std::strerror(errno)));
}

void ChangeStream::add(std::uint64_t time_ps, std::uint32_t signal, std::uint32_t value) {
  const Change change = {time_ps, signal, value};
  if (fwrite_unlocked(&change, sizeof change, 1, file_) != 1) fail();
}

void ChangeStream::rewind() {
  if (std::fflush(file_) != 0 || std::fseek(file_, 0, SEEK_SET) != 0) fail();
  advance();
}

void ChangeStream::advance() {
  if (fread_unlocked(&change_.emplace(), sizeof(Change), 1, file_) == 1) return;
  if (ferror_unlocked(file_) != 0) fail();
  change_.reset();
}

}  // namespace stereotlm::trace
