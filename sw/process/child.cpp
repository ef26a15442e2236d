#include "sw/process/child.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <system_error>

#include "sw/process/client.h"
#include "sw/process/problems.h"

namespace stereotlm::process {
namespace {

[[noreturn]] void throw_errno(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

enum class Kind : std::uint8_t { kMessage, kDone, kFailure, kOutOfMemory };

struct Header {
  Kind kind = Kind::kDone;
  std::uint64_t bytes = 0;
};

void send(int to, Kind kind, const std::string& text) {
  const Header header = {kind, text.size()};
  const bool is_heard = write_all(to, &header, sizeof header) && write_all(to, text.data(), text.size());
  if (!is_heard) _exit(1);
}

int run_child(const std::function<void(const Child::Tell&)>& work, int to) {
  std::string failure;
  try {
    work([to](const std::string& message) { send(to, Kind::kMessage, message); });
    send(to, Kind::kDone, "");
    return 0;
  } catch (const std::bad_alloc&) {
    send(to, Kind::kOutOfMemory, "");
    return 1;
  } catch (const std::exception& error) {
    failure = text_of(error);
  } catch (...) {
    failure = "an exception of an unknown type";
  }
  send(to, Kind::kFailure, failure);
  return 1;
}

std::string text_of_end(int status) {
  if (!WIFSIGNALED(status))
    return fmt::format("the process ended with status {} before its work was done", WEXITSTATUS(status));
  return fmt::format("the process was ended by signal {} ({})", WTERMSIG(status),
                     strsignal(WTERMSIG(status)));
}

}  // namespace

ChildDied::ChildDied(int status)
    : std::runtime_error(text_of_end(status)),
      how_(WIFSIGNALED(status)
               ? fmt::format("ended with signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)))
               : fmt::format("ended with exit status {}", WEXITSTATUS(status))),
      signal_(WIFSIGNALED(status) ? WTERMSIG(status) : 0) {}

bool read_all(int from, void* bytes, std::size_t count) {
  char* next = static_cast<char*>(bytes);
  while (count > 0) {
    const ssize_t got = read(from, next, count);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw_errno("read");
    if (got == 0) return false;
    next += got;
    count -= static_cast<std::size_t>(got);
  }
  return true;
}

bool write_all(int to, const void* bytes, std::size_t count) {
  const char* next = static_cast<const char*>(bytes);
  while (count > 0) {
    const ssize_t written = write(to, next, count);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    next += written;
    count -= static_cast<std::size_t>(written);
  }
  return true;
}

Pipe::Pipe() {
  if (pipe2(ends_.data(), O_CLOEXEC) != 0) throw_errno("pipe2");
}

Pipe::~Pipe() {
  close_read_end();
  close_write_end();
}

void Pipe::close_end(std::size_t end) {
  if (ends_[end] >= 0) close(ends_[end]);
  ends_[end] = -1;
}

pid_t fork_bound() {
  const pid_t parent = getpid();
  std::fflush(nullptr);  // otherwise both processes would write the contents of the buffers
  const pid_t forked = fork();
  if (forked < 0) throw_errno("fork");
  if (forked > 0) return forked;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // the parent ended before prctl()
  return 0;
}

Child::Child(const std::function<void(const Tell& tell)>& work) {
  pid_ = fork_bound();
  if (pid_ > 0) {
    messages_.close_write_end();
    return;
  }
  messages_.close_read_end();
  client = nullptr;  // only the parent may write to it
  _exit(run_child(work, messages_.write_end()));
}

Child::~Child() {
  if (pid_ < 0) return;
  kill(pid_, SIGKILL);
  while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

bool Child::has_news(std::chrono::milliseconds wait) {
  pollfd messages = {messages_.read_end(), POLLIN, 0};
  // A caught signal ends poll() even with SA_RESTART.
  const int ready = poll(&messages, 1, static_cast<int>(wait.count()));
  if (ready < 0 && errno != EINTR) throw_errno("poll");
  return ready > 0;
}

std::optional<std::string> Child::next() {
  Header header;
  std::string text;
  bool is_whole = read_all(messages_.read_end(), &header, sizeof header);
  text.resize(header.bytes);
  is_whole = is_whole && read_all(messages_.read_end(), text.data(), text.size());
  if (!is_whole) {
    int status = 0;
    while (waitpid(pid_, &status, 0) < 0) {
      if (errno != EINTR) throw_errno("waitpid");
    }
    pid_ = -1;
    throw ChildDied(status);
  }
  if (header.kind == Kind::kMessage) return text;
  if (header.kind == Kind::kOutOfMemory) throw std::bad_alloc();
  if (header.kind == Kind::kFailure) throw std::runtime_error(text);
  return std::nullopt;
}

}  // namespace stereotlm::process
