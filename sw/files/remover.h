#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace stereotlm::files {

// Removes files if this process ends before the object is destroyed, even if it is killed. A shell waits for
// that end. It has a session of its own, so that the signals of a terminal do not reach it.
class Remover {
 public:
  // `script`: what the shell then executes, with the other words as $1, $2 and so on. `lock`: a descriptor
  // that is locked by flock(); the shell keeps the lock until it has ended. -1: none. Throws
  // std::system_error if the shell cannot be started.
  Remover(const std::string& script, const std::vector<std::string>& words, int lock = -1);
  // Ends the shell, which removes nothing.
  ~Remover();
  Remover(const Remover&) = delete;
  Remover& operator=(const Remover&) = delete;

 private:
  int alive_ = -1;  // write end of a pipe; the system closes it with this process
  pid_t shell_ = -1;
};

// Locks an open file or folder by flock(). Returns false if another process keeps it locked for a second: the
// Remover of a process that was killed ends sooner. True on a file system without locks.
bool lock_soon(int descriptor);

}  // namespace stereotlm::files
