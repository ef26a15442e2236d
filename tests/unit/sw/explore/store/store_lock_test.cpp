#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "sw/explore/store/store.h"
#include "tests/unit/sw/explore/store_files.h"

namespace stereotlm::explore {
namespace {

namespace fs = std::filesystem;
using test::message_of;
using test::write_file;
using namespace std::chrono_literals;

class StoreLockTest : public StoreFiles {
 protected:
  void expect_locked(const std::string& path) const {
    EXPECT_EQ(message_of([&] { const StoreLock second(path, 0ms); }),
              path + ": another process is at work on it: wait for its end, or give another file");
  }

  std::string store = file("a.db");
};

TEST_F(StoreLockTest, KeepsOtherLocksOutUntilItEnds) {
  {
    const StoreLock first(store);
    for (int i = 0; i < 2; ++i) {
      sqlite::Database database(store, sqlite::Database::Access::kCreate);
      database.execute("CREATE TABLE IF NOT EXISTS t(x); INSERT INTO t VALUES(1)");
    }
    expect_locked(store);  // although SQLite has closed the file
  }
  const StoreLock second(store, 0ms);
}

// The end of the first lock removes the file, which the second has opened.
TEST_F(StoreLockTest, WaitsForAnotherLockToEndAndLocksTheFileThatHasTheNameThen) {
  auto first = std::make_unique<StoreLock>(store);
  std::thread other([&first] {
    std::this_thread::sleep_for(100ms);
    first.reset();
  });
  const StoreLock second(store, 60s);
  other.join();
  second.check();
}

TEST_F(StoreLockTest, LocksTheFileThatHasTheNameNow) {
  const StoreLock first(store);
  fs::rename(write_file(file("new"), ""), store);
  const StoreLock second(store, 0ms);
  expect_locked(store);
}

TEST_F(StoreLockTest, RemovesTheFileThatItHasMadeIfItIsStillEmpty) {
  { const StoreLock lock(store); }
  EXPECT_FALSE(fs::exists(store));
  {
    const StoreLock lock(store);
    fs::rename(write_file(file("new"), ""), store);
  }
  EXPECT_TRUE(fs::exists(store)) << "another file has taken its place";
  { const StoreLock lock(store); }
  EXPECT_TRUE(fs::exists(store)) << "the lock has not made it";
  fs::remove(store);
  {
    const StoreLock lock(store);
    write_file(store, "points");
  }
  EXPECT_TRUE(fs::exists(store));
}

TEST_F(StoreLockTest, LocksTheFileBehindALink) {
  const std::string target = file("target");
  fs::create_symlink(target, store);
  {
    const StoreLock lock(store);
    EXPECT_TRUE(fs::is_regular_file(target));
    expect_locked(target);
  }
  EXPECT_TRUE(fs::is_symlink(store));
  EXPECT_FALSE(fs::exists(target)) << "the lock has made it, and it is empty";
}

}  // namespace
}  // namespace stereotlm::explore
