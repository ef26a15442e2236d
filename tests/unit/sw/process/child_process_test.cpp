#include "sw/process/child_process.h"

#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <iterator>

namespace stereotlm::process {
namespace {

std::ptrdiff_t open_files() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {});
}

// Whether the pipe ends without a byte, once all other processes have closed its write end.
bool ends_empty(Pipe& pipe) {
  pipe.close_write_end();
  char byte = 0;
  return !read_all(pipe.read_end(), &byte, 1);
}

TEST(Pipe, ReportsThatItsReadEndIsClosed) {
  signal(SIGPIPE, SIG_IGN);
  Pipe pipe;
  EXPECT_TRUE(write_all(pipe.write_end(), "x", 1));
  pipe.close_read_end();
  EXPECT_FALSE(write_all(pipe.write_end(), "x", 1));
}

TEST(Pipe, LeavesNoFileOpen) {
  const auto before = open_files();
  {
    Pipe pipe;
    pipe.close_read_end();
    EXPECT_EQ(open_files(), before + 1);
  }
  EXPECT_EQ(open_files(), before);
}

TEST(ChildProcess, IsGoneWhenItIsDestroyed) {
  Pipe pipe;
  {
    const ChildProcess child([] { return pause(); });
  }
  EXPECT_TRUE(ends_empty(pipe));
}

pid_t forker = 0;

void wait_until_it_has_ended() {
  while (getppid() == forker) usleep(1000);
}

TEST(ChildProcess, DoesNotBeginItsWorkAfterTheEndOfItsParent) {
  Pipe pipe;
  const pid_t parent = fork();
  if (parent == 0) {
    forker = getpid();
    pthread_atfork(nullptr, nullptr, wait_until_it_has_ended);
    const ChildProcess child([&] { return write_all(pipe.write_end(), "", 1) ? 0 : 1; });
    _exit(0);
  }
  ASSERT_EQ(waitpid(parent, nullptr, 0), parent);
  EXPECT_TRUE(ends_empty(pipe));
}

}  // namespace
}  // namespace stereotlm::process
