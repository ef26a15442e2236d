#include "sw/explore/sweep/sweep.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "platform/config/board_yaml.h"
#include "sw/explore/plan/plan.h"
#include "sw/explore/plan/points.h"
#include "sw/explore/store/store.h"
#include "sw/process/child.h"
#include "tests/unit/sw/explore/store_files.h"

namespace stereotlm::explore {
namespace {

namespace fs = std::filesystem;
using test::message_of;
using test::read_file;
using test::write_file;
using namespace std::chrono_literals;

// 60 points: 15 are left out by the condition, 15 are impossible, 6 fail, and 24 have made-up figures.
constexpr const char* kPlan =
    "board: fpl2003\n"
    "vary:\n"
    "  matcher.window: [3, 5, 7, 9, 11]\n"
    "  capture.fifo_words: [16, 64, 128]\n"
    "  matcher.disparities: [10, 20, 30, 40]\n"
    "where: matcher.disparities < 40\n";
constexpr std::uint64_t kPoints = 60;
constexpr std::uint64_t kOk = 24;
constexpr std::uint64_t kOkOfAWindow = 6;
constexpr std::uint64_t kStored = 45;

Figures evaluate(const Point& point) {
  if (point.board->matcher.window == 11) throw std::runtime_error("a window that fails");
  return {{{"cycles", std::int64_t{point.board->matcher.window * point.board->matcher.disparities}}},
          {{"left_pixel", "bank0", "host", static_cast<std::uint64_t>(point.board->matcher.window)}}};
}

bool always(const SweepCounts& /*counts*/) { return true; }

class SweepTest : public StoreFiles {
 protected:
  SweepTest() { write_file(file("plan.yaml"), kPlan); }

  Plan plan() const { return Plan::load(file("plan.yaml")); }
  SweepOptions options(const std::string& store, unsigned jobs = 1) const {
    SweepOptions options;
    options.store = file(store);
    options.version = "1";
    options.jobs = jobs;
    return options;
  }
  // The rows of `points` for which a condition is true; 0 if there is no database.
  std::uint64_t count(const std::string& store, const std::string& where = "1") const {
    try {
      return std::stoull(rows(store, "SELECT count(*) FROM points WHERE " + where).at(0));
    } catch (const sqlite::DatabaseError&) {
      return 0;
    }
  }
  std::string sweep_error(const SweepOptions& options, const Evaluate& evaluate_point = evaluate) const {
    return message_of([&] { sweep(plan().points(), evaluate_point, options, always); });
  }
  // Finishes a store, which must then have the bytes of one that a single worker has made without a break.
  SweepCounts expect_whole(const std::string& store) const {
    const SweepCounts counts = sweep(plan().points(), evaluate, options(store, 2), always);
    if (!fs::exists(file("reference.db"))) sweep(plan().points(), evaluate, options("reference.db"), always);
    EXPECT_TRUE(read_file(file(store)) == read_file(file("reference.db"))) << store;
    return counts;
  }
};

TEST_F(SweepTest, StoresAndCountsTheWayInWhichEachPointEnds) {
  std::vector<std::uint64_t> done;
  const SweepCounts counts = sweep(plan().points(), evaluate, options("a.db"), [&](const SweepCounts& now) {
    done.push_back(now.done());
    return now.total == kPoints;
  });
  EXPECT_EQ(counts_text(counts), counts_text({kPoints, 15, 0, kOk, 15, 6, 0}));
  EXPECT_EQ(counts.done(), kPoints);
  EXPECT_TRUE(std::is_sorted(done.begin(), done.end()));
  EXPECT_EQ(done.back(), kPoints);
  EXPECT_EQ(count("a.db"), kStored);
  EXPECT_EQ(count("a.db", "status = 'ok'"), kOk);
  EXPECT_EQ(count("a.db", "status = 'failed' AND reason = 'a window that fails' AND \"matcher.window\" = 11"),
            6U);
  EXPECT_EQ(count("a.db",
                  "status = 'impossible' AND reason = 'capture.fifo_trigger_words = 32: 1..fifo_words, which "
                  "is 16'"),
            15U);
  EXPECT_EQ(rows("a.db", "SELECT sum(cycles) FROM points").at(0),
            std::to_string((3 + 5 + 7 + 9) * (10 + 20 + 30) * 2));
  EXPECT_EQ(rows("a.db", "SELECT sum(cycles) FROM blame").at(0), std::to_string((3 + 5 + 7 + 9) * 3 * 2));
}

TEST(SweepCounts, AreReadBackAndAddUp) {
  const SweepCounts written = {21, 1, 2, 3, 4, 5, 6};
  EXPECT_EQ(counts_text(read_counts(counts_text(written))), counts_text(written));
  EXPECT_EQ(counts_text(read_counts("")), counts_text({}));
  EXPECT_EQ(read_counts("ok 3\nother 4\nfai").done(), 3U);
  SweepCounts sum = written;
  sum.add({40, 10, 0, 20, 0, 1, 2});
  EXPECT_EQ(counts_text(sum), counts_text({61, 11, 2, 23, 4, 6, 8}));
}

TEST_F(SweepTest, GivesTheSameBytesForAnyNumberOfJobs) {
  for (const unsigned jobs : {2U, 3U, 200U}) {
    const std::string store = std::to_string(jobs) + ".db";
    EXPECT_EQ(sweep(plan().points(), evaluate, options(store, jobs), always).ok, kOk);
    expect_whole(store);
  }
}

TEST_F(SweepTest, GivesTheSameBytesInShardsThatAreMerged) {
  for (const std::uint64_t shards : {2U, 7U, 61U}) {
    std::vector<std::string> stores;
    std::uint64_t points = 0;
    for (std::uint64_t shard = shards; shard-- > 0;) {
      stores.push_back(std::to_string(shards) + "_" + std::to_string(shard) + ".db");
      SweepOptions part = options(stores.back());
      part.shard = shard;
      part.shards = shards;
      const SweepCounts counts = sweep(plan().points(), evaluate, part, always);
      EXPECT_EQ(counts.done(), counts.total);
      points += counts.total;
    }
    EXPECT_EQ(points, kPoints);
    merge(stores, "merged.db");
    EXPECT_EQ(expect_whole("merged.db").known, kStored) << shards;
  }
}

// Each point ends once as many processes are at work as there are points.
TEST_F(SweepTest, GivesEachWorkerItsShareAtOnce) {
  write_file(file("eight.yaml"), "board: fpl2003\nvary: {matcher.disparities: [1, 2, 3, 4, 5, 6, 7, 8]}\n");
  const fs::path at_work = file("at_work");
  fs::create_directory(at_work);
  const auto waits = [&at_work](const Point& point) -> Figures {
    write_file(at_work / std::to_string(getpid()), "");
    const auto end = std::chrono::steady_clock::now() + 20s;
    while (std::chrono::steady_clock::now() < end) {
      if (names_in(at_work).size() == 8) return evaluate(point);
      std::this_thread::sleep_for(1ms);
    }
    throw std::runtime_error("other workers are idle");
  };
  EXPECT_EQ(sweep(Plan::load(file("eight.yaml")).points(), waits, options("a.db", 8), always).ok, 8U);
}

TEST_F(SweepTest, KeepsFinishedPointsWhenItIsKilled) {
  for (std::uint64_t attempt = 1; attempt <= 5; ++attempt) {
    const pid_t child = fork();
    if (child == 0) {
      const auto slow = [](const Point& point) {
        std::this_thread::sleep_for(10ms);
        return evaluate(point);
      };
      sweep(plan().points(), slow, options("a.db", 2), always);
      _exit(0);
    }
    while (count("a.db") < 4 * attempt) std::this_thread::sleep_for(1ms);
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
  }
  const std::uint64_t before = count("a.db");
  EXPECT_GE(before, 20U);
  EXPECT_LT(before, kStored) << "the sweep was to be killed before its end";
  EXPECT_GE(expect_whole("a.db").known, before);
}

struct Death {
  std::string text;
  unsigned jobs;
  void (*die)();
};

// The first point of each worker dies once at most, and is begun again; those with the window 9 always die.
TEST_F(SweepTest, BeginsAPointAgainWhoseWorkerHasDiedUntilItHasDiedThreeTimes) {
  const std::vector<Death> deaths = {
      {"ended with signal 9 (Killed)", 1, [] { raise(SIGKILL); }},
      {"ended with signal 9 (Killed)", 3, [] { raise(SIGKILL); }},
      {"ended with signal 11 (Segmentation fault)", 1, [] { throw process::ChildDied(SIGSEGV); }},
      {"ended with exit status 3", 1, [] { _exit(3); }},
      {"run out of memory", 3, [] { throw std::bad_alloc(); }}};
  for (const Death& death : deaths) {
    const auto dies = [&](const Point& point) {
      const bool is_first = !fs::exists(file("died"));
      if (is_first) write_file(file("died"), "");
      if (is_first || point.board->matcher.window == 9) {
        std::ofstream(file("deaths"), std::ios::app) << "x";
        death.die();
      }
      return evaluate(point);
    };
    for (const char* const name : {"died", "deaths", "a.db"}) fs::remove(file(name));
    const SweepCounts counts = sweep(plan().points(), dies, options("a.db", death.jobs), always);
    EXPECT_EQ(counts.done(), kPoints);
    EXPECT_EQ(counts.ok, kOk - kOkOfAWindow) << death.text;
    EXPECT_GE(fs::file_size(file("deaths")), 3 * kOkOfAWindow) << death.text;
    EXPECT_LE(fs::file_size(file("deaths")), 3 * kOkOfAWindow + death.jobs) << death.text;
    EXPECT_EQ(counts.failed, 2 * kOkOfAWindow) << death.text;
    const std::string failed = "status = 'failed' AND \"matcher.window\" = 9 AND reason = 'its process has " +
                               death.text +
                               ", 3 times: to try again, delete this row and give the same command'";
    EXPECT_EQ(count("a.db", failed), kOkOfAWindow) << death.text;
    sqlite::Database(file("a.db"), sqlite::Database::Access::kWrite)
        .execute("DELETE FROM points WHERE " + failed);
    expect_whole("a.db");
  }
}

TEST_F(SweepTest, EndsIfTheMachineLacksSomething) {
  const auto lacks = [](const Point& point) -> Figures {
    if (point.board->matcher.window == 9) throw std::system_error(EAGAIN, std::generic_category(), "fork");
    return evaluate(point);
  };
  EXPECT_EQ(sweep_error(options("a.db"), lacks), "fork: Resource temporarily unavailable");
  EXPECT_GE(count("a.db"), kOk - kOkOfAWindow) << "finished points are kept";
  expect_whole("a.db");
}

TEST_F(SweepTest, ReportsAStoreThatIsLockedBeforeOrWhileItRuns) {
  SweepOptions impatient = options("a.db", 2);
  impatient.busy_timeout = 50ms;
  const std::string locked = file("a.db") + ": another process keeps it locked";
  std::unique_ptr<sqlite::Database> other;
  const auto lock = [&](const SweepCounts& counts) {
    if (counts.done() >= 20 && !other) {
      other = std::make_unique<sqlite::Database>(file("a.db"), sqlite::Database::Access::kWrite);
      other->execute("BEGIN IMMEDIATE");
      write_file(file("locked"), "");
    }
    return true;
  };
  const auto waits_for_lock = [&](const Point& point) {
    while (point.number >= kPoints / 2 && !fs::exists(file("locked"))) std::this_thread::sleep_for(1ms);
    return evaluate(point);
  };
  EXPECT_EQ(message_of([&] { sweep(plan().points(), waits_for_lock, impatient, lock); }), locked);
  other.reset();
  const std::uint64_t before = count("a.db");
  EXPECT_GE(before, 5U) << "finished points are kept";
  for (const char* const begin : {"BEGIN IMMEDIATE", "BEGIN EXCLUSIVE"}) {
    sqlite::Database database(file("a.db"), sqlite::Database::Access::kWrite);
    database.execute(begin);
    EXPECT_EQ(sweep_error(impatient), locked);
  }
  EXPECT_EQ(count("a.db"), before);
  EXPECT_GE(expect_whole("a.db").known, before);
}

TEST_F(SweepTest, EndsWhenItsStoreIsGone) {
  for (const bool is_last : {false, true}) {  // while points are simulated, or after the last of them
    std::uint64_t done = 0;
    const auto remove = [&](const SweepCounts& counts) {
      done = counts.done();
      if (done >= (is_last ? kPoints : 10U)) fs::remove(file("a.db"));
      return true;
    };
    const auto waits_for_removal = [&](const Point& point) {
      while (!is_last && point.number >= kPoints / 2 && fs::exists(file("a.db")))
        std::this_thread::sleep_for(1ms);
      return evaluate(point);
    };
    EXPECT_EQ(message_of([&] { sweep(plan().points(), waits_for_removal, options("a.db"), remove); }),
              file("a.db") + ": was removed or replaced while in use: its points are lost");
    EXPECT_TRUE(is_last || done < kPoints);
    EXPECT_FALSE(fs::exists(file("a.db")));
  }
}

TEST_F(SweepTest, RefusesAStoreThatAnotherSweepUses) {
  bool is_tried = false;
  sweep(plan().points(), evaluate, options("a.db"), [&](const SweepCounts& /*counts*/) {
    if (std::exchange(is_tried, true)) return true;
    EXPECT_EQ(sweep_error(options("a.db")),
              file("a.db") + ": another process is at work on it: wait for its end, or give another file");
    return true;
  });
  EXPECT_TRUE(is_tried);
  expect_whole("a.db");
}

}  // namespace
}  // namespace stereotlm::explore
