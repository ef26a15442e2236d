#include "sw/explore/store/store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "tests/unit/sw/explore/store_files.h"

namespace stereotlm::explore {
namespace {

namespace fs = std::filesystem;
using test::message_of;
using test::read_file;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kVersion = "1";

StoredPoint point(const std::string& hash, std::int64_t cycles = 7) {
  StoredPoint point = ok_point(hash);
  point.config = "name: x\n";
  point.keys = {{"image.width", std::int64_t{640}}};
  point.figures = {{{"cycles", cycles}, {"rate", 0.5}}, {{"left_pixel", "bank0", "host", 3}}};
  return point;
}

StoredPoint point_with_key(const std::string& hash, const std::string& key) {
  StoredPoint point = ok_point(hash);
  point.keys = {{key, std::int64_t{1}}};
  return point;
}

class StoreTest : public StoreFiles {
 protected:
  std::string open_error(const std::string& name, const std::string& version = kVersion) const {
    return message_of([&] { Store(file(name), version); });
  }
};

TEST_F(StoreTest, KeepsARowForEachPoint) {
  {
    Store store(file("a.db"), kVersion);
    EXPECT_FALSE(store.has("h1"));
    EXPECT_TRUE(store.add(point("h1", 7)));
    EXPECT_TRUE(store.has("h1"));
    EXPECT_THAT(hashes("a.db"), ElementsAre("h1"));
    EXPECT_FALSE(store.add(point("h1", 8))) << "the first of equal points stays";
  }
  EXPECT_THAT(
      rows("a.db", "SELECT hash, status, reason, version, config, \"image.width\", cycles, rate FROM points"),
      ElementsAre("h1|ok||1|name: x\n|640|7|0.5"));
  EXPECT_THAT(rows("a.db", "SELECT * FROM blame"), ElementsAre("h1|left_pixel|bank0|host|3"));
  Store store(file("a.db"), kVersion);
  EXPECT_TRUE(store.has("h1"));
  EXPECT_TRUE(store.add(point("h2")));
}

TEST_F(StoreTest, AddsAPointAfterOneWithTheSameNewColumnsThatCouldNotBeAdded) {
  Store store(file("a.db"), kVersion);
  StoredPoint broken = point("h1");
  broken.figures.blame.push_back(broken.figures.blame.front());  // the same row twice
  EXPECT_THAT(message_of([&] { store.add(broken); }), HasSubstr("UNIQUE constraint failed"));
  EXPECT_FALSE(store.has("h1"));
  EXPECT_THAT(rows("a.db", "SELECT count(*) FROM pragma_table_info('points')"), ElementsAre("5"));
  EXPECT_TRUE(store.add(point("h1")));
  EXPECT_THAT(rows("a.db", "SELECT hash, \"image.width\", cycles FROM points"), ElementsAre("h1|640|7"));
}

TEST_F(StoreTest, TakesPointsWithAnyColumnsFromSeveralConnections) {
  Store one(file("a.db"), kVersion);
  Store two(file("a.db"), kVersion);
  one.add(point("h1"));
  two.add(point("h2"));
  StoredPoint other = point("h3");
  other.keys.push_back({"select \"from\"", "a'b"});
  other.figures.values = {{"frames_per_second.system", 2.5}};
  one.add(other);
  other.hash = "h4";
  two.add(other);
  one.add(point("h5"));
  EXPECT_TRUE(two.has("h5"));
  EXPECT_THAT(rows("a.db",
                   "SELECT hash, cycles, \"frames_per_second.system\", \"select \"\"from\"\"\" FROM points "
                   "ORDER BY hash"),
              ElementsAre("h1|7||", "h2|7||", "h3||2.5|a'b", "h4||2.5|a'b", "h5|7||"));
}

TEST_F(StoreTest, DescribesItsColumns) {
  StoredPoint other = point("h2");
  other.keys.push_back({"bridge.posted_words", std::int64_t{64}});
  other.figures.values.push_back({"bridge.posted_words.counted", std::int64_t{9}});
  add("a.db", {point("h1")});
  add("b.db", {other});
  merge({"a.db", "b.db"}, "ab.db");
  const std::string all = "SELECT name, unit, meaning, varied FROM columns WHERE ";
  EXPECT_THAT(rows("a.db", all + "is_key"), ElementsAre("image.width|pixels|width of the images, at most "
                                                        "2048 with a look-up table|"));
  EXPECT_THAT(rows("ab.db", all + "is_key"),
              ElementsAre("bridge.posted_words|words|posted writes that the bridge can hold|1",
                          "image.width|pixels|width of the images, at most 2048 with a look-up table|0"));
  EXPECT_THAT(rows("ab.db", all + "name LIKE '%counted' OR name = 'hash'"),
              ElementsAre("bridge.posted_words.counted|words|that masters wrote into the bridge|1",
                          "hash||SHA-256 of board and run|1"));
  add("ab.db", {point("h3")});
  EXPECT_THAT(rows("ab.db", "SELECT DISTINCT varied FROM columns"), ElementsAre("")) << "until it is merged";
}

TEST_F(StoreTest, ComparesFiguresAmongThePointsThatHaveThem) {
  StoredPoint impossible = point_with_key("h0", "image.width");
  impossible.status = "impossible";
  add("a.db", {impossible, point("h1"), point("h2")});
  merge({"a.db"}, "a.db");
  EXPECT_THAT(rows("a.db", "SELECT name FROM columns WHERE varied ORDER BY 1"),
              ElementsAre("config", "hash", "image.width", "status"));
}

TEST_F(StoreTest, HasAViewWhoseNamesNeedNoQuotes) {
  StoredPoint other = point("h1");
  other.figures.values = {{"banks.a-b.reads", std::int64_t{1}}, {"banks.a_b.reads", std::int64_t{2}}};
  const std::string query = "SELECT image_width, banks_a_b_reads, banks_a_b_reads_2 FROM plain";
  add("a.db", {other});
  EXPECT_THAT(rows("a.db", query), ElementsAre("640|1|2"));
  merge({"a.db"}, "a.db");
  EXPECT_THAT(rows("a.db", query), ElementsAre("640|1|2"));
  EXPECT_THAT(message_of([&] { rows("a.db", "SELECT image_widht FROM plain"); }),
              HasSubstr("no such column: image_widht"));
}

TEST_F(StoreTest, HoldsPointsOfOneVersion) {
  add("a.db", {point("h1")});
  const std::string text = file("a.db") + ": holds points of version 1; this is version 2: give another file";
  EXPECT_EQ(open_error("a.db", "2"), text);
  EXPECT_EQ(message_of([&] { StoredRow(file("a.db"), "2"); }), text);
  for (const std::string hash : {"h0", "h1", "h2"}) {
    add(hash + ".db", {point(hash)}, "2");
    EXPECT_THAT(merge_error({"a.db", hash + ".db"}, "c.db"),
                AllOf(HasSubstr(hash + ".db"), HasSubstr("version 2"), HasSubstr(": they do not mix")));
    EXPECT_FALSE(fs::exists(file("c.db")));
  }
  EXPECT_EQ(merge_error({"a.db", "h2.db"}, "c.db"), file("h2.db") + ": holds points of version 2, and " +
                                                        file("a.db") + " of version 1: they do not mix");
}

TEST_F(StoreTest, RefusesFilesThatAreNotItsOwn) {
  const auto make = [this](const std::string& name, const std::string& sql) {
    sqlite::Database(file(name), sqlite::Database::Access::kCreate).execute(sql);
  };
  add("a.db", {point("h1")});
  test::write_file(file("text"), std::string(5000, 'x'));
  make("foreign.db", "CREATE TABLE points(x)");
  make("early.db", "PRAGMA application_id = 0x53544C4D; PRAGMA user_version = 1; CREATE TABLE points(hash)");
  const std::string layout =
      file("early.db") + ": its layout is 1, of another version; this version writes 3";
  EXPECT_EQ(open_error("text"), file("text") + ": not a database");
  EXPECT_THAT(merge_error({"a.db"}, "text"), HasSubstr("text: not a database"));
  EXPECT_EQ(read_file(file("text")), std::string(5000, 'x'));
  EXPECT_EQ(open_error("foreign.db"), file("foreign.db") + ": not a database of stereotlm sweep");
  EXPECT_EQ(open_error("early.db"), layout);
  EXPECT_EQ(merge_error({"early.db"}, "new.db"), layout);
  EXPECT_THAT(open_error("none/a.db"), HasSubstr("No such file or directory"));
  EXPECT_THAT(merge_error({"none.db"}, "c.db"), HasSubstr("none.db: "));
  EXPECT_FALSE(fs::exists(file("none.db")));
}

TEST_F(StoreTest, HasNoColumnsThatDifferOnlyInCase) {
  add("a.db", {point_with_key("h1", "ssram.banks.a.words")});
  add("b.db", {point_with_key("h2", "ssram.banks.A.words")});
  const Store store(file("a.db"), kVersion);
  store.check_banks({"a", "b"});
  EXPECT_EQ(message_of([&store] {
              store.check_banks({"b", "A"});
            }),
            file("a.db") +
                ": its column ssram.banks.a.words differs from ssram.banks.A.words only in case: "
                "give another file");
  EXPECT_EQ(merge_error({"a.db", "b.db"}, "c.db"),
            file("b.db") + ": its column ssram.banks.A.words differs from ssram.banks.a.words of " +
                file("a.db") + " only in case: they do not mix");
}

TEST_F(StoreTest, MergesToTheSameBytesInAnyOrder) {
  StoredPoint wide = point("h2");
  wide.keys = {{"matcher.window", std::int64_t{7}}};
  for (const char* const bank : {"bank10", "bank2", "bank1", "bank12", "bank"})
    wide.figures.values.push_back({std::string("banks.") + bank + ".reads", std::int64_t{1}});
  add("a.db", {point("h3")});
  add("b.db", {wide, point("h1")});
  add("all.db", {point("h1"), wide, point("h3")});
  test::write_file(file("ab.db"), "");
  merge({"a.db", "b.db"}, "ab.db");
  merge({"b.db", "a.db", "b.db"}, "ba.db");
  merge({"all.db"}, "all.db");
  merge({"ab.db"}, "again.db");
  for (const char* const name : {"ba.db", "all.db", "again.db"})
    EXPECT_EQ(read_file(file(name)), read_file(file("ab.db"))) << name;
  EXPECT_THAT(rows("ab.db", "SELECT hash FROM points"), ElementsAre("h1", "h2", "h3"));
  EXPECT_THAT(rows("ab.db", "SELECT name FROM pragma_table_info('points') WHERE cid > 4"),
              ElementsAre("banks.bank.reads", "banks.bank1.reads", "banks.bank2.reads", "banks.bank10.reads",
                          "banks.bank12.reads", "cycles", "image.width", "matcher.window", "rate"));
  EXPECT_THAT(rows("ab.db", "SELECT hash, cycles FROM blame"), ElementsAre("h1|3", "h2|3", "h3|3"));
  Store continued(file("ab.db"), kVersion);
  EXPECT_FALSE(continued.add(point("h1")));
  EXPECT_TRUE(continued.add(point("h0")));
}

TEST_F(StoreTest, DoesNotMergeDifferentResultsOfAPoint) {
  StoredPoint blamed = point("h1");
  blamed.figures.blame.push_back({"result", "bank0", "host", 4});
  add("a.db", {point("h1")});
  add("b.db", {point("h1", 8)});
  add("blamed.db", {blamed});
  for (const std::string other : {"b.db", "blamed.db"}) {
    EXPECT_EQ(merge_error({"a.db", other}, "c.db"),
              file(other) + ": holds another result of point h1 than " + file("a.db"));
    EXPECT_EQ(merge_error({other, "a.db"}, "c.db"),
              file("a.db") + ": holds another result of point h1 than " + file(other));
  }
  EXPECT_THAT(names(), Not(Contains(HasSubstr("c.db"))));
}

// A process has added a point and ended at once, so that only the journal has the point. The journal may be
// gone after the merge, even if that fails.
TEST_F(StoreTest, BringsItsJournalIntoTheFileBeforeItIsReplaced) {
  add("a.db", {point("h1")});
  const pid_t child = fork();
  if (child == 0) {
    auto* const store = new Store(file("a.db"), kVersion);
    store->add(point("h2"));
    _exit(0);
  }
  waitpid(child, nullptr, 0);
  ASSERT_GT(fs::file_size(file("a.db-wal")), 0U);
  EXPECT_THAT(merge_error({"a.db", "none.db"}, "a.db"), HasSubstr("none.db: "));
  for (const char* const ending : {"-wal", "-shm"}) fs::remove(file("a.db") + ending);
  EXPECT_THAT(hashes("a.db"), ElementsAre("h1", "h2"));
}

TEST_F(StoreTest, BehindALinkIsReplacedAndTheLinkStays) {
  fs::create_directory(file("real"));
  fs::create_symlink("real/b.db", file("b.db"));
  add("a.db", {point("h1")});
  add("b.db", {point("h2")});
  ASSERT_EQ(chmod(file("real/b.db").c_str(), 0640), 0);
  merge({"a.db", "b.db"}, "b.db");
  EXPECT_TRUE(fs::is_symlink(file("b.db")));
  EXPECT_THAT(hashes("real/b.db"), ElementsAre("h1", "h2"));
  EXPECT_EQ(fs::status(file("b.db")).permissions(), fs::perms{0640});
  EXPECT_THAT(names_in(file("real")), ElementsAre("b.db")) << "without its journal";
}

}  // namespace
}  // namespace stereotlm::explore
