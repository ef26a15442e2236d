#include "sw/explore/slurm/shard_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <filesystem>
#include <string>
#include <vector>

#include "sw/explore/store/merge_stores.h"
#include "sw/explore/store/store.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::explore {
namespace {

namespace fs = std::filesystem;
using test::message_of;
using test::read_file;
using ::testing::EndsWith;
using ::testing::UnorderedElementsAre;

ShardedSweep three_shards() {
  ShardedSweep sweep;
  sweep.plan = "board: fpl2003\n";
  sweep.version = "1";
  sweep.points = 10;
  sweep.shards = 3;
  return sweep;
}

class ShardFolderTest : public ::testing::Test {
 protected:
  std::string store() const { return (scratch_.path() / "a.db").string(); }
  std::string file(const std::string& name) const { return store() + ".shards/" + name; }
  static void add(const std::string& path, const std::string& hash, const std::string& version = "1") {
    StoredPoint point;
    point.hash = hash;
    point.status = "ok";
    Store(path, version).add(point);
  }
  static std::vector<std::string> names(const fs::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder))
      names.push_back(entry.path().filename().string());
    return names;
  }

 private:
  test::ScratchFolder scratch_;
};

TEST(ShardedSweep, SharesItsPoints) {
  EXPECT_EQ(three_shards().points_of(0), 4U);
  EXPECT_EQ(three_shards().points_of(1), 3U);
  EXPECT_EQ(three_shards().points_of(2), 3U);
  ShardedSweep more = three_shards();
  more.shards = 11;
  EXPECT_EQ(more.points_of(10), 0U);
}

TEST_F(ShardFolderTest, IsOfTheSweepThatHasBegunIt) {
  ShardFolder folder(store());
  folder.lock();
  EXPECT_FALSE(folder.is_of(three_shards()));
  folder.begin(three_shards());
  EXPECT_TRUE(folder.is_of(three_shards()));
  ShardedSweep other = three_shards();
  other.plan += "run: {source: preloaded}\n";
  EXPECT_FALSE(folder.is_of(other));
  other = three_shards();
  other.board = "extends: fpl2003\n";
  EXPECT_FALSE(folder.is_of(other));
  other = three_shards();
  other.calibration = {"a", "b", "c"};
  EXPECT_FALSE(folder.is_of(other));
  folder.begin(other);
  EXPECT_TRUE(folder.is_of(other));
  other.calibration->right_lut = "d";
  EXPECT_FALSE(folder.is_of(other));
  folder.begin(three_shards());
  other = three_shards();
  other.shards = 4;
  EXPECT_FALSE(folder.is_of(other));
  other = three_shards();
  other.version = "2";
  EXPECT_FALSE(folder.is_of(other));
}

TEST_F(ShardFolderTest, HoldsWhatItsTasksNeedAndNothingElse) {
  ShardFolder folder(store());
  folder.lock();
  ShardedSweep sweep = three_shards();
  sweep.board = "extends: fpl2003\n";
  sweep.calibration = {"the rig", "left", "right"};
  folder.begin(sweep);
  EXPECT_EQ(read_file(file("plan.yaml")), sweep.plan);
  EXPECT_EQ(read_file(file("board.yaml")), *sweep.board);
  EXPECT_THAT(names(folder.path()),
              UnorderedElementsAre("lock", "sweep", "plan.yaml", "board.yaml", "calibration.yaml",
                                   "calibration_left.lut", "calibration_right.lut", "task.sh", "merge.sh"));
  EXPECT_EQ(read_file(file("calibration.yaml")), "the rig");
  EXPECT_EQ(read_file(file("calibration_left.lut")), "left");
  EXPECT_EQ(read_file(file("calibration_right.lut")), "right");
  folder.begin(three_shards());
  EXPECT_FALSE(fs::exists(file("calibration.yaml")));
  EXPECT_FALSE(fs::exists(file("board.yaml")));
  folder.remove();
  EXPECT_FALSE(folder.exists());
}

TEST_F(ShardFolderTest, LetsOneProcessIn) {
  ShardFolder folder(store());
  folder.lock();
  ShardFolder other(store());
  EXPECT_THAT(message_of([&] { other.lock(); }),
              EndsWith("a.db.shards: another process waits for these shards already"));
}

TEST_F(ShardFolderTest, SaysWhatIsThereAsOfTheLastLook) {
  ShardFolder folder(store());
  folder.lock();
  folder.begin(three_shards());
  test::write_file(file("shard_1.db"), "");
  test::write_file(file("shard_2.work"), "");
  test::write_file(file("shard_1.progress"), "ok 3\n");
  EXPECT_FALSE(folder.is_whole(1));
  folder.look();
  EXPECT_FALSE(folder.is_whole(0));
  EXPECT_TRUE(folder.is_whole(1));
  EXPECT_FALSE(folder.is_whole(2));
  EXPECT_EQ(folder.counts(1).ok, 3U);
  EXPECT_EQ(folder.counts(0).done(), 0U);
}

TEST_F(ShardFolderTest, IsMergedIfTheStoreIsThereToo) {
  ShardFolder folder(store());
  folder.lock();
  folder.begin(three_shards());
  test::write_file(file("merged"), "");
  folder.look();
  EXPECT_FALSE(folder.is_merged());
  add(store(), "h1");
  EXPECT_TRUE(folder.is_merged());
}

TEST_F(ShardFolderTest, KeepsThePointsOfAllShards) {
  add(store(), "h1");
  ShardFolder folder(store());
  folder.lock();
  folder.begin(three_shards());
  add(file("shard_0.db"), "h2");
  add(file("shard_1.work"), "h3");
  test::write_file(file("shard_2.work"), "");  // its task has just begun
  folder.keep_points("1");
  add(file("expected.work"), "h1");
  add(file("expected.work"), "h2");
  add(file("expected.work"), "h3");
  merge_stores({file("expected.work")}, file("expected.work"));
  EXPECT_EQ(read_file(store()), read_file(file("expected.work")));
}

TEST_F(ShardFolderTest, KeepsThePointsOfManyShardsWithFewOpenFiles) {
  constexpr int kShards = 40;
  ShardFolder folder(store());
  folder.lock();
  folder.begin(three_shards());
  for (int shard = 0; shard < kShards; ++shard)
    add(file("shard_" + std::to_string(shard) + ".work"), "h" + std::to_string(shard));
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit few = {64, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &few), 0);
  folder.keep_points("1");
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
  EXPECT_EQ(Database(store(), Database::Access::kRead).number("SELECT count(*) FROM points"), kShards);
}

TEST_F(ShardFolderTest, DoesNotMakeAStoreOfNothing) {
  ShardFolder folder(store());
  folder.lock();
  folder.begin(three_shards());
  folder.keep_points("1");
  EXPECT_FALSE(fs::exists(store()));
}

TEST_F(ShardFolderTest, DoesNotMixVersions) {
  add(store(), "h1", "0");
  ShardFolder folder(store());
  folder.lock();
  EXPECT_THAT(message_of([&] { folder.begin(three_shards()); }),
              EndsWith("a.db: holds points of version 0; this is version 1: give another file"));
}

TEST_F(ShardFolderTest, DoesNotMixBanksWhoseNamesDifferOnlyInCase) {
  StoredPoint point;
  point.hash = "h1";
  point.status = "ok";
  point.keys = {{"ssram.banks.a.words", std::int64_t{1}}};
  Store(store(), "1").add(point);
  ShardFolder folder(store());
  folder.lock();
  ShardedSweep sweep = three_shards();
  sweep.banks = {"A"};
  EXPECT_THAT(message_of([&] { folder.begin(sweep); }), EndsWith("only in case: give another file"));
}

TEST_F(ShardFolderTest, GivesTheStoreTheFormThatManyMayRead) {
  add(store(), "h1");
  ShardFolder folder(store());
  folder.lock();
  folder.begin(three_shards());
  FinishedStore read(store(), "1");
  EXPECT_TRUE(read.has("h1"));
  EXPECT_FALSE(fs::exists(store() + "-shm"));
}

TEST_F(ShardFolderTest, FindsTheLastLineOfALog) {
  EXPECT_EQ(ShardFolder::last_line(test::write_file(file("log"), "one\ntwo\n\n")), "two");
  EXPECT_EQ(ShardFolder::last_line(test::write_file(file("log"), "one")), "one");
  EXPECT_EQ(ShardFolder::last_line(file("none")), "");
}

}  // namespace
}  // namespace stereotlm::explore
