#pragma once

#include <sys/types.h>

#include <chrono>
#include <functional>
#include <optional>
#include <string>

namespace stereotlm::simulation {

// A child process for one piece of work that tells this one about it, message by message. SystemC elaborates once a
// process; forked from one that has everything loaded, a run begins without the start of a program.
class Child {
 public:
  using Tell = std::function<void(const std::string& message)>;

  // Forks. The child has a copy of everything but the threads (open files are the same, with their
  // positions), does the work, and leaves without running destructors of static objects. It ends with this
  // process. Throws std::system_error if there can be no child.
  explicit Child(const std::function<void(const Tell& tell)>& work);
  // Ends it if it still works.
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  // Waits for as long at most, or until a signal has been caught, and tells whether next() has something to
  // say.
  bool has_news(std::chrono::milliseconds wait);
  // Waits for the next message; nothing once the work is done. Throws std::runtime_error that says how the child has
  // failed: what it threw; explore::EndedBySignal if a signal has ended it.
  std::optional<std::string> next();

 private:
  [[noreturn]] void throw_end();

  pid_t pid_ = -1;
  int messages_ = -1;
};

}  // namespace stereotlm::simulation
