#include "sw/process/streams.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "sw/process/child.h"
#include "sw/process/client.h"

namespace stereotlm::process {
namespace {

constexpr const char* kProgram = "stereotlm: ";
constexpr std::string_view kNote = "note:";
const std::array<std::pair<const char*, Colour>, 3> kKinds = {
    {{"error:", Colour::kRed}, {"warning:", Colour::kYellow}, {"note:", Colour::kDim}}};
constexpr std::array kCodes = {"31", "32", "33", "2"};  // in the order of Colour

bool notes_left_out = false;

}  // namespace

void print(std::string_view text) {
  if (client != nullptr) return client->print(text);
  if (!write_all(STDOUT_FILENO, text.data(), text.size()) && errno != EPIPE)
    throw std::runtime_error(std::string("standard output: ") + std::strerror(errno));
}

void say(const std::string& kind, const std::string& text) { say_line("stereotlm: " + kind + ": " + text); }

void say_line(const std::string& line) {
  std::string shown = line;
  for (const auto& [kind, colour] : kKinds) {
    const std::string head = std::string(kProgram) + kind;
    if (line.compare(0, head.size(), head) != 0) continue;
    if (notes_left_out && kind == kNote) return;
    shown = kProgram + coloured(STDERR_FILENO, colour, kind) + line.substr(head.size());
  }
  // The system's text does not name the limit.
  const bool is_of_limit = shown.find(std::strerror(EMFILE)) != std::string::npos;
  if (is_of_limit && shown.find("ulimit") == std::string::npos) shown += " (the limit: ulimit -n)";
  if (client != nullptr) return client->say(shown);
  std::fprintf(stderr, "%s\n", shown.c_str());
}

void leave_out_notes(bool left_out) { notes_left_out = left_out; }
bool leaves_out_notes() { return notes_left_out; }

std::string coloured(int descriptor, Colour colour, const std::string& text) {
  const auto value_of = [](const char* variable) {
    const char* const value = std::getenv(variable);
    return std::string_view(value == nullptr ? "" : value);
  };
  if (client != nullptr || isatty(descriptor) == 0 || !value_of("NO_COLOR").empty() ||
      value_of("TERM") == "dumb")
    return text;
  return std::string("\033[") + kCodes[static_cast<std::size_t>(colour)] + "m" + text + "\033[0m";
}

void prepare_streams() {
  // /dev/null is opened for the opposite direction, so that using the stream still fails.
  for (int descriptor = STDIN_FILENO; descriptor <= STDERR_FILENO; ++descriptor) {
    if (fcntl(descriptor, F_GETFD) >= 0) continue;
    static_cast<void>(open("/dev/null", descriptor == STDIN_FILENO ? O_WRONLY : O_RDONLY));
  }
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

void catch_interrupts() {
  struct sigaction action = {};
  action.sa_handler = [](int /*signal*/) { caught_interrupt = 1; };
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM}) {
    struct sigaction earlier = {};
    sigaction(signal, nullptr, &earlier);
    if (earlier.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
  }
}

}  // namespace stereotlm::process
