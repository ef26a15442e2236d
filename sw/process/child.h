#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include "sw/process/child_process.h"

namespace stereotlm::process {

// A child process that does one piece of work and sends messages about it. Simulations run in such processes,
// because a process can elaborate SystemC only once. A fork starts faster than a program, because all
// libraries are already loaded.
class Child {
 public:
  using Tell = std::function<void(const std::string& message)>;

  // Forks. The child has a copy of everything but the threads (see ChildProcess). It runs `work` and exits.
  // Throws std::system_error if the system cannot fork.
  explicit Child(const std::function<void(const Tell& tell)>& work);

  // Waits until next() would return without waiting, a signal has been caught, or the time is over. Returns
  // true in the first case.
  bool has_news(std::chrono::milliseconds wait);
  // Waits for the next message. Returns nullopt once the work is done. If the child fails, throws
  // std::runtime_error with the text of the exception that `work` threw, std::bad_alloc if it threw that, or
  // EndedBySignal if a signal ended the child.
  std::optional<std::string> next();

 private:
  [[noreturn]] void throw_end();

  Pipe messages_;
  ChildProcess process_;
};

}  // namespace stereotlm::process
