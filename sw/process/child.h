#pragma once

#include <sys/types.h>

#include <array>
#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>

namespace stereotlm::process {

// Thrown if a child process has died before its work was done.
class ChildDied : public std::runtime_error {
 public:
  explicit ChildDied(int status);  // as waitpid() gives it
  // "ended with signal 9 (Killed)", "ended with exit status 3".
  const std::string& how() const { return how_; }
  int signal() const { return signal_; }  // 0: the process has exited

 private:
  std::string how_;
  int signal_;
};

// Reads `count` bytes; signals do not end the read. False at the end of the file. Throws std::system_error.
bool read_all(int from, void* bytes, std::size_t count);
// Writes all bytes; caught signals do not end the write. Returns false, with the error in `errno`, if that
// fails. If the read end is closed, SIGPIPE ends this process unless it is ignored.
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

// Forks a process that is killed when this one ends. To be called on the main thread: the end of the thread
// counts. Returns what fork() returns. Throws std::system_error if the system cannot fork.
pid_t fork_bound();

// A child process that does one piece of work and sends messages about it. Simulations run in such processes,
// because a process can elaborate SystemC only once. A fork starts faster than a program, because all
// libraries are already loaded. The child is killed when this process ends.
class Child {
 public:
  using Tell = std::function<void(const std::string& message)>;

  // Forks. The child has a copy of everything but the threads; it shares open files and their positions with
  // this process. It runs `work` and exits, without running destructors of static objects. Throws
  // std::system_error if the system cannot fork.
  explicit Child(const std::function<void(const Tell& tell)>& work);
  // Kills the child if it still runs.
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  // Waits until next() would return without waiting, a signal has been caught, or the time is over. Returns
  // true in the first case.
  bool has_news(std::chrono::milliseconds wait);
  int descriptor() const { return messages_.read_end(); }  // readable once next() would return soon
  // Waits for the next message. Returns nullopt once the work is done. If the child fails, throws
  // std::runtime_error with the text of the exception that `work` threw, std::bad_alloc if it threw that, or
  // ChildDied if the child ended in another way.
  std::optional<std::string> next();

 private:
  Pipe messages_;
  pid_t pid_ = -1;  // -1 after its end was waited for
};

}  // namespace stereotlm::process
