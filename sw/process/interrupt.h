#pragma once

#include <csignal>
#include <initializer_list>

namespace stereotlm::process {

// Whether the first Ctrl-C (SIGINT) or SIGTERM was caught. A signal handler may write only to a variable of
// this type.
inline volatile std::sig_atomic_t caught_interrupt = 0;

// From now on the first Ctrl-C (SIGINT) and the first SIGTERM are recorded instead of ending the process; a
// second one ends it. A signal that the caller has set to be ignored stays ignored.
inline void catch_interrupts() {
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

// Whether such a signal has been recorded.
inline bool interrupted() { return caught_interrupt != 0; }

}  // namespace stereotlm::process
