#include "sw/process/child.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <exception>
#include <new>
#include <stdexcept>
#include <system_error>

namespace stereotlm::process {
namespace {

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

// Runs the work in the child; returns its exit status.
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
    failure = error.what();
  } catch (...) {
    failure = "an exception of an unknown type";
  }
  send(to, Kind::kFailure, failure);
  return 1;
}

}  // namespace

Child::Child(const std::function<void(const Tell& tell)>& work)
    : process_([&] {
        messages_.close_read_end();
        return run_child(work, messages_.write_end());
      }) {
  messages_.close_write_end();
}

bool Child::has_news(std::chrono::milliseconds wait) {
  pollfd messages = {messages_.read_end(), POLLIN, 0};
  // A caught signal ends poll() even with SA_RESTART.
  const int ready = poll(&messages, 1, static_cast<int>(wait.count()));
  if (ready < 0 && errno != EINTR) throw std::system_error(errno, std::generic_category(), "poll");
  return ready > 0;
}

std::optional<std::string> Child::next() {
  Header header;
  if (!read_all(messages_.read_end(), &header, sizeof header)) throw_end();
  std::string text(header.bytes, '\0');
  if (!read_all(messages_.read_end(), text.data(), text.size())) throw_end();
  if (header.kind == Kind::kMessage) return text;
  if (header.kind == Kind::kOutOfMemory) throw std::bad_alloc();
  if (header.kind == Kind::kFailure) throw std::runtime_error(text);
  return std::nullopt;
}

void Child::throw_end() {
  const int status = process_.wait();
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    throw EndedBySignal(fmt::format("the process was ended by signal {} ({})", signal, strsignal(signal)),
                        signal);
  }
  throw std::runtime_error(
      fmt::format("the process ended with status {} before its work was done", WEXITSTATUS(status)));
}

}  // namespace stereotlm::process
