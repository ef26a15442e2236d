#include "sw/files/remover.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>

#include "sw/files/whole_file.h"

namespace stereotlm::files {

Remover::Remover(const std::string& script, const std::vector<std::string>& words, int lock) {
  constexpr const char* kShell = "/bin/sh";
  constexpr int kOfLock = 3;
  const std::string command = "read -r _ || { " + script + "; }";  // read fails at the end of the pipe
  std::vector<const char*> arguments = {"stereotlm-remover", "-c", command.c_str(), kShell};
  for (const std::string& word : words) arguments.push_back(word.c_str());
  arguments.push_back(nullptr);
  std::array<int, 2> pipe = {-1, -1};
  if (pipe2(pipe.data(), O_CLOEXEC) != 0) fail(errno, kShell);
  alive_ = pipe[1];
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, pipe[0], STDIN_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  if (lock >= 0) posix_spawn_file_actions_adddup2(&actions, lock, kOfLock);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  const int error = posix_spawn(&shell_, kShell, &actions, &attributes,
                                const_cast<char* const*>(arguments.data()), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  close(pipe[0]);
  if (error != 0) {
    close(alive_);
    fail(error, kShell);
  }
}

Remover::~Remover() {
  kill(shell_, SIGKILL);
  while (waitpid(shell_, nullptr, 0) < 0 && errno == EINTR) {
  }
  close(alive_);
}

bool lock_soon(int descriptor) {
  constexpr int kTries = 100;
  for (int tries = 0; flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK; usleep(10'000)) {
    if (++tries == kTries) return false;
  }
  return true;
}

}  // namespace stereotlm::files
