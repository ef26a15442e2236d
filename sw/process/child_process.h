#pragma once

#include <sys/types.h>

#include <array>
#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>

namespace stereotlm::process {

// Thrown if a signal has ended a child process.
class EndedBySignal : public std::runtime_error {
 public:
  EndedBySignal(const std::string& text, int signal) : std::runtime_error(text), signal_(signal) {}
  int signal() const { return signal_; }

 private:
  int signal_;
};

// Reads `count` bytes; caught signals do not end the read. Returns false at the end of the file. Throws
// std::system_error.
bool read_all(int from, void* bytes, std::size_t count);
// Writes all bytes; caught signals do not end the write. Returns false if the read end is closed; where
// SIGPIPE is not ignored, that signal ends this process instead.
bool write_all(int to, const void* bytes, std::size_t count);

// A pipe that programs started by exec do not inherit. The destructor closes the ends that are still open.
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

// A child process, forked from this process. It is killed when this process ends.
class ChildProcess {
 public:
  // Forks. The child has a copy of everything but the threads; it shares open files and their positions with
  // this process. It runs `work`, which must not throw, and exits with the status that `work` returns,
  // without running destructors of static objects. Throws std::system_error if the system cannot fork.
  explicit ChildProcess(const std::function<int()>& work);
  // Kills the child if it still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // Waits until the child has ended, and returns its status as waitpid() gives it. May be called once. Throws
  // std::system_error.
  int wait();

 private:
  pid_t pid_ = -1;  // -1 after wait()
};

}  // namespace stereotlm::process
