#include "sw/explore/sweep/sweep.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <iterator>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "sw/explore/plan/conditions.h"
#include "sw/explore/plan/plan.h"
#include "sw/explore/store/merge_stores.h"
#include "sw/explore/store/store.h"
#include "sw/explore/store/store_lock.h"
#include "sw/process/ended_by_signal.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::explore {
namespace {

using test::message_of;
using test::read_file;
using ::testing::HasSubstr;

// 60 points. A quarter is left out; of the others a third is impossible, and a fifth of the rest fails. What
// a run gives is made up.
const char* const kPlan =
    "board: fpl2003\n"
    "vary:\n"
    "  matcher.window: [3, 5, 7, 9, 11]\n"
    "  capture.fifo_words: [16, 64, 128]\n"
    "  matcher.disparities: [10, 20, 30, 40]\n"
    "where: matcher.disparities < 40\n";

Figures evaluate(const Point& point) {
  if (point.board->matcher.window == 11) throw std::runtime_error("a window that fails");
  return {{{"cycles", std::int64_t{point.board->matcher.window * point.board->matcher.disparities}}},
          {{"left_pixel", "bank0", "host", point.board->matcher.window}}};
}

bool always(const SweepCounts& /*counts*/) { return true; }

class SweepTest : public ::testing::Test {
 protected:
  SweepTest() { test::write_file(file("plan.yaml"), kPlan); }

  std::string file(const std::string& name) const { return (folder_.path() / name).string(); }
  Plan plan() const { return Plan::load(file("plan.yaml")); }
  SweepOptions options(const std::string& store, unsigned jobs = 1) const {
    SweepOptions options;
    options.store = file(store);
    options.version = "1";
    options.jobs = jobs;
    return options;
  }
  // All points by one worker, without a break.
  std::string reference() const {
    sweep(plan(), evaluate, options("reference.db"), always);
    return read_file(file("reference.db"));
  }

 private:
  test::ScratchFolder folder_;
};

TEST_F(SweepTest, EndsEachPointInItsOwnWay) {
  const SweepCounts counts = sweep(plan(), evaluate, options("a.db"), always);
  EXPECT_EQ(counts.total, 60U);
  EXPECT_EQ(counts.excluded, 15U);
  EXPECT_EQ(counts.impossible, 15U);
  EXPECT_EQ(counts.failed, 6U);
  EXPECT_EQ(counts.ok, 24U);
  EXPECT_EQ(counts.done(), counts.total);
  Database database(file("a.db"), Database::Access::kRead);
  EXPECT_EQ(database.number("SELECT count(*) FROM points"), 45);
  EXPECT_EQ(database.number(
                "SELECT count(*) FROM points WHERE status = 'failed' AND reason = 'a window that fails' "
                "AND \"matcher.window\" = 11"),
            6);
  EXPECT_EQ(database.number("SELECT count(*) FROM points WHERE status = 'impossible' AND reason = "
                            "'capture.fifo_trigger_words = 32: 1..fifo_words, which is 16'"),
            15);
  EXPECT_EQ(database.number("SELECT sum(cycles) FROM points"), (3 + 5 + 7 + 9) * (10 + 20 + 30) * 2);
  EXPECT_EQ(database.number("SELECT sum(cycles) FROM blame"), (3 + 5 + 7 + 9) * 3 * 2);
}

TEST_F(SweepTest, GivesTheSameBytesForAnyNumberOfJobs) {
  const std::string expected = reference();
  for (const unsigned jobs : {2U, 3U, 200U}) {
    const std::string store = std::to_string(jobs) + ".db";
    const SweepCounts counts = sweep(plan(), evaluate, options(store, jobs), always);
    EXPECT_EQ(counts.ok, 24U);
    EXPECT_EQ(read_file(file(store)), expected) << jobs;
  }
}

// A point ends when as many processes work as there are points.
TEST_F(SweepTest, GivesEachWorkerItsShareAtOnce) {
  test::write_file(file("eight.yaml"),
                   "board: fpl2003\nvary: {matcher.disparities: [1, 2, 3, 4, 5, 6, 7, 8]}\n");
  const std::filesystem::path at_work = file("at_work");
  std::filesystem::create_directory(at_work);
  const auto waits = [&at_work](const Point& point) -> Figures {
    test::write_file(at_work / std::to_string(getpid()), "");
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (std::chrono::steady_clock::now() < end) {
      const std::filesystem::directory_iterator files(at_work);
      if (std::distance(begin(files), std::filesystem::end(files)) == 8) return evaluate(point);
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    throw std::runtime_error("others have nothing to do");
  };
  EXPECT_EQ(sweep(Plan::load(file("eight.yaml")), waits, options("a.db", 8), always).ok, 8U);
}

TEST_F(SweepTest, GivesTheSameBytesInShardsThatAreMerged) {
  const std::string expected = reference();
  for (const std::uint64_t shards : {2U, 7U, 61U}) {
    std::vector<std::string> stores;
    std::uint64_t points = 0;
    for (std::uint64_t shard = shards; shard-- > 0;) {
      SweepOptions part = options("shard.db");
      part.store = file("shard" + std::to_string(shards) + "_" + std::to_string(shard) + ".db");
      part.shard = shard;
      part.shards = shards;
      const SweepCounts counts = sweep(plan(), evaluate, part, always);
      EXPECT_EQ(counts.done(), counts.total);
      points += counts.total;
      stores.push_back(part.store);
    }
    EXPECT_EQ(points, 60U);
    merge_stores(stores, file("merged.db"));
    EXPECT_EQ(read_file(file("merged.db")), expected) << shards;
  }
}

TEST_F(SweepTest, GoesOnWhereItWasStopped) {
  const std::string expected = reference();
  std::uint64_t restarts = 0;
  SweepCounts counts;
  do {
    const std::uint64_t known = counts.known + counts.ok + counts.failed + counts.impossible;
    counts = sweep(plan(), evaluate, options("a.db", 2),
                   [&](const SweepCounts& now) { return now.done() < known + now.excluded + 5; });
    ASSERT_LT(++restarts, 60U);
  } while (counts.done() < counts.total);
  EXPECT_GT(restarts, 1U);
  EXPECT_EQ(read_file(file("a.db")), expected);
}

// A plan's points again and again: more than could be handed out.
class EndlessPoints : public Points {
 public:
  explicit EndlessPoints(Plan plan) : plan_(std::move(plan)) {}
  std::uint64_t size() const override { return 1'000'000'000'000; }
  Point point(std::uint64_t number) const override { return plan_.point(number % plan_.size()); }
  const std::vector<Condition>& conditions() const override { return plan_.conditions(); }

 private:
  Plan plan_;
};

TEST_F(SweepTest, HandsOutNoPointsOnceItIsStopped) {
  const SweepCounts counts = sweep(EndlessPoints(plan()), evaluate, options("a.db", 2),
                                   [](const SweepCounts& now) { return now.done() == 0; });
  EXPECT_GT(counts.done(), 0U);
  EXPECT_LT(counts.done(), 1000U);
}

TEST_F(SweepTest, DoesNotRunAPointThatIsThere) {
  sweep(plan(), evaluate, options("a.db"), always);
  const auto never = [](const Point& /*point*/) -> Figures { std::abort(); };
  const SweepCounts counts = sweep(plan(), never, options("a.db"), always);
  EXPECT_EQ(counts.known, 45U);
  EXPECT_EQ(counts.ok + counts.failed, 0U);
  EXPECT_EQ(read_file(file("a.db")), reference());
}

// Points in a store, which may not be there yet.
std::int64_t points_in(const std::string& path) {
  try {
    return Database(path, Database::Access::kRead).number("SELECT count(*) FROM points");
  } catch (const DatabaseError&) {
    return 0;
  }
}

TEST_F(SweepTest, DoesNotRunAPointThatAKnownStoreHas) {
  SweepOptions first = options("a.db");
  first.shards = 2;
  sweep(plan(), evaluate, first, always);
  SweepOptions second = options("b.db");
  second.known = file("a.db");
  const SweepCounts counts = sweep(plan(), evaluate, second, always);
  EXPECT_GT(counts.known, 0U);
  EXPECT_EQ(counts.known, static_cast<std::uint64_t>(points_in(file("a.db"))));
  EXPECT_EQ(counts.known + static_cast<std::uint64_t>(points_in(file("b.db"))), 45U);
  merge_stores({file("a.db"), file("b.db")}, file("merged.db"));
  EXPECT_EQ(read_file(file("merged.db")), reference());
}

TEST_F(SweepTest, LosesNothingButThePointsUnderWayWhenItIsKilled) {
  const std::string expected = reference();
  for (int attempt = 0; attempt < 5; ++attempt) {
    const pid_t child = fork();
    if (child == 0) {
      const auto slow = [](const Point& point) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
        return evaluate(point);
      };
      sweep(plan(), slow, options("a.db", 2), always);
      _exit(0);
    }
    while (points_in(file("a.db")) < 4 * (attempt + 1))
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
  }
  const auto before = static_cast<std::uint64_t>(points_in(file("a.db")));
  EXPECT_GE(before, 20U);
  EXPECT_LT(before, 45U) << "the sweep was to be killed before its end";
  const SweepCounts counts = sweep(plan(), evaluate, options("a.db", 2), always);
  EXPECT_GE(counts.known, before);
  EXPECT_EQ(read_file(file("a.db")), expected);
}

TEST_F(SweepTest, ReplacesAWorkerThatDies) {
  const std::string once = file("died");
  const auto dies_once = [&once](const Point& point) {
    if (!std::filesystem::exists(once) && point.board->matcher.window == 7) {
      test::write_file(once, "");
      raise(SIGKILL);
    }
    return evaluate(point);
  };
  const std::string expected = reference();
  const SweepCounts counts = sweep(plan(), dies_once, options("a.db", 2), always);
  EXPECT_TRUE(std::filesystem::exists(once));
  EXPECT_EQ(counts.ok, 24U);
  EXPECT_EQ(read_file(file("a.db")), expected);
}

const std::string kAgain = ": to try again, delete this row and give the same command";

// Of 60 points 6 have a board and the window 9.
TEST_F(SweepTest, MakesARowOfEachPointWhoseWorkersDieAgainAndAgain) {
  const auto dies = [](const Point& point) -> Figures {
    if (point.board->matcher.window == 9) raise(SIGKILL);
    return evaluate(point);
  };
  for (const unsigned jobs : {1U, 3U}) {
    const std::string store = std::to_string(jobs) + ".db";
    const SweepCounts counts = sweep(plan(), dies, options(store, jobs), always);
    EXPECT_EQ(counts.done(), counts.total);
    EXPECT_EQ(counts.ok, 18U);
    EXPECT_EQ(counts.failed, 12U);
    Database database(file(store), Database::Access::kWrite);
    const std::string killed =
        "status = 'failed' AND reason = 'its process has ended with signal 9 (Killed), 3 times" + kAgain +
        "'";
    EXPECT_EQ(database.number("SELECT count(*) FROM points WHERE \"matcher.window\" = 9 AND " + killed), 6);
    EXPECT_EQ(database.number("SELECT count(*) FROM points WHERE " + killed), 6);
    database.execute("DELETE FROM points WHERE " + killed);
  }
  EXPECT_EQ(read_file(file("1.db")), read_file(file("3.db")));
  sweep(plan(), evaluate, options("1.db"), always);
  EXPECT_EQ(read_file(file("1.db")), reference());
}

TEST_F(SweepTest, TakesTheEndOfAProcessOfEvaluateForThatOfTheWorker) {
  const std::string once = file("died");
  const auto child_dies = [&once](const Point& point) {
    if (point.board->matcher.window == 9) throw process::EndedBySignal("the process was ended", SIGSEGV);
    if (!std::filesystem::exists(once)) {
      test::write_file(once, "");
      throw process::EndedBySignal("the process was ended", SIGKILL);
    }
    return evaluate(point);
  };
  const SweepCounts counts = sweep(plan(), child_dies, options("a.db"), always);
  EXPECT_EQ(counts.ok, 18U);
  Database database(file("a.db"), Database::Access::kRead);
  EXPECT_EQ(database.number("SELECT count(*) FROM points WHERE \"matcher.window\" = 9 AND reason = "
                            "'its process has ended with signal 11 (Segmentation fault), 3 times" +
                            kAgain + "'"),
            6);
}

TEST_F(SweepTest, TriesAgainWhereMemoryWasShort) {
  const std::string once = file("short");
  const auto runs_out = [&once](const Point& point) {
    if (point.board->matcher.window == 9) throw std::bad_alloc();
    if (!std::filesystem::exists(once)) {
      test::write_file(once, "");
      throw std::bad_alloc();
    }
    return evaluate(point);
  };
  const SweepCounts counts = sweep(plan(), runs_out, options("a.db"), always);
  EXPECT_EQ(counts.ok, 18U);
  Database database(file("a.db"), Database::Access::kRead);
  EXPECT_EQ(database.number("SELECT count(*) FROM points WHERE \"matcher.window\" = 9 AND reason = "
                            "'its process has run out of memory, 3 times" +
                            kAgain + "'"),
            6);
}

TEST_F(SweepTest, EndsWhereTheMachineLacksSomething) {
  const auto lacks = [](const Point& point) -> Figures {
    if (point.board->matcher.window == 9) throw std::system_error(EAGAIN, std::generic_category(), "fork");
    return evaluate(point);
  };
  EXPECT_EQ(message_of([&] { sweep(plan(), lacks, options("a.db"), always); }),
            "fork: Resource temporarily unavailable");
  EXPECT_GE(points_in(file("a.db")), 18) << "what was done is kept";
  sweep(plan(), evaluate, options("a.db"), always);
  EXPECT_EQ(read_file(file("a.db")), reference());
}

TEST_F(SweepTest, EndsAtAConditionThatCannotBeComputedForAPoint) {
  test::write_file(file("plan.yaml"),
                   "board: fpl2003\nvary: {matcher.window: [3, 5, 7]}\n"
                   "where: iif(matcher.window = 5, json('{' || matcher.window), 1)\n");
  try {
    sweep(plan(), evaluate, options("a.db"), always);
    FAIL() << "there is no such point";
  } catch (const ConditionError& error) {
    EXPECT_EQ(error.what(),
              file("plan.yaml") +
                  ":3:8: where = iif(matcher.window = 5, json('{' || matcher.window), 1): malformed JSON");
  }
  EXPECT_EQ(points_in(file("a.db")), 1) << "what was done is kept";
}

TEST_F(SweepTest, SaysThatItsStoreIsLocked) {
  SweepOptions impatient = options("a.db");
  impatient.busy_timeout = std::chrono::milliseconds(50);
  sweep(plan(), evaluate, impatient, [](const SweepCounts& counts) { return counts.done() < 20; });
  const auto before = points_in(file("a.db"));
  EXPECT_GE(before, 5);
  for (const char* const lock : {"BEGIN IMMEDIATE", "BEGIN EXCLUSIVE"}) {
    Database other(file("a.db"), Database::Access::kWrite);
    other.execute(lock);
    EXPECT_EQ(message_of([&] { sweep(plan(), evaluate, impatient, always); }),
              file("a.db") + ": another process keeps it locked");
  }
  EXPECT_EQ(points_in(file("a.db")), before);
  sweep(plan(), evaluate, impatient, always);
  EXPECT_EQ(read_file(file("a.db")), reference());
}

TEST_F(SweepTest, EndsIfItsStoreIsLockedMeanwhile) {
  SweepOptions impatient = options("a.db", 2);
  impatient.busy_timeout = std::chrono::milliseconds(50);
  std::unique_ptr<Database> other;
  const auto lock = [&](const SweepCounts& counts) {
    if (counts.done() >= 20 && !other) {
      other = std::make_unique<Database>(file("a.db"), Database::Access::kWrite);
      other->execute("BEGIN IMMEDIATE");
    }
    return true;
  };
  EXPECT_EQ(message_of([&] { sweep(plan(), evaluate, impatient, lock); }),
            file("a.db") + ": another process keeps it locked");
  other.reset();
  const SweepCounts counts = sweep(plan(), evaluate, impatient, always);
  EXPECT_GE(counts.known, 5U) << "what was done is kept";
  EXPECT_EQ(read_file(file("a.db")), reference());
}

TEST_F(SweepTest, EndsWhenItsStoreHasGone) {
  for (const bool is_last : {false, true}) {  // at once, or seen only in the end
    std::uint64_t done = 0;
    const auto remove = [&](const SweepCounts& counts) {
      done = counts.done();
      if (done >= (is_last ? 60U : 10U)) std::filesystem::remove(file("a.db"));
      return true;
    };
    EXPECT_THROW(sweep(plan(), evaluate, options("a.db"), remove), StoreGone);
    EXPECT_TRUE(is_last || done < 60);
    EXPECT_FALSE(std::filesystem::exists(file("a.db")));
  }
}

TEST_F(SweepTest, KeepsOtherSweepsOut) {
  bool is_tried = false;
  const auto try_another = [&](const SweepCounts& /*counts*/) {
    if (is_tried) return true;
    is_tried = true;
    EXPECT_EQ(message_of([&] { sweep(plan(), evaluate, options("a.db"), always); }),
              file("a.db") + ": another process is at work on it: wait for its end, or give another file");
    return true;
  };
  sweep(plan(), evaluate, options("a.db"), try_another);
  EXPECT_TRUE(is_tried);
  EXPECT_EQ(read_file(file("a.db")), reference());
}

TEST_F(SweepTest, SaysWhyItsStoreCannotBeUsed) {
  test::write_file(file("a.db"), std::string(5000, 'x'));
  EXPECT_THAT(message_of([&] { sweep(plan(), evaluate, options("a.db"), always); }),
              HasSubstr("a.db: not a database"));
}

TEST_F(SweepTest, TellsOfItsProgress) {
  std::vector<std::uint64_t> done;
  sweep(plan(), evaluate, options("a.db"), [&](const SweepCounts& counts) {
    done.push_back(counts.done());
    EXPECT_EQ(counts.total, 60U);
    return true;
  });
  EXPECT_TRUE(std::is_sorted(done.begin(), done.end()));
  EXPECT_EQ(done.back(), 60U);
}

}  // namespace
}  // namespace stereotlm::explore
