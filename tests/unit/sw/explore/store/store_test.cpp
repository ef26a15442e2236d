#include "sw/explore/store/store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <iterator>
#include <string>
#include <vector>

#include "sw/explore/store/merge_stores.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::explore {
namespace {

using test::message_of;
using test::read_file;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kVersion = "1.2.3";

StoredPoint point(const std::string& hash, std::int64_t cycles = 7) {
  return {hash,
          "ok",
          "",
          "name: x\n",
          {{"image.width", std::int64_t{640}}},
          {{"cycles", cycles}, {"rate", 0.5}},
          {{"left_pixel", "bank0", "host", 3}}};
}

class StoreTest : public ::testing::Test {
 protected:
  std::string file(const std::string& name) const { return (folder_.path() / name).string(); }
  std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      found.push_back(entry.path().filename().string());
    return found;
  }
  // The rows that a query gives, their columns joined by "|".
  static std::vector<std::string> rows(const std::string& path, const std::string& sql) {
    Database database(path, Database::Access::kRead);
    Statement statement(database, sql);
    std::vector<std::string> found;
    while (statement.step()) {
      std::string row;
      for (int column = 0; column < statement.columns(); ++column)
        row += (column > 0 ? "|" : "") + statement.text(column);
      found.push_back(row);
    }
    return found;
  }
  static std::vector<std::string> hashes(const std::string& path) {
    return rows(path, "SELECT hash FROM points ORDER BY hash");
  }

 private:
  test::ScratchFolder folder_;
};

TEST_F(StoreTest, KeepsARowForEachPoint) {
  {
    Store store(file("a.db"), kVersion);
    EXPECT_FALSE(store.has("h1"));
    EXPECT_TRUE(store.add(point("h1")));
    EXPECT_TRUE(store.has("h1"));
    EXPECT_THAT(hashes(file("a.db")), ElementsAre("h1"));
  }
  EXPECT_THAT(rows(file("a.db"),
                   "SELECT hash, status, reason, version, config, \"image.width\", cycles, rate FROM points"),
              ElementsAre("h1|ok||1.2.3|name: x\n|640|7|0.5"));
  EXPECT_THAT(rows(file("a.db"), "SELECT * FROM blame"), ElementsAre("h1|left_pixel|bank0|host|3"));
}

TEST_F(StoreTest, KeepsTheFirstOfTwoEqualPoints) {
  Store store(file("a.db"), kVersion);
  EXPECT_TRUE(store.add(point("h1", 7)));
  EXPECT_FALSE(store.add(point("h1", 8)));
  EXPECT_THAT(rows(file("a.db"), "SELECT cycles FROM points"), ElementsAre("7"));
}

TEST_F(StoreTest, AddsAPointAfterOneWithTheSameNewColumnsThatCouldNotBeAdded) {
  Store store(file("a.db"), kVersion);
  StoredPoint broken = point("h1");
  broken.blame.push_back(broken.blame.front());  // twice the same row
  EXPECT_THAT(message_of([&] { store.add(broken); }), HasSubstr("UNIQUE constraint failed"));
  EXPECT_FALSE(store.has("h1"));
  EXPECT_THAT(rows(file("a.db"), "SELECT count(*) FROM pragma_table_info('points')"), ElementsAre("5"));
  EXPECT_TRUE(store.add(point("h1")));
  EXPECT_THAT(rows(file("a.db"), "SELECT hash, \"image.width\", cycles FROM points"),
              ElementsAre("h1|640|7"));
}

TEST_F(StoreTest, TakesPointsWithOtherFigures) {
  Store store(file("a.db"), kVersion);
  store.add(point("h1"));
  StoredPoint other = point("h2");
  other.figures = {{"frames_per_second.system", 2.5}};
  store.add(other);
  store.add(point("h3"));
  EXPECT_THAT(rows(file("a.db"), "SELECT cycles, \"frames_per_second.system\" FROM points ORDER BY hash"),
              ElementsAre("7|", "|2.5", "7|"));
}

TEST_F(StoreTest, MayBeAddedToFromSeveralConnections) {
  Store one(file("a.db"), kVersion);
  Store two(file("a.db"), kVersion);
  one.add(point("h1"));
  two.add(point("h2"));
  StoredPoint wide = point("h3");
  wide.keys.push_back({"new", std::int64_t{1}});
  one.add(wide);
  wide.hash = "h4";
  two.add(wide);
  one.add(point("h5"));
  EXPECT_TRUE(two.has("h5"));
  EXPECT_THAT(hashes(file("a.db")), ElementsAre("h1", "h2", "h3", "h4", "h5"));
  EXPECT_THAT(rows(file("a.db"), "SELECT name FROM keys"), ElementsAre("image.width", "new"));
}

TEST_F(StoreTest, SaysWhichColumnsAreKeys) {
  StoredPoint other = point("h2");
  other.keys.push_back({"bridge.posted_words", std::int64_t{64}});
  other.figures.push_back({"bridge.posted_words.counted", std::int64_t{9}});
  { Store(file("a.db"), kVersion).add(point("h1")); }
  { Store(file("b.db"), kVersion).add(other); }
  merge_stores({file("a.db"), file("b.db")}, file("ab.db"));
  EXPECT_THAT(rows(file("a.db"), "SELECT name FROM keys"), ElementsAre("image.width"));
  for (const char* const name : {"b.db", "ab.db"}) {
    EXPECT_THAT(rows(file(name), "SELECT name FROM keys"), ElementsAre("bridge.posted_words", "image.width"));
  }
}

TEST_F(StoreTest, IsContinued) {
  { Store(file("a.db"), kVersion).add(point("h1")); }
  Store store(file("a.db"), kVersion);
  EXPECT_TRUE(store.has("h1"));
  EXPECT_TRUE(store.add(point("h2")));
}

TEST_F(StoreTest, IsOnlyReadOnceItIsFinished) {
  { Store(file("a.db"), kVersion).add(point("h1")); }
  merge_stores({file("a.db")}, file("a.db"));
  const std::string before = test::read_file(file("a.db"));
  FinishedStore one(file("a.db"), kVersion);
  FinishedStore two(file("a.db"), kVersion);
  EXPECT_TRUE(one.has("h1"));
  EXPECT_TRUE(two.has("h1"));
  EXPECT_FALSE(one.has("h2"));
  EXPECT_FALSE(std::filesystem::exists(file("a.db-shm"))) << "what machines would have to share";
  EXPECT_EQ(test::read_file(file("a.db")), before);
  EXPECT_EQ(message_of([&] { FinishedStore(file("a.db"), "1.2.4"); }),
            file("a.db") + ": holds points of version 1.2.3; this is version 1.2.4: give another file");
}

TEST_F(StoreTest, HoldsPointsOfOneVersion) {
  { Store(file("a.db"), kVersion).add(point("h1")); }
  EXPECT_EQ(message_of([&] { Store(file("a.db"), "1.2.4"); }),
            file("a.db") + ": holds points of version 1.2.3; this is version 1.2.4: give another file");
}

TEST_F(StoreTest, RefusesFilesThatAreNotItsOwn) {
  test::write_file(file("text"), std::string(5000, 'x'));
  EXPECT_EQ(message_of([&] { Store(file("text"), kVersion); }), file("text") + ": not a database");
  {
    Database foreign(file("foreign.db"), Database::Access::kCreate);
    foreign.execute("CREATE TABLE points(x)");
  }
  EXPECT_EQ(message_of([&] { Store(file("foreign.db"), kVersion); }),
            file("foreign.db") + ": not a database of stereotlm sweep");
  {
    Database early(file("early.db"), Database::Access::kCreate);
    early.execute("PRAGMA application_id = 0x53544C4D; PRAGMA user_version = 1; CREATE TABLE points(hash)");
  }
  const std::string other_layout = ": its layout is 1, of another version; this version writes 2";
  EXPECT_EQ(message_of([&] { Store(file("early.db"), kVersion); }), file("early.db") + other_layout);
  EXPECT_EQ(message_of([&] { merge_stores({file("early.db")}, file("new.db")); }),
            file("early.db") + other_layout);
  EXPECT_EQ(read_file(file("text")), std::string(5000, 'x'));
  EXPECT_THAT(message_of([&] { Store(file("none/a.db"), kVersion); }),
              HasSubstr("No such file or directory"));
}

TEST_F(StoreTest, KeepsColumnsWhoseNamesAreWordsOfSql) {
  StoredPoint odd = point("h1");
  odd.keys = {{"select \"from\"", "a'b"}};
  Store(file("a.db"), kVersion).add(odd);
  EXPECT_THAT(rows(file("a.db"), "SELECT \"select \"\"from\"\"\" FROM points"), ElementsAre("a'b"));
}

TEST_F(StoreTest, MergesToTheSameBytesInAnyOrder) {
  StoredPoint wide = point("h2");
  wide.keys = {{"matcher.window", std::int64_t{7}}};
  for (const char* const bank : {"bank10", "bank2", "bank1", "bank12", "bank"})
    wide.figures.push_back({std::string("banks.") + bank + ".reads", std::int64_t{1}});
  { Store(file("a.db"), kVersion).add(point("h3")); }
  {
    Store b(file("b.db"), kVersion);
    b.add(wide);
    b.add(point("h1"));
  }
  {
    Store all(file("all.db"), kVersion);
    for (const StoredPoint& one : {point("h1"), wide, point("h3")}) all.add(one);
  }
  merge_stores({file("a.db"), file("b.db")}, file("ab.db"));
  merge_stores({file("b.db"), file("a.db"), file("b.db")}, file("ba.db"));
  merge_stores({file("all.db")}, file("all.db"));
  EXPECT_EQ(read_file(file("ab.db")), read_file(file("ba.db")));
  EXPECT_EQ(read_file(file("ab.db")), read_file(file("all.db")));
  EXPECT_THAT(rows(file("ab.db"), "SELECT hash FROM points"), ElementsAre("h1", "h2", "h3"));
  EXPECT_THAT(rows(file("ab.db"), "SELECT name FROM pragma_table_info('points') WHERE cid > 4"),
              ElementsAre("banks.bank.reads", "banks.bank1.reads", "banks.bank2.reads", "banks.bank10.reads",
                          "banks.bank12.reads", "cycles", "image.width", "matcher.window", "rate"));
  EXPECT_THAT(rows(file("ab.db"), "SELECT hash, cycles FROM blame"), ElementsAre("h1|3", "h2|3", "h3|3"));
  merge_stores({file("ab.db")}, file("again.db"));
  EXPECT_EQ(read_file(file("again.db")), read_file(file("ab.db")));
}

TEST_F(StoreTest, IsContinuedAfterItWasMerged) {
  { Store(file("a.db"), kVersion).add(point("h1")); }
  merge_stores({file("a.db")}, file("a.db"));
  Store store(file("a.db"), kVersion);
  EXPECT_FALSE(store.add(point("h1")));
  EXPECT_TRUE(store.add(point("h0")));
  EXPECT_THAT(hashes(file("a.db")), ElementsAre("h0", "h1"));
}

TEST_F(StoreTest, DoesNotMergeDifferentResultsOfAPoint) {
  { Store(file("a.db"), kVersion).add(point("h1", 7)); }
  { Store(file("b.db"), kVersion).add(point("h1", 8)); }
  EXPECT_EQ(message_of([&] {
              merge_stores({file("a.db"), file("b.db")}, file("c.db"));
            }),
            file("b.db") + ": holds another result of point h1 than " + file("a.db"));
  EXPECT_FALSE(std::filesystem::exists(file("c.db")));
  EXPECT_THAT(names(), Not(Contains(HasSubstr("c.db"))));
  { Store(file("d.db"), kVersion).add(point("h1", 7)); }
  StoredPoint blamed = point("h1", 7);
  blamed.blame.front().cycles = 4;
  { Store(file("e.db"), kVersion).add(blamed); }
  EXPECT_THAT(message_of([&] {
                merge_stores({file("d.db"), file("e.db")}, file("c.db"));
              }),
              HasSubstr("another result of point h1"));
}

TEST_F(StoreTest, DoesNotMergePointsOfDifferentVersions) {
  { Store(file("a.db"), kVersion).add(point("h1")); }
  for (const char* const hash : {"h0", "h1", "h2"}) {
    const std::string other = file(std::string(hash) + ".db");
    { Store(other, "1.2.4").add(point(hash)); }
    const std::string text = message_of([&] { merge_stores({file("a.db"), other}, file("c.db")); });
    EXPECT_THAT(text, HasSubstr(": they do not mix")) << hash;
    EXPECT_THAT(text, HasSubstr(other));
    EXPECT_THAT(text, HasSubstr("version 1.2.4"));
    EXPECT_FALSE(std::filesystem::exists(file("c.db")));
  }
  EXPECT_EQ(message_of([&] {
              merge_stores({file("a.db"), file("h2.db")}, file("c.db"));
            }),
            file("h2.db") + ": holds points of version 1.2.4, and " + file("a.db") +
                " of version 1.2.3: they do not mix");
}

TEST_F(StoreTest, HasNoColumnsThatDifferOnlyInCase) {
  StoredPoint small = point("h1");
  small.keys = {{"ssram.banks.a.words", std::int64_t{1}}};
  StoredPoint large = point("h2");
  large.keys = {{"ssram.banks.A.words", std::int64_t{1}}};
  Store(file("a.db"), kVersion).add(small);
  Store(file("b.db"), kVersion).add(large);
  const Store store(file("a.db"), kVersion);
  store.check_banks({"a", "b"});
  EXPECT_EQ(message_of([&] {
              store.check_banks({"b", "A"});
            }),
            file("a.db") +
                ": its column ssram.banks.a.words differs from ssram.banks.A.words only in case: give "
                "another file");
  EXPECT_EQ(message_of([&] {
              merge_stores({file("a.db"), file("b.db")}, file("c.db"));
            }),
            file("b.db") + ": its column ssram.banks.A.words differs from ssram.banks.a.words of " +
                file("a.db") + " only in case: they do not mix");
}

// A process that has added a point ends at once: the point is in the journal alone. Whatever ends the merge,
// its journal may be gone then.
TEST_F(StoreTest, BringsItsJournalIntoTheFileBeforeItIsReplaced) {
  { Store(file("a.db"), kVersion).add(point("h1")); }
  const pid_t child = fork();
  if (child == 0) {
    auto* const store = new Store(file("a.db"), kVersion);
    store->add(point("h2"));
    _exit(0);
  }
  waitpid(child, nullptr, 0);
  ASSERT_GT(std::filesystem::file_size(file("a.db-wal")), 0U);
  EXPECT_THAT(message_of([&] {
                merge_stores({file("a.db"), file("none.db")}, file("a.db"));
              }),
              HasSubstr("none.db: "));
  for (const char* const ending : {"-wal", "-shm"}) std::filesystem::remove(file("a.db") + ending);
  EXPECT_THAT(rows(file("a.db"), "SELECT hash FROM points ORDER BY hash"), ElementsAre("h1", "h2"));
}

TEST_F(StoreTest, DoesNotReplaceWhatIsNoStore) {
  { Store(file("a.db"), kVersion).add(point("h1")); }
  test::write_file(file("notes.txt"), "notes");
  EXPECT_THAT(message_of([&] { merge_stores({file("a.db")}, file("notes.txt")); }),
              HasSubstr("notes.txt: not a database"));
  EXPECT_EQ(read_file(file("notes.txt")), "notes");
}

TEST_F(StoreTest, LeavesFilesOfOthersBesideIt) {
  { Store(file("a.db"), kVersion).add(point("h1")); }
  const std::vector<std::string> others = {"a.db.new",
                                           "a.db.merging-mine",
                                           "a.db.merging-0123456789abcdeX",
                                           "a.db.merging-0123456789abcde",
                                           "a.db.merging-0123456789abcdef0",
                                           "b.db.merging-0123456789abcdef"};
  for (const std::string& other : others) test::write_file(file(other), "mine");
  merge_stores({file("a.db")}, file("a.db"));
  for (const std::string& other : others) EXPECT_EQ(read_file(file(other)), "mine") << other;
  EXPECT_EQ(names().size(), others.size() + 1);
}

TEST_F(StoreTest, RemovesWhatAMergeThatWasKilledHasLeft) {
  { Store(file("a.db"), kVersion).add(point("h1")); }
  test::write_file(file("a.db.merging-0123456789abcdef"), "half");
  merge_stores({file("a.db")}, file("a.db"));
  EXPECT_THAT(names(), ElementsAre("a.db"));
}

TEST_F(StoreTest, BehindALinkIsMergedInItsPlaceWithItsModeAndOwner) {
  namespace fs = std::filesystem;
  constexpr uid_t kOther = 4711;
  fs::create_directory(file("real"));
  fs::create_symlink("real/b.db", file("b.db"));
  { Store(file("a.db"), kVersion).add(point("h1")); }
  { Store(file("b.db"), kVersion).add(point("h2")); }
  ASSERT_EQ(chmod(file("real/b.db").c_str(), 0640), 0);
  const bool is_given_away = chown(file("real/b.db").c_str(), kOther, kOther) == 0;  // only root can
  merge_stores({file("a.db"), file("b.db")}, file("b.db"));
  EXPECT_TRUE(fs::is_symlink(file("b.db")));
  EXPECT_THAT(hashes(file("real/b.db")), ElementsAre("h1", "h2"));
  struct stat now = {};
  ASSERT_EQ(stat(file("real/b.db").c_str(), &now), 0);
  EXPECT_EQ(now.st_mode & 07777U, 0640U);
  EXPECT_EQ(now.st_uid, is_given_away ? kOther : geteuid());
  EXPECT_EQ(std::distance(fs::directory_iterator(file("real")), {}), 1) << "without its journal";
}

TEST_F(StoreTest, IsAFileOfAnyName) {
  std::filesystem::current_path(std::filesystem::path(file("x")).parent_path());
  std::size_t files = 0;
  for (const std::string name : {":memory:", "file:a.db", "file::memory:", "file:b.db?mode=memory", " "}) {
    { Store(name, kVersion).add(point("h1")); }
    EXPECT_THAT(hashes(file(name)), ElementsAre("h1")) << name;
    merge_stores({name}, name);
    EXPECT_TRUE(FinishedStore(name, kVersion).has("h1"));
    EXPECT_THAT(names(), Contains(name));
    EXPECT_EQ(names().size(), ++files) << "nothing else is made";
  }
  EXPECT_THROW(Store("", kVersion), DatabaseError);
}

TEST_F(StoreTest, MergesIntoAnEmptyFile) {
  { Store(file("a.db"), kVersion).add(point("h1")); }
  test::write_file(file("b.db"), "");
  merge_stores({file("a.db")}, file("b.db"));
  EXPECT_THAT(rows(file("b.db"), "SELECT hash FROM points"), ElementsAre("h1"));
}

TEST_F(StoreTest, MergesOnlyWhatIsThere) {
  EXPECT_THAT(message_of([&] { merge_stores({file("none.db")}, file("c.db")); }), HasSubstr("none.db: "));
  EXPECT_FALSE(std::filesystem::exists(file("none.db")));
}

}  // namespace
}  // namespace stereotlm::explore
