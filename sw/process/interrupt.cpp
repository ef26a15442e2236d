#include "sw/process/interrupt.h"

#include <csignal>
#include <initializer_list>

namespace stereotlm::process {
namespace {

// A signal handler may write only to a variable of this type.
volatile std::sig_atomic_t caught = 0;

void record(int /*signal*/) { caught = 1; }

}  // namespace

void catch_interrupts() {
  struct sigaction action = {};
  action.sa_handler = record;
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM}) {
    struct sigaction earlier = {};
    sigaction(signal, nullptr, &earlier);
    if (earlier.sa_handler != SIG_IGN) sigaction(signal, &action, nullptr);
  }
}

bool interrupted() { return caught != 0; }

}  // namespace stereotlm::process
