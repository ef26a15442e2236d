#pragma once

#include <sys/types.h>

#include <array>
#include <cstddef>
#include <functional>

namespace stereotlm::process {

// All bytes, whatever signals are caught meanwhile. False at the end; throws std::system_error.
bool read_all(int from, void* bytes, std::size_t count);
// False if nobody reads them any more: where SIGPIPE is ignored, else that ends the process.
bool write_all(int to, const void* bytes, std::size_t count);

// A pipe that no other program gets. What is not closed before is closed with it.
class Pipe {
 public:
  Pipe();  // throws std::system_error
  ~Pipe();
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  int read_end() const { return ends_[0]; }
  int write_end() const { return ends_[1]; }
  void close_read_end() { close_end(0); }
  void close_write_end() { close_end(1); }

 private:
  void close_end(std::size_t end);

  std::array<int, 2> ends_{-1, -1};
};

// A process that is forked from this one, and never outlives it.
class ChildProcess {
 public:
  // Forks. The child has a copy of everything but the threads (open files are the same, with their
  // positions), does the work, which must not throw, and leaves with the status that it gives, without
  // running destructors of static objects. Throws std::system_error if there can be no child.
  explicit ChildProcess(const std::function<int()>& work);
  // Ends it if it still works.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // Waits for its end, once; gives its status as waitpid() does. Throws std::system_error.
  int wait();

 private:
  pid_t pid_ = -1;  // -1: it has been waited for
};

}  // namespace stereotlm::process
