#include "sw/explore/slurm/shard_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sw/explore/slurm/slurm.h"
#include "tests/unit/sw/explore/store_files.h"

namespace stereotlm::explore {
namespace {

using test::message_of;
using test::read_file;
using test::write_file;
using ::testing::EndsWith;

ShardedSweep three_shards() {
  ShardedSweep sweep;
  sweep.plan = "board: fpl2003\n";
  sweep.version = "1";
  sweep.points = 10;
  sweep.shards = 3;
  return sweep;
}

class ShardFolderTest : public StoreFiles {
 protected:
  ShardFolderTest() { folder.lock(); }

  static std::string shard_file(const std::string& name) { return "a.db.shards/" + name; }
  void write(const std::string& name, const std::string& text) const {
    write_file(file(shard_file(name)), text);
  }

  std::string store = file("a.db");
  ShardFolder folder{store};
};

TEST_F(ShardFolderTest, BelongsToTheSweepThatHasBegunIt) {
  EXPECT_FALSE(folder.is_of(three_shards()));
  std::vector<ShardedSweep> sweeps(7, three_shards());
  sweeps[1].plan += "run: {source: preloaded}\n";
  sweeps[2].board = "extends: fpl2003\n";
  sweeps[3].shards = 4;
  sweeps[4].version = "2";
  sweeps[5].calibration = {"a", "b", "c"};
  sweeps[6].calibration = {"a", "b", "d"};
  for (const std::size_t begun : {0U, 5U}) {
    folder.begin(sweeps[begun]);
    for (std::size_t i = 0; i < sweeps.size(); ++i) EXPECT_EQ(folder.is_of(sweeps[i]), i == begun) << i;
  }
}

TEST_F(ShardFolderTest, KeepsThePointsOfAllShards) {
  add("a.db", {ok_point("h1")});
  folder.begin(three_shards());
  add(shard_file("shard_0.db"), {ok_point("h2")});
  add(shard_file("shard_1.work"), {ok_point("h3")});
  write("shard_2.work", "");  // of a task that has just begun
  folder.keep_points("1");
  add("expected.db", {ok_point("h1"), ok_point("h2"), ok_point("h3")});
  merge({"expected.db"}, "expected.db");
  EXPECT_EQ(read_file(store), read_file(file("expected.db")));
}

TEST_F(ShardFolderTest, RefusesAStoreOfAnotherVersionOrWithBanksThatDifferOnlyInCase) {
  StoredPoint point = ok_point("h1");
  point.keys = {{"ssram.banks.a.words", std::int64_t{1}}};
  add("a.db", {point});
  ShardedSweep sweep = three_shards();
  sweep.banks = {"A"};
  EXPECT_THAT(message_of([&] { folder.begin(sweep); }), EndsWith("only in case: give another file"));
  sweep.version = "2";
  EXPECT_THAT(message_of([&] { folder.begin(sweep); }),
              EndsWith("a.db: holds points of version 1; this is version 2: give another file"));
}

TEST(Slurm, TaskIsLiveUntilItHasEnded) {
  for (const char* state : {"PENDING", "RUNNING", "COMPLETING", "CONFIGURING", "SUSPENDED", "REQUEUED"})
    EXPECT_TRUE((SlurmTask{"1", 0, state, ""}.is_live())) << state;
  for (const char* state : {"COMPLETED", "FAILED", "CANCELLED", "TIMEOUT", "NODE_FAIL", "OUT_OF_MEMORY"})
    EXPECT_FALSE((SlurmTask{"1", 0, state, ""}.is_live())) << state;
}

TEST(Slurm, ArrayNamesRanges) {
  EXPECT_EQ(array_text({0}), "0");
  EXPECT_EQ(array_text({0, 1, 2, 3}), "0-3");
  EXPECT_EQ(array_text({0, 3, 5, 6, 9}), "0,3,5-6,9");
}

}  // namespace
}  // namespace stereotlm::explore
