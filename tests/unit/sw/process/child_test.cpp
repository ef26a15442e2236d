#include "sw/process/child.h"

#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace stereotlm::process {
namespace {

using namespace std::chrono_literals;

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

TEST(Child, IsGoneWhenItIsDestroyed) {
  Pipe pipe;
  {
    const Child child([](const Child::Tell& /*tell*/) { pause(); });
  }
  EXPECT_TRUE(ends_empty(pipe));
}

pid_t forker = 0;

void wait_until_it_has_ended() {
  while (getppid() == forker) usleep(1000);
}

TEST(Child, DoesNotBeginItsWorkAfterTheEndOfItsParent) {
  Pipe pipe;
  const pid_t parent = fork();
  if (parent == 0) {
    forker = getpid();
    pthread_atfork(nullptr, nullptr, wait_until_it_has_ended);
    const Child child([&](const Child::Tell& /*tell*/) { write_all(pipe.write_end(), "", 1); });
    _exit(0);
  }
  ASSERT_EQ(waitpid(parent, nullptr, 0), parent);
  EXPECT_TRUE(ends_empty(pipe));
}

TEST(Child, SendsMessagesOfAnySizeAndContentInOrder) {
  const std::vector<std::string> messages = {"", std::string(1'000'000, 'x'), std::string("a\0b\n", 4),
                                             "last"};
  Child child([&](const Child::Tell& tell) {
    for (const std::string& message : messages) tell(message);
  });
  for (const std::string& message : messages) EXPECT_TRUE(child.next() == message);
  EXPECT_EQ(child.next(), std::nullopt);
}

TEST(Child, HasNewsOnceItHasSentAMessageOrEnded) {
  Pipe gate;
  Child child([&gate](const Child::Tell& tell) {
    char byte = 0;
    if (read_all(gate.read_end(), &byte, 1)) tell("told");
  });
  EXPECT_FALSE(child.has_news(0ms));
  EXPECT_FALSE(child.has_news(20ms));
  ASSERT_TRUE(write_all(gate.write_end(), "", 1));
  EXPECT_TRUE(child.has_news(30s));
  EXPECT_EQ(child.next(), "told");
  EXPECT_TRUE(child.has_news(30s));
  EXPECT_EQ(child.next(), std::nullopt);
}

TEST(Child, IsWaitedForUntilASignalIsCaught) {
  struct sigaction action = {};
  action.sa_handler = [](int) {};
  action.sa_flags = SA_RESTART;
  ASSERT_EQ(sigaction(SIGALRM, &action, nullptr), 0);
  Child child([](const Child::Tell& /*tell*/) {
    for (;;) pause();
  });
  itimerval soon = {{0, 10'000}, {0, 10'000}};  // repeated, in case the first comes before the wait
  ASSERT_EQ(setitimer(ITIMER_REAL, &soon, nullptr), 0);
  const auto before = std::chrono::steady_clock::now();
  EXPECT_FALSE(child.has_news(30s));
  EXPECT_LT(std::chrono::steady_clock::now() - before, 20s);
  soon = {};
  ASSERT_EQ(setitimer(ITIMER_REAL, &soon, nullptr), 0);
}

TEST(Child, ReportsHowItHasFailedBehindItsMessages) {
  const std::vector<std::pair<void (*)(), std::string>> failures = {
      {[] { throw std::logic_error("the disk is gone"); }, "the disk is gone"},
      {[] { throw 5; }, "an exception of an unknown type"},
      {[] { throw std::bad_alloc(); }, std::bad_alloc().what()},
      {[] { raise(SIGKILL); }, "the process was ended by signal 9 (Killed)"},
      {[] { _exit(3); }, "the process ended with status 3 before its work was done"}};
  for (const auto& [fail, text] : failures) {
    Child child([fail = fail](const Child::Tell& tell) {
      tell("before");
      fail();
    });
    EXPECT_EQ(child.next(), "before");
    try {
      child.next();
      ADD_FAILURE() << text;
    } catch (const ChildDied& end) {
      EXPECT_EQ(end.what(), text);
      EXPECT_EQ(end.signal() == SIGKILL, end.how() == "ended with signal 9 (Killed)") << end.how();
      EXPECT_EQ(end.signal() == 0, end.how() == "ended with exit status 3") << end.how();
    } catch (const std::exception& error) {
      EXPECT_EQ(error.what(), text);
      EXPECT_EQ(dynamic_cast<const std::bad_alloc*>(&error) != nullptr, text == std::bad_alloc().what());
    }
  }
}

TEST(Child, IsGoneWhenItIsDestroyedWhileItWaitsForAReader) {
  Child child([](const Child::Tell& tell) {
    const std::string message(100'000, 'x');
    for (;;) tell(message);
  });
  EXPECT_EQ(child.next().value().size(), 100'000U);
}

}  // namespace
}  // namespace stereotlm::process
