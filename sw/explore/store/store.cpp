#include "sw/explore/store/store.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "platform/config/board_keys.h"
#include "sw/explore/store/store_layout.h"

namespace stereotlm::explore {
namespace {

using Json = nlohmann::ordered_json;

bool is_list_of_named(const Json& value) {
  return value.is_array() && !value.empty() && value.front().is_object() && value.front().contains("name");
}

void append(const std::string& path, const Json& value, std::vector<platform::BoardValue>& values) {
  if (value.is_object()) {
    for (const auto& [key, child] : value.items()) {
      if (key != "name") append(platform::below(path, key), child, values);
    }
  } else if (is_list_of_named(value)) {
    for (const Json& item : value) append(platform::below(path, item["name"]), item, values);
  } else if (value.is_number_integer()) {
    values.push_back({path, value.get<std::int64_t>()});
  } else if (value.is_number()) {
    values.push_back({path, value.get<double>()});
  } else {
    values.push_back({path, value.is_string() ? value.get<std::string>() : value.dump()});
  }
}

// Waits until no other process writes. SQLite itself does not wait before it changes the kind of its journal.
void wait_for_writers(sqlite::Database& database) { database.execute("BEGIN IMMEDIATE; COMMIT"); }

std::string journal_of(const sqlite::Database& database) {
  sqlite::Statement statement(database, "PRAGMA journal_mode");
  return statement.step() ? statement.text(0) : "";
}

// The values of a point, except those of kFirstColumns.
std::vector<const platform::BoardValue*> further_values(const StoredPoint& point) {
  std::vector<const platform::BoardValue*> values;
  for (const auto* part : {&point.keys, &point.figures.values}) {
    for (const platform::BoardValue& value : *part) values.push_back(&value);
  }
  return values;
}

// SQL that inserts a point with these columns, unless the table has the point.
std::string insert_point_sql(const std::vector<std::string>& columns) {
  std::string names;
  std::string places;
  for (const std::string& name : columns) {
    names += (names.empty() ? "" : ", ") + sqlite::quoted_name(name);
    places += places.empty() ? "?" : ", ?";
  }
  return fmt::format("INSERT OR IGNORE INTO points({}) VALUES({})", names, places);
}

}  // namespace

Figures figures_of(const Json& document) {
  Figures figures;
  for (const auto& [key, value] : document.items()) {
    if (key == "schema") continue;
    if (key == "blame") {
      for (const Json& row : value) {
        figures.blame.push_back({row["port"], row["bank"], row["by"], row["cycles"].get<std::int64_t>()});
      }
    } else {
      append(key, value, figures.values);
    }
  }
  return figures;
}

std::string without_case(std::string name) {
  for (char& c : name) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return name;
}

bool differ_in_case(const std::string& a, const std::string& b) {
  return a != b && without_case(a) == without_case(b);
}

std::optional<std::string> bank_names_problem(const platform::BoardConfig& board) {
  for (const platform::BankConfig& one : board.banks) {
    for (const platform::BankConfig& other : board.banks) {
      if (differ_in_case(one.name, other.name)) return bank_names_problem(one.name, other.name);
    }
  }
  return std::nullopt;
}

std::string bank_names_problem(const std::string& one, const std::string& other) {
  return fmt::format(
      "ssram.banks = {}, {}: the names differ only in case: a database could not distinguish their columns",
      one, other);
}

Store::Store(const std::string& path, const std::string& version, std::chrono::milliseconds busy_timeout)
    : database_(path, sqlite::Database::Access::kCreate, busy_timeout), version_(version) {
  create();
  check_version(database_, version);
  read_columns();
  find_ = std::make_unique<sqlite::Statement>(database_, "SELECT 1 FROM points WHERE hash = ?");
  insert_blame_ = std::make_unique<sqlite::Statement>(
      database_, fmt::format("INSERT INTO blame({}) VALUES(?, ?, ?, ?, ?)", kBlameColumns));
}

// The first process to open the file creates the tables.
void Store::create() {
  if (database_.number("SELECT count(*) FROM sqlite_schema") == 0) {
    database_.execute("PRAGMA synchronous = OFF");  // an empty store has nothing that could be lost
    // Small pages: a point changes some pages, and each changed page is written to the journal as a whole.
    // Not smaller: a row that does not fit into its page makes every column that the merge reads slow.
    database_.execute("PRAGMA page_size = 2048");
    wait_for_writers(database_);
    // With this journal readers do not wait for a writer, and nothing is lost when a process ends, whatever
    // ends it.
    database_.execute("PRAGMA journal_mode = WAL");
    database_.execute("BEGIN IMMEDIATE");
    if (database_.number("SELECT count(*) FROM sqlite_schema") == 0) create_tables(database_, {});
    database_.execute("COMMIT");
  }
  check_layout(database_);
  if (journal_of(database_) != "wal") wait_for_writers(database_);
  database_.execute(
      "PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL; PRAGMA wal_autocheckpoint = 16384");
}

void Store::read_columns() {
  const std::vector<std::string> names = columns_of(database_);
  columns_ = {names.begin(), names.end()};
}

void Store::check_banks(const std::vector<std::string>& banks) const {
  for (const std::string& bank : banks) {
    const std::string words = fmt::format("ssram.banks.{}.words", bank);
    for (const std::string& column : columns_) {
      if (!differ_in_case(column, words)) continue;
      throw sqlite::DatabaseError(
          fmt::format("{}: its column {} differs from {} only in case: give another file", database_.path(),
                      column, words));
    }
  }
}

bool Store::has(const std::string& hash) {
  find_->bind(1, hash);
  const bool is_there = find_->step();
  find_->reset();
  return is_there;
}

bool Store::add(const StoredPoint& point) {
  const std::vector<const platform::BoardValue*> values = further_values(point);
  database_.execute("BEGIN IMMEDIATE");
  try {
    sqlite::Statement& insert = insertion(point, values);
    int place = 0;
    for (const std::string& text : {point.hash, point.status, point.reason, version_, point.config})
      insert.bind(++place, text);
    for (const platform::BoardValue* value : values) insert.bind(++place, value->value);
    insert.run();
    const bool is_new = sqlite3_changes(database_.handle()) > 0;
    for (const StoredBlame& row : point.figures.blame) {
      if (!is_new) break;
      place = 0;
      for (const std::string& text : {point.hash, row.port, row.bank, row.by})
        insert_blame_->bind(++place, text);
      insert_blame_->bind(++place, row.cycles);
      insert_blame_->run();
    }
    database_.execute("COMMIT");
    return is_new;
  } catch (const sqlite::DatabaseError&) {
    // Fails, without consequence, if SQLite has rolled the change back already.
    sqlite3_exec(database_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
    insertions_.clear();  // the columns that they need may have been rolled back
    throw;
  }
}

sqlite::Statement& Store::insertion(const StoredPoint& point,
                                    const std::vector<const platform::BoardValue*>& values) {
  const auto known =
      std::find_if(insertions_.begin(), insertions_.end(), [&values](const Insertion& insertion) {
        return std::equal(
            values.begin(), values.end(), insertion.paths.begin(), insertion.paths.end(),
            [](const platform::BoardValue* value, const std::string& path) { return value->path == path; });
      });
  if (known != insertions_.end()) return *known->statement;
  add_columns(point);
  Insertion made;
  for (const platform::BoardValue* value : values) made.paths.push_back(value->path);
  std::vector<std::string> columns(kFirstColumns.begin(), kFirstColumns.end());
  columns.insert(columns.end(), made.paths.begin(), made.paths.end());
  made.statement = std::make_unique<sqlite::Statement>(database_, insert_point_sql(columns));
  insertions_.push_back(std::move(made));
  return *insertions_.back().statement;
}

void Store::add_columns(const StoredPoint& point) {
  read_columns();  // another process may have added some
  std::vector<std::string> missing;
  for (const auto* values : {&point.keys, &point.figures.values}) {
    for (const platform::BoardValue& value : *values) {
      if (!columns_.insert(value.path).second) continue;
      missing.push_back(value.path);
      if (values == &point.keys) insert_board_key(database_, value.path);
    }
  }
  if (missing.empty()) return;
  // SQLite reads the whole schema again for each column that is added. A table without points is made anew
  // instead, with all columns at once.
  if (database_.number("SELECT EXISTS(SELECT 1 FROM points)") == 0) {
    std::vector<std::string> columns(columns_.begin(), columns_.end());
    const auto is_first = [](const std::string& column) {
      return std::find(kFirstColumns.begin(), kFirstColumns.end(), column) != kFirstColumns.end();
    };
    columns.erase(std::remove_if(columns.begin(), columns.end(), is_first), columns.end());
    database_.execute("DROP TABLE points");
    create_points(database_, columns);
    return;
  }
  for (const std::string& column : missing)
    database_.execute("ALTER TABLE points ADD COLUMN " + sqlite::quoted_name(column));
}

StoredRow::StoredRow(const std::string& path, const std::string& version)
    : database_(path, sqlite::Database::Access::kRead) {
  check_layout(database_);
  if (!version.empty()) check_version(database_, version);
  find_.emplace(database_, "SELECT * FROM points WHERE hash = ?");
  for (int column = 0; column < find_->columns(); ++column) columns_[find_->name(column)] = column;
}

bool StoredRow::find(const std::string& hash) {
  find_->reset();
  find_->bind(1, hash);
  return find_->step();
}

std::string StoredRow::text(const std::string& column) const {
  const auto found = columns_.find(column);
  return found == columns_.end() ? "" : find_->text(found->second);
}

std::int64_t StoredRow::integer(const std::string& column) const {
  const auto found = columns_.find(column);
  return found == columns_.end() ? 0 : find_->integer(found->second);
}

double StoredRow::real(const std::string& column) const {
  const auto found = columns_.find(column);
  return found == columns_.end() ? 0 : find_->real(found->second);
}

}  // namespace stereotlm::explore
