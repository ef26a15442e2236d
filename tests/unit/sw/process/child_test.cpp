#include "sw/process/child.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/time.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <new>
#include <stdexcept>
#include <string>

#include "sw/process/child_process.h"
#include "sw/process/ended_by_signal.h"

namespace stereotlm::process {
namespace {

using ::testing::HasSubstr;

// What next() says of a child that fails.
std::string failure_of(Child& child) {
  try {
    while (child.next()) {
    }
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "none";
}

TEST(Child, TellsItsMessagesInOrderAndThenThatItIsDone) {
  Child child([](const Child::Tell& tell) {
    for (int number = 0; number < 100; ++number) tell(std::to_string(number));
  });
  for (int number = 0; number < 100; ++number) ASSERT_EQ(child.next(), std::to_string(number));
  EXPECT_EQ(child.next(), std::nullopt);
}

TEST(Child, TellsMessagesOfAnySizeAndContent) {
  const std::string large(1'000'000, 'x');
  const std::string strange("a\0b\n", 4);
  Child child([&](const Child::Tell& tell) {
    tell("");
    tell(large);
    tell(strange);
  });
  EXPECT_EQ(child.next(), "");
  EXPECT_TRUE(child.next() == large);
  EXPECT_EQ(child.next(), strange);
  EXPECT_EQ(child.next(), std::nullopt);
}

TEST(Child, WorksOnACopy) {
  int value = 1;
  Child child([&value](const Child::Tell& tell) { tell(std::to_string(++value)); });
  EXPECT_EQ(child.next(), "2");
  EXPECT_EQ(value, 1);
}

TEST(Child, HasNewsOnceItHasToldSomethingOrEnded) {
  using std::chrono::milliseconds;
  std::array<int, 2> gate{};
  ASSERT_EQ(pipe(gate.data()), 0);
  Child child([&gate](const Child::Tell& tell) {
    char byte = 0;
    if (read(gate[0], &byte, 1) != 1) throw std::runtime_error("read");
    tell("told");
  });
  EXPECT_FALSE(child.has_news(milliseconds(0)));
  EXPECT_FALSE(child.has_news(milliseconds(20)));
  ASSERT_EQ(write(gate[1], "", 1), 1);
  EXPECT_TRUE(child.has_news(milliseconds(30'000)));
  EXPECT_EQ(child.next(), "told");
  EXPECT_TRUE(child.has_news(milliseconds(30'000)));
  EXPECT_EQ(child.next(), std::nullopt);
}

TEST(Child, IsWaitedForUntilASignalHasBeenCaught) {
  struct sigaction action = {};
  action.sa_handler = [](int) {};
  action.sa_flags = SA_RESTART;
  ASSERT_EQ(sigaction(SIGALRM, &action, nullptr), 0);
  Child child([](const Child::Tell& /*tell*/) {
    for (;;) pause();
  });
  itimerval soon = {{0, 10'000}, {0, 10'000}};  // again and again, should the first come before the wait
  ASSERT_EQ(setitimer(ITIMER_REAL, &soon, nullptr), 0);
  const auto before = std::chrono::steady_clock::now();
  EXPECT_FALSE(child.has_news(std::chrono::milliseconds(30'000)));
  EXPECT_LT(std::chrono::steady_clock::now() - before, std::chrono::seconds(20));
  soon = {};
  ASSERT_EQ(setitimer(ITIMER_REAL, &soon, nullptr), 0);
}

TEST(Child, HandsOnTheTextOfAnExceptionBehindTheMessagesBeforeIt) {
  Child child([](const Child::Tell& tell) {
    tell("first");
    throw std::logic_error("the disk is gone");
  });
  EXPECT_EQ(child.next(), "first");
  EXPECT_EQ(failure_of(child), "the disk is gone");
}

TEST(Child, SaysThatAnExceptionHasAnUnknownType) {
  Child child([](const Child::Tell& /*tell*/) { throw 5; });
  EXPECT_EQ(failure_of(child), "an exception of an unknown type");
}

TEST(Child, NamesTheSignalThatEndedIt) {
  Child child([](const Child::Tell& tell) {
    tell("before");
    kill(getpid(), SIGKILL);
  });
  EXPECT_EQ(failure_of(child), "the process was ended by signal 9 (Killed)");
}

TEST(Child, TellsTheSignalApartFromAFailure) {
  Child child([](const Child::Tell& /*tell*/) { kill(getpid(), SIGTERM); });
  try {
    child.next();
    FAIL() << "it was ended";
  } catch (const EndedBySignal& end) {
    EXPECT_EQ(end.signal(), SIGTERM);
  }
}

TEST(Child, NamesTheStatusWithWhichItEndedTooEarly) {
  Child child([](const Child::Tell& /*tell*/) { _exit(3); });
  EXPECT_EQ(failure_of(child), "the process ended with status 3 before its work was done");
}

TEST(Child, HandsOnThatMemoryWasShort) {
  Child child([](const Child::Tell& /*tell*/) { throw std::bad_alloc(); });
  EXPECT_THROW(child.next(), std::bad_alloc);
}

pid_t forker = 0;

void wait_until_it_has_ended() {
  while (getppid() == forker) usleep(1000);
}

TEST(Child, DoesNotBeginIfTheOtherProcessHasEndedBefore) {
  Pipe told;
  const pid_t other = fork();
  if (other == 0) {
    forker = getpid();
    pthread_atfork(nullptr, nullptr, wait_until_it_has_ended);
    const Child child([&](const Child::Tell& /*tell*/) { write_all(told.write_end(), "", 1); });
    _exit(0);
  }
  told.close_write_end();
  ASSERT_EQ(waitpid(other, nullptr, 0), other);
  char byte = 0;
  EXPECT_FALSE(read_all(told.read_end(), &byte, 1)) << "it has worked for nobody";
}

TEST(Child, IsGoneWhenItIsDestroyed) {
  pid_t pid = 0;
  {
    Child child([](const Child::Tell& tell) {
      tell(std::to_string(getpid()));
      for (;;) pause();
    });
    pid = static_cast<pid_t>(std::stol(child.next().value()));
    EXPECT_EQ(kill(pid, 0), 0);
  }
  EXPECT_EQ(kill(pid, 0), -1);
  EXPECT_EQ(errno, ESRCH);
}

TEST(Child, IsGoneWhenItIsDestroyedWhileItWaitsForSomebodyToListen) {
  Child child([](const Child::Tell& tell) {
    const std::string message(100'000, 'x');
    for (;;) tell(message);
  });
  EXPECT_EQ(child.next().value().size(), 100'000U);
}

}  // namespace
}  // namespace stereotlm::process
