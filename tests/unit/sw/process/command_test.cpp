#include "sw/process/command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <system_error>

#include "sw/process/streams.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::process {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(Command, ReturnsTheOutputAndTheStatus) {
  const CommandEnd end = run_command({"sh", "-c", "echo out; echo errors >&2; exit 3"});
  EXPECT_EQ(end.status, 3);
  EXPECT_EQ(end.out, "out\n");
  EXPECT_EQ(end.errors, "errors\n");
  EXPECT_EQ(run_command({"sh", "-c", "kill -9 $$"}).status, 128 + SIGKILL);
  EXPECT_EQ(run_command({"head", "-c", "1000000", "/dev/zero"}).out, std::string(1'000'000, '\0'))
      << "more than a pipe holds";
}

TEST(Command, PassesWordsWithoutAShell) {
  EXPECT_EQ(run_command({"printf", "%s|", "a b", "$HOME", "*", "'", ""}).out, "a b|$HOME|*|'||");
}

TEST(Command, EndsAtAClosedPipeAlthoughThisProcessIgnoresTheSignal) {
  const auto before = signal(SIGPIPE, SIG_IGN);
  EXPECT_EQ(run_command({"sh", "-c", "kill -PIPE $$"}).status, 128 + SIGPIPE);
  signal(SIGPIPE, before);
}

TEST(Command, IsEndedByAnInterruptIfThatIsAskedFor) {
  const auto run_interrupted = [](bool ends) {
    catch_interrupts();
    raise(SIGINT);
    std::exit(run_command({"sleep", ends ? "60" : "0.1"}, {}, ends ? [] {} : std::function<void()>()).status);
  };
  EXPECT_EXIT(run_interrupted(true), testing::ExitedWithCode(128 + SIGTERM), "");
  EXPECT_EXIT(run_interrupted(false), testing::ExitedWithCode(0), "");
}

TEST(Command, HasAGroupOfItsOwnAndNoInput) {
  EXPECT_EQ(run_command({"sh", "-c", "cat; ps -o pgid= -p $$ | grep -qw $$"}).status, 0);
}

TEST(Command, DoesNotGetHiddenVariables) {
  setenv("STEREOTLM_SEEN", "1", 1);
  setenv("HIDDEN_ONE", "1", 1);
  const std::string out = run_command({"env"}, {"OTHER_", "HIDDEN_"}).out;
  EXPECT_THAT(out, HasSubstr("STEREOTLM_SEEN=1\n"));
  EXPECT_THAT(out, Not(HasSubstr("HIDDEN_ONE")));
}

TEST(Command, ReportsAProgramThatIsMissingOrCannotBeStarted) {
  EXPECT_EQ(test::message_of([] { run_command({"no-such-program"}); }), "no-such-program: not found in PATH");
  EXPECT_THROW(run_command({"/dev/null"}), std::system_error);
}

}  // namespace
}  // namespace stereotlm::process
