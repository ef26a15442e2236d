#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "sw/sqlite/database.h"
#include "tests/support/made_trace.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::trace {
namespace {

using sqlite::Database;

class SqliteSinkTest : public ::testing::Test {
 protected:
  void write(const test::MadeTrace& trace) {
    const auto sink = sqlite_sink(path_, board_);
    trace.send(*sink);
    test::finish(*sink);
  }
  std::int64_t number(const std::string& sql) const {
    return Database(path_, Database::Access::kRead).number(sql);
  }

  test::ScratchFolder scratch_;
  std::filesystem::path path_ = scratch_.path() / "file.db";
  platform::BoardConfig board_ = test::made_board();
};

// The queries of the guide: its blocks of SQL.
std::vector<std::string> queries_of_guide() {
  const std::string guide = test::read_file(STEREOTLM_TRACE_GUIDE);
  const std::string begin = "\n```sql\n";
  std::vector<std::string> queries;
  for (std::size_t place = guide.find(begin); place != std::string::npos; place = guide.find(begin, place)) {
    place += begin.size();
    queries.push_back(guide.substr(place, guide.find("\n```\n", place) - place));
  }
  return queries;
}

TEST_F(SqliteSinkTest, EachQueryOfTheGuideGivesRows) {
  write(test::make_trace(board_, 2));
  const Database database(path_, Database::Access::kRead);
  const std::vector<std::string> queries = queries_of_guide();
  EXPECT_EQ(queries.size(), 5);
  for (const std::string& query : queries) {
    sqlite::Statement statement(database, query);
    EXPECT_TRUE(statement.step()) << query;
  }
}

// With 5 rows in strips of 2 the last strip has one row: a count of its own, because `count / rows` is the
// mean of a row.
TEST_F(SqliteSinkTest, ALastStripWithFewerRowsIsARunOfItsOwn) {
  board_.matcher.rows = 2;
  platform::FrameRuns frame;
  for (std::size_t strip = 0; strip <= 3; ++strip) {
    frame.strip_ends.push_back(100 * (strip + 1));
    frame.runs.push_back({strip, 100 * strip, 100 * (strip + 1), 0, 0, std::nullopt, 10});
  }
  test::MadeTrace trace;
  trace.frames = {frame};
  for (const auto& [height, runs] : {std::pair(5, "0+4: 20, 4+1: 10"), std::pair(6, "0+6: 30")}) {
    board_.image.height = height;
    write(trace);
    const Database database(path_, Database::Access::kRead);
    sqlite::Statement found(database,
                            "SELECT group_concat(row || '+' || rows || ': ' || count, ', ') FROM runs "
                            "WHERE row IS NOT NULL");
    ASSERT_TRUE(found.step());
    EXPECT_EQ(found.text(0), runs);
  }
}

TEST_F(SqliteSinkTest, TheFileIsSoundAndItsSchemaHasAComment) {
  write(test::make_trace(board_, 1));
  const Database database(path_, Database::Access::kRead);
  sqlite::Statement check(database, "PRAGMA integrity_check");
  ASSERT_TRUE(check.step());
  EXPECT_EQ(check.text(0), "ok");
  EXPECT_EQ(number("SELECT count(*) FROM sqlite_schema WHERE sql LIKE '%-- %'"), 6);
}

}  // namespace
}  // namespace stereotlm::trace
