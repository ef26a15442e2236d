#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <map>
#include <set>
#include <stdexcept>
#include <system_error>

#include "sw/explore/store/store.h"
#include "sw/explore/store/store_layout.h"
#include "sw/explore/store/store_lock.h"
#include "sw/files/output_file.h"

namespace stereotlm::explore {
namespace {

namespace fs = std::filesystem;

struct IsLessWithoutCase {
  bool operator()(const std::string& a, const std::string& b) const {
    return sqlite3_stricmp(a.c_str(), b.c_str()) < 0;
  }
};

// The columns and keys of all inputs.
class Inputs {
 public:
  // Throws if a file is no store, if the points have different versions, or if two columns differ only in
  // case.
  explicit Inputs(const std::vector<std::string>& paths) : paths_(paths) {
    for (const std::string& path : paths) {
      sqlite::Database input(path, sqlite::Database::Access::kRead);
      check_layout(input);
      add_columns(input);
      for (const std::string& key : first_column_of(input, "SELECT name FROM keys")) keys_.insert(key);
      if (paths.size() > 1) check_version_of(input);  // Store refuses a second version
    }
  }

  // The columns without kFirstColumns. Numbers inside names compare as numbers: bank2 comes before bank10.
  std::vector<std::string> further_columns() const {
    std::vector<std::string> columns;
    for (const auto& [name, path] : columns_) {
      if (std::find(kFirstColumns.begin(), kFirstColumns.end(), name) == kFirstColumns.end())
        columns.push_back(name);
    }
    std::sort(columns.begin(), columns.end(), [](const std::string& a, const std::string& b) {
      return strverscmp(a.c_str(), b.c_str()) < 0;
    });
    return columns;
  }
  const std::set<std::string>& keys() const { return keys_; }

  // The first input that has the point.
  const std::string& first_with(const std::string& hash) const {
    return *std::find_if(paths_.begin(), paths_.end(),
                         [&hash](const std::string& path) { return StoredRow(path).find(hash); });
  }

 private:
  void add_columns(const sqlite::Database& input) {
    for (const std::string& column : columns_of(input)) {
      const auto& [name, first] = *columns_.emplace(column, input.path()).first;
      if (name == column) continue;
      throw sqlite::DatabaseError(
          fmt::format("{}: its column {} differs from {} of {} only in case: they do not mix", input.path(),
                      column, name, first));
    }
  }

  void check_version_of(const sqlite::Database& input) {
    for (const std::string& version : first_column_of(input, "SELECT DISTINCT version FROM points")) {
      if (version_.empty()) {
        version_ = version;
        path_of_version_ = input.path();
      }
      if (version == version_) continue;
      throw sqlite::DatabaseError(
          fmt::format("{}: holds points of version {}, and {} of version {}: they do not mix", input.path(),
                      version, path_of_version_, version_));
    }
  }

  const std::vector<std::string>& paths_;
  std::map<std::string, std::string, IsLessWithoutCase> columns_;  // [name]: the first input that has it
  std::set<std::string> keys_;
  std::string version_;
  std::string path_of_version_;
};

// The columns as a list of SQL, each with this in front of it.
std::string listed(const std::vector<std::string>& columns, const std::string& table = "") {
  std::string names;
  for (const std::string& column : columns)
    names += (names.empty() ? "" : ", ") + table + sqlite::quoted_name(column);
  return names;
}

// The hash of a point of which the attached stores `input` and `gathered` hold different results; empty if
// there is none. A column that `input` lacks is NULL. `columns`: of `gathered`.
std::string different_point(const sqlite::Database& database, const std::vector<std::string>& columns) {
  const std::vector<std::string> own =
      first_column_of(database, "SELECT name FROM pragma_table_info('points', 'input')");
  std::string values;
  for (const std::string& column : columns) {
    const bool is_there = std::find(own.begin(), own.end(), column) != own.end();
    values += (values.empty() ? "" : ", ") + (is_there ? "i." + sqlite::quoted_name(column) : "NULL");
  }
  const char* blame =
      "SELECT hash FROM (SELECT {0} FROM {1}.blame WHERE hash IN (SELECT hash FROM {2}.points)"
      " EXCEPT SELECT {0} FROM {2}.blame)";
  const std::vector<std::string> hashes = first_column_of(
      database,
      fmt::format("SELECT i.hash FROM input.points AS i JOIN gathered.points AS g ON g.hash = i.hash "
                  "WHERE ({}) IS NOT ({}) UNION ALL {} UNION ALL {} LIMIT 1",
                  values, listed(columns, "g."), fmt::format(blame, kBlameColumns, "input", "gathered"),
                  fmt::format(blame, kBlameColumns, "gathered", "input")));
  return hashes.empty() ? "" : hashes.front();
}

// Puts the points of all inputs into the attached store `gathered`, which is empty. Throws if two inputs hold
// different results of the same point. `columns`: of `gathered`.
void gather(const std::vector<std::string>& paths, const Inputs& inputs, sqlite::Database& database,
            const std::vector<std::string>& columns) {
  for (const std::string& path : paths) {
    database.attach(path, "input");
    database.execute("BEGIN");
    if (const std::string hash = different_point(database, columns); !hash.empty()) {
      throw sqlite::DatabaseError(
          fmt::format("{}: holds another result of point {} than {}", path, hash, inputs.first_with(hash)));
    }
    const std::string names =
        listed(first_column_of(database, "SELECT name FROM pragma_table_info('points', 'input')"));
    database.execute(
        fmt::format("INSERT OR IGNORE INTO gathered.points({0}) SELECT {0} FROM input.points", names));
    database.execute(
        fmt::format("INSERT OR IGNORE INTO gathered.blame({0}) SELECT {0} FROM input.blame", kBlameColumns));
    database.execute("COMMIT");
    database.execute("DETACH input");
  }
}

// Copies the points of an attached store, so that the bytes depend only on the points.
void copy(sqlite::Database& database, const std::string& from, const std::vector<std::string>& columns) {
  database.execute(fmt::format("INSERT INTO main.points({0}) SELECT {0} FROM {1}.points ORDER BY hash",
                               listed(columns), from));
  database.execute(
      fmt::format("INSERT INTO main.blame({0}) SELECT {0} FROM {1}.blame ORDER BY hash, port, bank, by",
                  kBlameColumns, from));
}

// Moves the contents of the journal of a store into its file, so that the journal can be removed.
void empty_journal(const std::string& path) {
  sqlite::Database database(path, sqlite::Database::Access::kWrite);
  check_layout(database);
  sqlite::Statement checkpoint(database, "PRAGMA wal_checkpoint(TRUNCATE)");
  if (checkpoint.step() && checkpoint.integer(0) != 0) database.fail(SQLITE_BUSY);
}

}  // namespace

void merge_stores(const std::vector<std::string>& inputs, const std::string& store,
                  bool (*is_interrupted)()) try {
  const std::string out = behind_links(store);
  std::error_code none;
  if (fs::file_size(out, none) > 0 && !none) empty_journal(out);
  const Inputs all(inputs);
  const std::vector<std::string> further = all.further_columns();
  std::vector<std::string> columns(kFirstColumns.begin(), kFirstColumns.end());
  columns.insert(columns.end(), further.begin(), further.end());
  files::OutputFile file(out, store_kind());
  {
    sqlite::Database database(file.aside().path().string(), sqlite::Database::Access::kWrite,
                              sqlite::Database::kBusyTimeout, out);
    if (is_interrupted != nullptr) database.interrupt_if(is_interrupted);
    database.execute(
        "PRAGMA journal_mode = OFF; PRAGMA synchronous = NORMAL; PRAGMA main.locking_mode = EXCLUSIVE");
    const bool is_single = inputs.size() == 1;
    if (is_single) {
      database.attach(inputs.front(), "input");
      database.execute("PRAGMA input.mmap_size = 0x40000000");  // pages are read without a system call
    } else {
      database.execute("ATTACH '' AS gathered");  // SQLite removes the file of this database itself
      database.execute("PRAGMA gathered.journal_mode = OFF; PRAGMA gathered.synchronous = OFF");
      create_tables(database, further, "gathered");
      gather(inputs, all, database, columns);
    }
    database.execute("BEGIN");
    create_tables(database, further);
    for (const std::string& key : all.keys()) insert_board_key(database, key);
    copy(database, is_single ? "input" : "gathered", columns);
    database.execute("COMMIT");
  }
  file.complete();
  for (const char* ending : {"-wal", "-shm"}) fs::remove(out + ending, none);
  file.commit();
} catch (const sqlite::DatabaseError&) {
  throw;
} catch (const std::runtime_error& error) {  // of the file
  throw sqlite::DatabaseError(error.what());
}

}  // namespace stereotlm::explore
