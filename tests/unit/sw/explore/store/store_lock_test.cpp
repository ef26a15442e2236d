#include "sw/explore/store/store_lock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "sw/explore/store/database.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::explore {
namespace {

using test::message_of;
using ::testing::EndsWith;
using namespace std::chrono_literals;

class StoreLockTest : public ::testing::Test {
 protected:
  std::string store() const { return (folder_.path() / "a.db").string(); }
  // What a second lock is refused with.
  std::string refusal() const {
    return message_of([&] { const StoreLock second(store(), 0ms); });
  }

 private:
  test::ScratchFolder folder_;
};

TEST_F(StoreLockTest, IsForOne) {
  auto first = std::make_unique<StoreLock>(store());
  EXPECT_EQ(refusal(),
            store() + ": another process is at work on it: wait for its end, or give another file");
  first.reset();
  const StoreLock second(store(), 0ms);
}

TEST_F(StoreLockTest, HoldsWhileSqliteOpensAndClosesTheFile) {
  const StoreLock first(store());
  for (int i = 0; i < 2; ++i) {
    Database database(store(), Database::Access::kCreate);
    database.execute("CREATE TABLE IF NOT EXISTS t(x); INSERT INTO t VALUES(1)");
  }
  EXPECT_THAT(refusal(), EndsWith("give another file"));
}

TEST_F(StoreLockTest, EndsWithTheProcessAndThoseThatItHasForked) {
  const pid_t child = fork();
  if (child == 0) {
    const StoreLock lock(store());
    test::write_file(store() + ".locked", "");
    pause();
  }
  while (!std::filesystem::exists(store() + ".locked")) std::this_thread::sleep_for(1ms);
  EXPECT_THAT(refusal(), EndsWith("give another file"));
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  const StoreLock lock(store(), 0ms);
}

TEST_F(StoreLockTest, WaitsForAProcessThatEnds) {
  auto first = std::make_unique<StoreLock>(store());
  std::thread other([&first] {
    std::this_thread::sleep_for(100ms);
    first.reset();
  });
  const StoreLock second(store(), 60s);
  other.join();
}

TEST_F(StoreLockTest, IsOfTheFileThatIsThere) {
  const StoreLock first(store());
  test::write_file(store() + ".new", "");
  std::filesystem::rename(store() + ".new", store());
  const StoreLock second(store(), 0ms);
  EXPECT_THAT(refusal(), EndsWith("give another file"));
}

TEST_F(StoreLockTest, LeavesNoEmptyFileThatItHasMade) {
  { const StoreLock lock(store()); }
  EXPECT_FALSE(std::filesystem::exists(store()));
  {
    const StoreLock lock(store());
    test::write_file(store(), "points");
  }
  EXPECT_TRUE(std::filesystem::exists(store()));
  test::write_file(store(), "");
  { const StoreLock lock(store()); }
  EXPECT_TRUE(std::filesystem::exists(store())) << "somebody else has made it";
}

TEST_F(StoreLockTest, LeavesAFileThatHasTakenThePlaceOfItsOwn) {
  {
    const StoreLock lock(store());
    std::filesystem::rename(test::write_file(store() + ".new", ""), store());
  }
  EXPECT_TRUE(std::filesystem::exists(store()));
}

TEST_F(StoreLockTest, IsOfTheFileBehindALink) {
  namespace fs = std::filesystem;
  const std::string target = store() + ".target";
  fs::create_symlink(target, store());
  {
    const StoreLock lock(store());
    EXPECT_TRUE(fs::is_regular_file(target));
    EXPECT_THAT(message_of([&] { const StoreLock second(target, 0ms); }), EndsWith("give another file"));
  }
  EXPECT_TRUE(fs::is_symlink(store()));
  EXPECT_FALSE(fs::exists(target)) << "it was made by the lock, and is empty";
}

TEST_F(StoreLockTest, SaysThatItsFileHasGone) {
  for (const bool is_replaced : {false, true}) {
    const StoreLock lock(store());
    lock.check();
    std::filesystem::remove(store());
    if (is_replaced) test::write_file(store(), "another");
    EXPECT_EQ(message_of([&] { lock.check(); }),
              store() + ": has been removed or replaced meanwhile: what was done is gone with it");
  }
}

TEST_F(StoreLockTest, SaysWhyItCannotBe) {
  EXPECT_EQ(message_of([&] { const StoreLock lock(store() + "/none.db"); }),
            store() + "/none.db: cannot be opened to write: No such file or directory");
}

}  // namespace
}  // namespace stereotlm::explore
