#include "sw/explore/store/store_layout.h"

#include <fmt/format.h>

#include <cstdint>

namespace stereotlm::explore {
namespace {

constexpr int kApplicationId = 0x53544C4D;  // "STLM"
constexpr int kLayout = 2;

}  // namespace

void create_tables(sqlite::Database& database, const std::vector<std::string>& further_columns,
                   const std::string& schema) {
  database.execute(fmt::format("PRAGMA {0}.application_id = {1}; PRAGMA {0}.user_version = {2}", schema,
                               kApplicationId, kLayout));
  create_points(database, further_columns, schema);
  database.execute(fmt::format(
      "CREATE TABLE {}.blame(hash TEXT NOT NULL, port TEXT NOT NULL, bank TEXT NOT NULL, by TEXT NOT NULL, "
      "cycles INTEGER NOT NULL, PRIMARY KEY(hash, port, bank, by)) WITHOUT ROWID",
      schema));
  database.execute(fmt::format("CREATE TABLE {}.keys(name TEXT PRIMARY KEY NOT NULL) WITHOUT ROWID", schema));
}

void create_points(sqlite::Database& database, const std::vector<std::string>& further_columns,
                   const std::string& schema) {
  std::string columns =
      "hash TEXT PRIMARY KEY NOT NULL, status TEXT NOT NULL, reason TEXT NOT NULL, "
      "version TEXT NOT NULL, config TEXT NOT NULL";
  for (const std::string& name : further_columns) columns += ", " + sqlite::quoted_name(name);
  database.execute(fmt::format("CREATE TABLE {}.points({})", schema, columns));
}

files::FileKind store_kind() {
  using namespace std::string_literals;
  return files::marked_kind("database of stereotlm sweep", {{0, "SQLite format 3\0"s}, {68, "STLM"}});
}

void check_layout(sqlite::Database& database) {
  if (database.number("PRAGMA application_id") != kApplicationId) {
    throw sqlite::DatabaseError(database.path() + ": not a database of stereotlm sweep");
  }
  const std::int64_t layout = database.number("PRAGMA user_version");
  if (layout != kLayout) {
    throw sqlite::DatabaseError(
        fmt::format("{}: its layout is {}, of another version; this version writes {}", database.path(),
                    layout, kLayout));
  }
}

void check_version(sqlite::Database& database, const std::string& version) {
  sqlite::Statement other(database, "SELECT version FROM points WHERE version <> ? LIMIT 1");
  other.bind(1, version);
  if (!other.step()) return;
  throw sqlite::DatabaseError(
      fmt::format("{}: holds points of version {}; this is version {}: give another file", database.path(),
                  other.text(0), version));
}

std::vector<std::string> first_column_of(const sqlite::Database& database, const std::string& sql) {
  std::vector<std::string> names;
  sqlite::Statement statement(database, sql);
  while (statement.step()) names.push_back(statement.text(0));
  return names;
}

std::vector<std::string> columns_of(const sqlite::Database& database) {
  return first_column_of(database, "SELECT name FROM pragma_table_info('points') ORDER BY cid");
}

void insert_board_key(const sqlite::Database& database, const std::string& name) {
  sqlite::Statement insert(database, "INSERT INTO keys(name) VALUES(?)");
  insert.bind(1, name);
  insert.run();
}

}  // namespace stereotlm::explore
