#include "sw/process/child_process.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <iterator>
#include <string>

namespace stereotlm::process {
namespace {

std::ptrdiff_t open_files() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {});
}

TEST(Pipe, CarriesAllBytesToItsEnd) {
  Pipe pipe;
  const std::string large(1'000'000, 'x');
  ChildProcess writer([&] {
    pipe.close_read_end();
    return write_all(pipe.write_end(), large.data(), large.size()) ? 0 : 1;
  });
  pipe.close_write_end();
  std::string got(large.size(), '\0');
  EXPECT_TRUE(read_all(pipe.read_end(), got.data(), got.size()));
  EXPECT_TRUE(got == large);
  EXPECT_FALSE(read_all(pipe.read_end(), got.data(), 1));
  EXPECT_EQ(writer.wait(), 0);
}

TEST(Pipe, SaysThatNobodyReads) {
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

TEST(ChildProcess, GivesTheStatusOfItsWork) {
  EXPECT_EQ(WEXITSTATUS(ChildProcess([] { return 3; }).wait()), 3);
  EXPECT_EQ(WTERMSIG(ChildProcess([] { return raise(SIGKILL); }).wait()), SIGKILL);
}

TEST(ChildProcess, IsGoneWhenItIsDestroyed) {
  Pipe pipe;
  {
    const ChildProcess child([] { return pause(); });
    pipe.close_write_end();
  }
  char byte = 0;
  EXPECT_FALSE(read_all(pipe.read_end(), &byte, 1)) << "it had the other end";
}

}  // namespace
}  // namespace stereotlm::process
