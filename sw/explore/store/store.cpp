#include "sw/explore/store/store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>

#include "platform/config/board_keys.h"
#include "sw/files/output_file.h"
#include "sw/files/whole_file.h"
#include "sw/stats/figures.h"

namespace stereotlm::explore {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Names = std::vector<std::string>;

constexpr int kApplicationId = 0x53544C4D;  // "STLM"
constexpr int kLayout = 3;

// The first columns of `points`, which every store has, and what they mean.
constexpr std::array<std::pair<const char*, const char*>, 5> kFirstColumns = {
    {{"hash", "SHA-256 of board and run"},
     {"status", "ok, impossible (there is no such board) or failed (the run ended with an error)"},
     {"reason", "for the status, unless it is ok"},
     {"version", "of the program"},
     {"config", "the board in full, as it was asked for"}}};
constexpr const char* kBlameColumns = "hash, port, bank, by, cycles";
constexpr const char* kSizeOfSchema = "SELECT count(*) FROM sqlite_schema";

// The columns as a list of SQL, each with this in front of it.
std::string listed(const Names& columns, const std::string& table = "") {
  std::string names;
  for (const std::string& column : columns)
    names += (names.empty() ? "" : ", ") + table + sqlite::quoted_name(column);
  return names;
}

bool is_first(const std::string& column) {
  return std::any_of(kFirstColumns.begin(), kFirstColumns.end(),
                     [&column](const auto& first) { return first.first == column; });
}

// The columns in the order of a finished store. Numbers inside names compare as numbers: bank2 comes before
// bank10.
Names in_order(Names columns) {
  std::sort(columns.begin(), columns.end(),
            [](const std::string& a, const std::string& b) { return strverscmp(a.c_str(), b.c_str()) < 0; });
  std::stable_partition(columns.begin(), columns.end(), is_first);
  return columns;
}

// Creates table `points` in an empty database: with kFirstColumns, then the others of these columns.
// `schema`: the name under which the database is attached.
void create_points(sqlite::Database& database, const Names& columns, const std::string& schema = "main") {
  std::string text =
      "hash TEXT PRIMARY KEY NOT NULL, status TEXT NOT NULL, reason TEXT NOT NULL, "
      "version TEXT NOT NULL, config TEXT NOT NULL";
  for (const std::string& column : columns) {
    if (!is_first(column)) text += ", " + sqlite::quoted_name(column);
  }
  database.execute(fmt::format("CREATE TABLE {}.points({})", schema, text));
}

void create_tables(sqlite::Database& database, const Names& columns, const std::string& schema = "main") {
  create_points(database, columns, schema);
  database.execute(fmt::format(
      "PRAGMA {0}.application_id = {1}; PRAGMA {0}.user_version = {2};"
      "CREATE TABLE {0}.blame(hash TEXT NOT NULL, port TEXT NOT NULL, bank TEXT NOT NULL, by TEXT NOT NULL, "
      "cycles INTEGER NOT NULL, PRIMARY KEY(hash, port, bank, by)) WITHOUT ROWID;"
      "CREATE TABLE {0}.columns(name TEXT PRIMARY KEY NOT NULL, unit TEXT NOT NULL, meaning TEXT NOT NULL, "
      "is_key INTEGER NOT NULL, varied INTEGER) WITHOUT ROWID",
      schema, kApplicationId, kLayout));
}

struct IsLessWithoutCase {
  bool operator()(const std::string& a, const std::string& b) const {
    return sqlite3_stricmp(a.c_str(), b.c_str()) < 0;
  }
};

// Makes the view `plain`: `points` with names that need no quotes. Each character that is no letter, digit or
// underscore is an underscore. A name that is there already ends in _2, _3, ..
void create_view(sqlite::Database& database, const Names& columns) {
  std::set<std::string, IsLessWithoutCase> names;
  std::string list;
  for (const std::string& column : in_order(columns)) {
    std::string plain = column;
    for (char& c : plain) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
    std::string name = plain;
    for (int number = 2; !names.insert(name).second; ++number) name = fmt::format("{}_{}", plain, number);
    list += fmt::format("{}{} AS {}", list.empty() ? "" : ", ", sqlite::quoted_name(column),
                        sqlite::quoted_name(name));
  }
  database.execute(
      fmt::format("DROP VIEW IF EXISTS main.plain; CREATE VIEW main.plain AS SELECT {} FROM points", list));
}

// Throws if the store holds points of another version of the program.
void check_version(sqlite::Database& database, const std::string& version) {
  sqlite::Statement other(database, "SELECT version FROM points WHERE version <> ? LIMIT 1");
  other.bind(1, version);
  if (!other.step()) return;
  throw sqlite::DatabaseError(
      fmt::format("{}: holds points of version {}; this is version {}: give another file", database.path(),
                  other.text(0), version));
}

// Notes what a column of `points` is. `varied`: whether points differ in it; nullopt: not known yet.
void insert_column(const sqlite::Database& database, const std::string& name, bool is_key,
                   std::optional<bool> varied = std::nullopt) {
  std::string unit;
  std::string meaning = is_key ? run_key_meaning(name) : "";
  for (const auto& [first, its_meaning] : kFirstColumns) {
    if (name == first) meaning = its_meaning;
  }
  const platform::Key* const key = is_key ? platform::find_key(platform::schema_path(name)) : nullptr;
  const stats::Figure* const figure = is_key ? nullptr : stats::find_figure(name);
  if (key != nullptr) std::tie(unit, meaning) = std::tie(key->unit, key->meaning);
  if (figure != nullptr) std::tie(unit, meaning) = std::tie(figure->unit, figure->meaning);
  sqlite::Statement insert(database, "INSERT INTO columns VALUES(?, ?, ?, ?, ?)");
  int place = 0;
  for (const std::string& text : {name, unit, meaning}) insert.bind(++place, text);
  insert.bind(++place, std::int64_t{is_key ? 1 : 0});
  if (varied) insert.bind(++place, std::int64_t{*varied ? 1 : 0});
  insert.run();
}

// The columns in which points differ. Figures are compared among the points that have any.
std::set<std::string> varied_columns(const sqlite::Database& database, const Names& columns,
                                     const std::set<std::string>& keys) {
  std::set<std::string> varied;
  for (const bool of_figures : {false, true}) {
    Names compared;
    std::string list;
    for (const std::string& column : columns) {
      if (of_figures == (keys.count(column) > 0 || is_first(column))) continue;
      compared.push_back(column);
      list +=
          fmt::format("{0}max(p.{1} IS NOT f.{1})", list.empty() ? "" : ", ", sqlite::quoted_name(column));
    }
    if (compared.empty()) continue;
    const char* const which = of_figures ? "WHERE status = 'ok'" : "";
    sqlite::Statement differ(database,
                             fmt::format("SELECT {0} FROM (SELECT * FROM points {1} LIMIT 1) AS f CROSS JOIN "
                                         "(SELECT * FROM points {1}) AS p",
                                         list, which));
    differ.step();
    for (std::size_t i = 0; i < compared.size(); ++i) {
      if (differ.is_true(static_cast<int>(i))) varied.insert(compared[i]);
    }
  }
  return varied;
}

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

// The offset of the byte that is locked, far behind the bytes that SQLite itself locks.
constexpr off_t kPlace = off_t{1} << 61;
constexpr std::chrono::milliseconds kBetweenTries{20};

// The columns and keys of the stores that are merged.
struct Inputs {
  std::map<std::string, std::string, IsLessWithoutCase> columns;  // [name]: the first store that has it
  std::set<std::string> keys;
  std::string version;
  std::string path_of_version;

  // Throws if the file is no store, if its points have another version than those before, or if a column
  // differs from one before only in case.
  void add(const std::string& path) {
    sqlite::Database input(path, sqlite::Database::Access::kRead);
    for (const std::string& column : store_columns(input)) {
      const auto& [name, first] = *columns.emplace(column, path).first;
      if (name == column) continue;
      throw sqlite::DatabaseError(
          fmt::format("{}: its column {} differs from {} of {} only in case: they do not mix", path, column,
                      name, first));
    }
    for (const std::string& key : input.texts("SELECT name FROM columns WHERE is_key")) keys.insert(key);
    for (const std::string& its : input.texts("SELECT DISTINCT version FROM points")) {
      if (version.empty()) std::tie(version, path_of_version) = std::pair(its, path);
      if (its == version) continue;
      throw sqlite::DatabaseError(
          fmt::format("{}: holds points of version {}, and {} of version {}: they do not mix", path, its,
                      path_of_version, version));
    }
  }

  Names ordered_columns() const {
    Names names;
    for (const auto& [name, path] : columns) names.push_back(name);
    return in_order(names);
  }
};

// Throws if the attached stores `input` and `gathered` hold different results of a point. A column that
// `input` lacks is NULL. `own`: the columns of `input`; `columns`: those of `gathered`.
void check_same_points(const sqlite::Database& database, const Names& own, const Names& columns,
                       const Names& paths, const std::string& path) {
  std::string values;
  for (const std::string& column : columns) {
    const bool is_there = std::find(own.begin(), own.end(), column) != own.end();
    values += (values.empty() ? "" : ", ") + (is_there ? "i." + sqlite::quoted_name(column) : "NULL");
  }
  const char* blame =
      "SELECT hash FROM (SELECT {0} FROM {1}.blame WHERE hash IN (SELECT hash FROM {2}.points)"
      " EXCEPT SELECT {0} FROM {2}.blame)";
  const Names hashes = database.texts(
      fmt::format("SELECT i.hash FROM input.points AS i JOIN gathered.points AS g ON g.hash = i.hash "
                  "WHERE ({}) IS NOT ({}) UNION ALL {} UNION ALL {} LIMIT 1",
                  values, listed(columns, "g."), fmt::format(blame, kBlameColumns, "input", "gathered"),
                  fmt::format(blame, kBlameColumns, "gathered", "input")));
  if (hashes.empty()) return;
  const auto first = std::find_if(paths.begin(), paths.end(), [&](const std::string& other) {
    return StoredRow(other).find(hashes.front());
  });
  throw sqlite::DatabaseError(
      fmt::format("{}: holds another result of point {} than {}", path, hashes.front(), *first));
}

// Puts the points of all inputs into the attached store `gathered`, which is empty. Throws if two inputs hold
// different results of the same point. `columns`: of `gathered`.
void gather(const Names& paths, sqlite::Database& database, const Names& columns) {
  for (const std::string& path : paths) {
    database.attach(path, "input");
    database.execute("BEGIN");
    const Names own = database.texts("SELECT name FROM pragma_table_info('points', 'input')");
    check_same_points(database, own, columns, paths, path);
    database.execute(
        fmt::format("INSERT OR IGNORE INTO gathered.points({0}) SELECT {0} FROM input.points;"
                    "INSERT OR IGNORE INTO gathered.blame({1}) SELECT {1} FROM input.blame;"
                    "COMMIT; DETACH input",
                    listed(own), kBlameColumns));
  }
}

// Moves the contents of the journal of a store into its file, so that the journal can be removed.
void empty_journal(const std::string& path) {
  sqlite::Database database(path, sqlite::Database::Access::kWrite);
  store_columns(database);
  sqlite::Statement checkpoint(database, "PRAGMA wal_checkpoint(TRUNCATE)");
  if (checkpoint.step() && checkpoint.integer(0) != 0) database.fail(SQLITE_BUSY);
}

}  // namespace

Names store_columns(sqlite::Database& database) {
  if (database.number("PRAGMA application_id") != kApplicationId) {
    throw sqlite::DatabaseError(database.path() + ": not a database of stereotlm sweep");
  }
  const std::int64_t layout = database.number("PRAGMA user_version");
  if (layout != kLayout) {
    throw sqlite::DatabaseError(
        fmt::format("{}: its layout is {}, of another version; this version writes {}", database.path(),
                    layout, kLayout));
  }
  return database.texts("SELECT name FROM pragma_table_info('points') ORDER BY cid");
}

std::string run_key_meaning(const std::string& path) {
  if (path == kSourcePath) return "preloaded, the core alone, or camera, the whole computer";
  if (path == kFramesPath) return "frames to deliver";
  if (path == kCalibrationPath) return "SHA-256 of the tables of the calibration; NULL: the identity";
  if (path == kPairsPath) return "SHA-256 of the pictures, truths and scales of the accuracy";
  if (path == kSyntheticPath) return "seeds of the made scenes of the accuracy";
  return "";
}

Figures figures_of(const Json& document) {
  Figures figures;
  for (const auto& [key, value] : document.items()) {
    if (key == "schema") continue;
    if (key == "blame") {
      for (const Json& row : value) {
        figures.blame.push_back({row["port"], row["bank"], row["by"], row["cycles"]});
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

std::string bank_names_problem(const std::string& one, const std::string& other) {
  return fmt::format(
      "ssram.banks = {}, {}: the names differ only in case: a database could not distinguish their columns",
      one, other);
}

Store::Store(const std::string& path, const std::string& version, std::chrono::milliseconds busy_timeout)
    : database_(path, sqlite::Database::Access::kCreate, busy_timeout), version_(version) {
  create();
  check_version(database_, version);
  find_.emplace(database_, "SELECT 1 FROM points WHERE hash = ?");
  insert_blame_.emplace(database_, fmt::format("INSERT INTO blame({}) VALUES(?, ?, ?, ?, ?)", kBlameColumns));
}

// The first process to open the file creates the tables.
void Store::create() {
  if (database_.number(kSizeOfSchema) == 0) {
    database_.execute("PRAGMA synchronous = OFF");  // an empty store has nothing that could be lost
    // Small pages, because the journal holds each changed page as a whole. Not smaller: if a row does not fit
    // into its page, the merge reads its columns slowly.
    database_.execute("PRAGMA page_size = 2048");
    wait_for_writers(database_);
    // With this journal readers do not wait for a writer, and nothing is lost when a process ends, whatever
    // ends it.
    database_.execute("PRAGMA journal_mode = WAL");
    database_.execute("BEGIN IMMEDIATE");
    if (database_.number(kSizeOfSchema) == 0) {
      create_tables(database_, {});
      for (const auto& [name, meaning] : kFirstColumns) insert_column(database_, name, false);
    }
    database_.execute("COMMIT");
  }
  read_columns();
  if (database_.texts("PRAGMA journal_mode").front() != "wal") wait_for_writers(database_);
  database_.execute(
      "PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL; PRAGMA wal_autocheckpoint = 16384");
}

void Store::read_columns() {
  const Names names = store_columns(database_);
  columns_ = {names.begin(), names.end()};
}

void Store::check_banks(const Names& banks) const {
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
  std::vector<platform::BoardValue> values = point.keys;
  values.insert(values.end(), point.figures.values.begin(), point.figures.values.end());
  Names columns;
  for (const auto& [name, meaning] : kFirstColumns) columns.emplace_back(name);
  for (const platform::BoardValue& value : values) columns.push_back(value.path);
  database_.execute("BEGIN IMMEDIATE");
  try {
    sqlite::Statement& insert = insertion(point, columns);
    int place = 0;
    for (const std::string& text : {point.hash, point.status, point.reason, version_, point.config})
      insert.bind(++place, text);
    for (const platform::BoardValue& value : values) insert.bind(++place, value.value);
    insert.run();
    const bool is_new = sqlite3_changes(database_.handle()) > 0;
    for (const platform::BlameRow& row : point.figures.blame) {
      if (!is_new) break;
      place = 0;
      for (const std::string& text : {point.hash, row.port, row.bank, row.by})
        insert_blame_->bind(++place, text);
      insert_blame_->bind(++place, static_cast<std::int64_t>(row.cycles));
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

// The statement that inserts a point with these columns. Adds those that the table lacks.
sqlite::Statement& Store::insertion(const StoredPoint& point, const Names& columns) {
  const auto known = insertions_.find(columns);
  if (known != insertions_.end()) return known->second;
  add_columns(point);
  database_.execute("UPDATE columns SET varied = NULL WHERE varied IS NOT NULL");
  const std::string sql = fmt::format("INSERT OR IGNORE INTO points({}) VALUES({})", listed(columns),
                                      fmt::join(Names(columns.size(), "?"), ", "));
  return insertions_.try_emplace(columns, database_, sql).first->second;
}

void Store::add_columns(const StoredPoint& point) {
  read_columns();  // another process may have added some
  std::vector<std::string> missing;
  for (const auto* values : {&point.keys, &point.figures.values}) {
    for (const platform::BoardValue& value : *values) {
      if (!columns_.insert(value.path).second) continue;
      missing.push_back(value.path);
      insert_column(database_, value.path, values == &point.keys);
    }
  }
  if (missing.empty()) return;
  // SQLite reads the whole schema again for each column that is added. A table without points is made anew
  // instead, with all columns at once.
  if (database_.number("SELECT EXISTS(SELECT 1 FROM points)") == 0) {
    database_.execute("DROP TABLE points");
    create_points(database_, {columns_.begin(), columns_.end()});
  } else {
    for (const std::string& column : missing)
      database_.execute("ALTER TABLE points ADD COLUMN " + sqlite::quoted_name(column));
  }
  create_view(database_, {columns_.begin(), columns_.end()});
}

StoredRow::StoredRow(const std::string& path, const std::string& version)
    : database_(path, sqlite::Database::Access::kRead) {
  store_columns(database_);
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

std::string behind_links(const std::string& store) {
  std::string path;
  try {
    path = files::linked_file(store).string();
  } catch (const std::system_error& error) {
    throw sqlite::DatabaseError(fmt::format("{}: cannot be opened: {}", store, error.code().message()));
  }
  if (const auto problem = files::result_folder_problem(path))
    throw sqlite::DatabaseError(fmt::format("{}: {}", store, *problem));
  return path;
}

// Uses a lock of the open file description. A lock of the process would end as soon as the process closed any
// descriptor of the file.
StoreLock::StoreLock(const std::string& store, std::chrono::milliseconds busy_timeout)
    : store_(store), path_(behind_links(store)) {
  const auto end = std::chrono::steady_clock::now() + busy_timeout;
  for (;; std::this_thread::sleep_for(kBetweenTries)) {
    constexpr mode_t kMode = 0644;
    file_ = open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, kMode);
    is_made_ = file_ >= 0;
    if (file_ < 0 && errno == EEXIST) file_ = open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, kMode);
    if (file_ < 0)
      throw sqlite::DatabaseError(
          fmt::format("{}: cannot be opened to write: {}", store, std::strerror(errno)));
    struct flock range = {};
    range.l_type = F_WRLCK;
    range.l_whence = SEEK_SET;
    range.l_start = kPlace;
    range.l_len = 1;
    const bool is_locked = fcntl(file_, F_OFD_SETLK, &range) == 0;
    const int error = is_locked ? EAGAIN : errno;
    if (is_locked && files::is_open_at(file_, path_)) break;  // else the file was replaced meanwhile
    close(file_);
    if (error != EAGAIN && error != EACCES)
      throw sqlite::DatabaseError(fmt::format("{}: cannot be locked: {}", store, std::strerror(error)));
    if (std::chrono::steady_clock::now() >= end)
      throw sqlite::DatabaseError(
          store + ": another process is at work on it: wait for its end, or give another file");
  }
  const std::string remove_empty = "[ -s \"$1\" ] || ! is_ours \"$1\" || /bin/rm -f -- \"$1\" \"$1-journal\"";
  if (!is_made_) return;
  try {
    remover_.emplace(remove_empty, Names{fs::absolute(path_)}, file_);
  } catch (...) {  // such as too many open files
    unlink(path_.c_str());
    close(file_);
    throw;
  }
}

void StoreLock::check() const {
  if (!files::is_open_at(file_, path_)) throw StoreGone(store_);
}

StoreLock::~StoreLock() {
  struct stat opened = {};
  const bool is_empty = fstat(file_, &opened) == 0 && opened.st_size == 0;
  if (is_made_ && is_empty && files::is_open_at(file_, path_)) unlink(path_.c_str());
  close(file_);
}

void merge_stores(const Names& inputs, const std::string& store,
                  const std::function<bool()>& is_interrupted) try {
  const std::string out = behind_links(store);
  std::error_code none;
  if (fs::file_size(out, none) > 0 && !none) empty_journal(out);
  Inputs all;
  for (const std::string& path : inputs) all.add(path);
  const Names columns = all.ordered_columns();
  using namespace std::string_literals;
  const auto kind =
      files::marked_kind("database of stereotlm sweep", {{0, "SQLite format 3\0"s}, {68, "STLM"}});
  files::OutputFile file(out, kind);
  {
    sqlite::Database database(file.unfinished().string(), sqlite::Database::Access::kWrite,
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
      create_tables(database, columns, "gathered");
      gather(inputs, database, columns);
    }
    database.execute("BEGIN");
    create_tables(database, columns);
    // In an order in which the bytes depend only on the points.
    database.execute(
        fmt::format("INSERT INTO main.points({0}) SELECT {0} FROM {2}.points ORDER BY hash;"
                    "INSERT INTO main.blame({1}) SELECT {1} FROM {2}.blame ORDER BY hash, port, bank, by",
                    listed(columns), kBlameColumns, is_single ? "input" : "gathered"));
    const std::set<std::string> varied = varied_columns(database, columns, all.keys);
    for (const std::string& column : columns)
      insert_column(database, column, all.keys.count(column) > 0, varied.count(column) > 0);
    create_view(database, columns);
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
