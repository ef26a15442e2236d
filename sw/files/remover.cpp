#include "sw/files/remover.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>

#include "sw/files/whole_file.h"

namespace stereotlm::files {

Remover::Remover(const std::string& script, const std::vector<std::string>& words, int lock) {
  constexpr const char* kShell = "/bin/sh";
  const std::string command = "read -r _ || { " + script + "; }";  // read fails at the end of the pipe
  std::vector<const char*> arguments = {"stereotlm-remover", "-c", command.c_str(), kShell};
  for (const std::string& word : words) arguments.push_back(word.c_str());
  arguments.push_back(nullptr);
  std::array<int, 2> pipe = {-1, -1};
  if (pipe2(pipe.data(), O_CLOEXEC) != 0) fail(errno, kShell);
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  sigprocmask(SIG_SETMASK, &all, &before);  // the shell would not survive a signal that comes too early
  shell_ = fork();
  if (shell_ == 0) {
    setsid();
    for (const int ignored : {SIGHUP, SIGINT, SIGQUIT, SIGTERM}) signal(ignored, SIG_IGN);
    sigprocmask(SIG_SETMASK, &before, nullptr);
    dup2(pipe[0], STDIN_FILENO);
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    for (const int descriptor : {STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, descriptor);
    if (lock >= 0) static_cast<void>(dup(lock));  // the shell inherits the copy
    execv(kShell, const_cast<char* const*>(arguments.data()));
    _exit(1);
  }
  const int error = errno;
  sigprocmask(SIG_SETMASK, &before, nullptr);
  if (shell_ < 0) fail(error, kShell);
  close(pipe[0]);
  alive_ = pipe[1];
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
