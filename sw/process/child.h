#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "sw/process/child_process.h"

namespace stereotlm::process {

// A child process for one piece of work that tells this one about it, message by message. SystemC elaborates
// once a process; forked from one that has everything loaded, a run begins without the start of a program.
class Child {
 public:
  using Tell = std::function<void(const std::string& message)>;

  // Forks. The child has a copy of everything but the threads, as explore::ChildProcess says, does the work,
  // and leaves. Throws std::system_error if there can be no child.
  explicit Child(const std::function<void(const Tell& tell)>& work);

  // Waits for as long at most, or until a signal has been caught, and tells whether next() has something to
  // say.
  bool has_news(std::chrono::milliseconds wait);
  // Waits for the next message; nothing once the work is done. Throws std::runtime_error that says how the
  // child has failed: what it threw; explore::EndedBySignal if a signal has ended it; std::bad_alloc if it
  // threw that.
  std::optional<std::string> next();

 private:
  [[noreturn]] void throw_end();

  Pipe messages_;
  ChildProcess process_;
};

}  // namespace stereotlm::process
