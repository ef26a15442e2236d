#include "sw/simulation/child.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <system_error>

#include "sw/explore/ended_by_signal.h"

namespace stereotlm::simulation {
namespace {

enum class Kind : std::uint8_t { kMessage, kDone, kFailure };

struct Header {
  Kind kind = Kind::kDone;
  std::uint64_t bytes = 0;
};

[[noreturn]] void throw_errno(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

void write_all(int to, const void* bytes, std::size_t count) {
  const char* next = static_cast<const char*>(bytes);
  while (count > 0) {
    const ssize_t written = write(to, next, count);
    if (written < 0 && errno != EINTR) _exit(1);  // nobody listens any more
    if (written < 0) continue;
    next += written;
    count -= static_cast<std::size_t>(written);
  }
}

void send(int to, Kind kind, const std::string& text) {
  const Header header = {kind, text.size()};
  write_all(to, &header, sizeof header);
  write_all(to, text.data(), text.size());
}

// False at the end.
bool read_all(int from, void* bytes, std::size_t count) {
  char* next = static_cast<char*>(bytes);
  while (count > 0) {
    const ssize_t got = read(from, next, count);
    if (got < 0 && errno != EINTR) throw_errno("read");
    if (got == 0) return false;
    if (got < 0) continue;
    next += got;
    count -= static_cast<std::size_t>(got);
  }
  return true;
}

[[noreturn]] void be_child(const std::function<void(const Child::Tell&)>& work, int to) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::string failure;
  try {
    work([to](const std::string& message) { send(to, Kind::kMessage, message); });
    send(to, Kind::kDone, "");
    _exit(0);
  } catch (const std::exception& error) {
    failure = error.what();
  } catch (...) {
    failure = "an exception of an unknown type";
  }
  send(to, Kind::kFailure, failure);
  _exit(1);
}

}  // namespace

Child::Child(const std::function<void(const Tell& tell)>& work) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw_errno("pipe2");
  std::fflush(nullptr);  // or both processes would write what is in the buffers
  pid_ = fork();
  if (pid_ < 0) {
    const int error = errno;
    close(ends[0]);
    close(ends[1]);
    errno = error;
    throw_errno("fork");
  }
  if (pid_ == 0) {
    close(ends[0]);
    be_child(work, ends[1]);
  }
  close(ends[1]);
  messages_ = ends[0];
}

Child::~Child() {
  close(messages_);
  if (pid_ < 0) return;
  kill(pid_, SIGKILL);
  while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

bool Child::has_news(std::chrono::milliseconds wait) {
  pollfd messages = {messages_, POLLIN, 0};
  const int ready =
      poll(&messages, 1, static_cast<int>(wait.count()));  // a signal ends it, whatever its flags
  if (ready < 0 && errno != EINTR) throw_errno("poll");
  return ready > 0;
}

std::optional<std::string> Child::next() {
  Header header;
  if (!read_all(messages_, &header, sizeof header)) throw_end();
  std::string text(header.bytes, '\0');
  if (!read_all(messages_, text.data(), text.size())) throw_end();
  if (header.kind == Kind::kMessage) return text;
  if (header.kind == Kind::kFailure) throw std::runtime_error(text);
  return std::nullopt;
}

void Child::throw_end() {
  int status = 0;
  while (waitpid(pid_, &status, 0) < 0) {
    if (errno != EINTR) throw_errno("waitpid");
  }
  pid_ = -1;
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    throw explore::EndedBySignal(
        fmt::format("the process was ended by signal {} ({})", signal, strsignal(signal)), signal);
  }
  throw std::runtime_error(
      fmt::format("the process ended with status {} before its work was done", WEXITSTATUS(status)));
}

}  // namespace stereotlm::simulation
