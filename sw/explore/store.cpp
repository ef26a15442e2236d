#include "sw/explore/store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>
#include <random>
#include <utility>

#include "sw/explore/bank_names.h"

namespace stereotlm::explore {
namespace {

namespace fs = std::filesystem;

constexpr int kApplicationId = 0x53544C4D;  // "STLM"
constexpr int kLayout = 2;

// The columns that every database has, in front.
constexpr std::array kFirstColumns = {"hash", "status", "reason", "version", "config"};
constexpr const char* kBlameColumns = "hash, port, bank, by, cycles";

void create_tables(Database& database, const std::vector<std::string>& further_columns) {
  std::string columns =
      "hash TEXT PRIMARY KEY NOT NULL, status TEXT NOT NULL, reason TEXT NOT NULL, "
      "version TEXT NOT NULL, config TEXT NOT NULL";
  for (const std::string& name : further_columns) columns += ", " + quoted_name(name);
  database.execute(
      fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}", kApplicationId, kLayout));
  database.execute(fmt::format("CREATE TABLE points({})", columns));
  database.execute(
      "CREATE TABLE blame(hash TEXT NOT NULL, port TEXT NOT NULL, bank TEXT NOT NULL, by TEXT NOT NULL, "
      "cycles INTEGER NOT NULL, PRIMARY KEY(hash, port, bank, by)) WITHOUT ROWID");
  database.execute("CREATE TABLE keys(name TEXT PRIMARY KEY NOT NULL) WITHOUT ROWID");
}

void check_layout(Database& database) {
  if (database.number("PRAGMA application_id") != kApplicationId) {
    throw DatabaseError(database.path() + ": not a database of stereotlm sweep");
  }
  const std::int64_t layout = database.number("PRAGMA user_version");
  if (layout != kLayout) {
    throw DatabaseError(fmt::format("{}: its layout is {}, of another version; this version writes {}",
                                    database.path(), layout, kLayout));
  }
}

void check_version(Database& database, const std::string& version) {
  Statement other(database, "SELECT version FROM points WHERE version <> ? LIMIT 1");
  other.bind(1, version);
  if (!other.step()) return;
  throw DatabaseError(fmt::format("{}: holds points of version {}; this is version {}: give another file",
                                  database.path(), other.text(0), version));
}

// SQLite does not wait when it is to change the kind of its journal.
void wait_for_writers(Database& database) { database.execute("BEGIN IMMEDIATE; COMMIT"); }

std::string journal_of(const Database& database) {
  Statement statement(database, "PRAGMA journal_mode");
  return statement.step() ? statement.text(0) : "";
}

constexpr const char* kFind = "SELECT 1 FROM points WHERE hash = ?";

bool finds(Statement& find, const std::string& hash) {
  find.bind(1, hash);
  const bool found = find.step();
  find.reset();
  return found;
}

// The first column of what a query gives.
std::vector<std::string> names_of(const Database& database, const std::string& sql) {
  std::vector<std::string> names;
  Statement statement(database, sql);
  while (statement.step()) names.push_back(statement.text(0));
  return names;
}

std::vector<std::string> columns_of(const Database& database) {
  return names_of(database, "SELECT name FROM pragma_table_info('points') ORDER BY cid");
}

void insert_key(const Database& database, const std::string& name) {
  Statement insert(database, "INSERT INTO keys(name) VALUES(?)");
  insert.bind(1, name);
  insert.run();
}

// What a point has in further columns, in the order of insertion().
std::vector<const platform::BoardValue*> further_values(const StoredPoint& point) {
  std::vector<const platform::BoardValue*> values;
  for (const auto* part : {&point.keys, &point.figures}) {
    for (const platform::BoardValue& value : *part) values.push_back(&value);
  }
  return values;
}

std::string insert_sql(const std::vector<std::string>& columns) {
  std::string names;
  std::string places;
  for (const std::string& name : columns) {
    names += (names.empty() ? "" : ", ") + quoted_name(name);
    places += places.empty() ? "?" : ", ?";
  }
  return fmt::format("INSERT OR IGNORE INTO points({}) VALUES({})", names, places);
}

const std::string kInsertBlame = fmt::format("INSERT INTO blame({}) VALUES(?, ?, ?, ?, ?)", kBlameColumns);

}  // namespace

Store::Store(const std::string& path, const std::string& version, std::chrono::milliseconds patience)
    : database_(path, Database::Access::kCreate, patience), version_(version) {
  create();
  check_version(database_, version);
  read_columns();
  find_ = std::make_unique<Statement>(database_, kFind);
  insert_blame_ = std::make_unique<Statement>(database_, kInsertBlame);
}

// Once, by whoever comes first.
void Store::create() {
  if (database_.number("SELECT count(*) FROM sqlite_schema") == 0) {
    wait_for_writers(database_);
    // Readers do not wait for the one who writes; nothing is lost when the process ends, however it does.
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
      throw DatabaseError(fmt::format("{}: its column {} differs from {} only in case: give another file",
                                      database_.path(), column, words));
    }
  }
}

bool Store::has(const std::string& hash) { return finds(*find_, hash); }

bool Store::add(const StoredPoint& point) {
  database_.execute("BEGIN IMMEDIATE");
  try {
    add_columns(point);
    Statement& insert = insertion(point);
    int place = 0;
    for (const std::string& text : {point.hash, point.status, point.reason, version_, point.config})
      insert.bind(++place, text);
    for (const platform::BoardValue* value : further_values(point)) insert.bind(++place, *value);
    insert.run();
    const bool is_new = sqlite3_changes(database_.handle()) > 0;
    for (const StoredBlame& row : point.blame) {
      if (!is_new) break;
      place = 0;
      for (const std::string& text : {point.hash, row.port, row.bank, row.by})
        insert_blame_->bind(++place, text);
      insert_blame_->bind(++place, row.cycles);
      insert_blame_->run();
    }
    database_.execute("COMMIT");
    return is_new;
  } catch (const DatabaseError&) {
    sqlite3_exec(database_.handle(), "ROLLBACK", nullptr, nullptr,
                 nullptr);  // SQLite may have done it already
    throw;
  }
}

void Store::add_columns(const StoredPoint& point) {
  const auto is_known = [this](const platform::BoardValue& value) { return columns_.count(value.path) > 0; };
  const auto are_known = [&](const std::vector<platform::BoardValue>& values) {
    return std::all_of(values.begin(), values.end(), is_known);
  };
  if (are_known(point.keys) && are_known(point.figures)) return;
  read_columns();  // another process may have added them
  for (const auto* values : {&point.keys, &point.figures}) {
    for (const platform::BoardValue& value : *values) {
      if (is_known(value)) continue;
      database_.execute("ALTER TABLE points ADD COLUMN " + quoted_name(value.path));
      if (values == &point.keys) insert_key(database_, value.path);
      columns_.insert(value.path);
    }
  }
}

Statement& Store::insertion(const StoredPoint& point) {
  std::string signature;
  for (const platform::BoardValue* value : further_values(point)) signature += value->path + '\n';
  std::unique_ptr<Statement>& statement = insertions_[signature];
  if (!statement) {
    std::vector<std::string> columns(kFirstColumns.begin(), kFirstColumns.end());
    for (const platform::BoardValue* value : further_values(point)) columns.push_back(value->path);
    statement = std::make_unique<Statement>(database_, insert_sql(columns));
  }
  statement->clear_bindings();
  return *statement;
}

FinishedStore::FinishedStore(const std::string& path, const std::string& version)
    : database_(path, Database::Access::kRead) {
  check_layout(database_);
  check_version(database_, version);
  find_.emplace(database_, kFind);
}

bool FinishedStore::has(const std::string& hash) { return finds(*find_, hash); }

namespace {

// Numbers inside names count as numbers: bank2 comes before bank10.
bool is_before(const std::string& a, const std::string& b) {
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_digit(a[i]) && is_digit(b[j])) {
      std::size_t i_end = i;
      std::size_t j_end = j;
      while (i_end < a.size() && is_digit(a[i_end])) ++i_end;
      while (j_end < b.size() && is_digit(b[j_end])) ++j_end;
      if (i_end - i != j_end - j) return i_end - i < j_end - j;
      const int order = a.compare(i, i_end - i, b, j, j_end - j);
      if (order != 0) return order < 0;
      i = i_end;
      j = j_end;
    } else {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
    }
  }
  return a.size() - i < b.size() - j;
}

// The points of one file, in the order of their hashes.
class Reader {
 public:
  explicit Reader(const std::string& path) : database_(path, Database::Access::kRead) {
    check_layout(database_);
    columns_ = columns_of(database_);
    keys_ = names_of(database_, "SELECT name FROM keys");
    points_.emplace(database_, "SELECT * FROM points ORDER BY hash");
    blame_.emplace(database_, fmt::format("SELECT {} FROM blame WHERE hash = ? ORDER BY hash, port, bank, by",
                                          kBlameColumns));
    all_blame_.emplace(database_,
                       fmt::format("SELECT {} FROM blame ORDER BY hash, port, bank, by", kBlameColumns));
    next();
  }

  const std::string& path() const { return database_.path(); }
  const std::vector<std::string>& columns() const { return columns_; }
  const std::vector<std::string>& keys() const { return keys_; }  // those of the columns that are
  bool at_end() const { return !has_point_; }
  const std::string& hash() const { return hash_; }
  std::vector<std::string> versions() const {  // of its points
    return names_of(database_, "SELECT DISTINCT version FROM points ORDER BY version");
  }
  void next() {
    has_point_ = points_->step();
    hash_ = has_point_ ? points_->text(0) : "";
  }
  const Statement& point() const { return *points_; }
  Statement& blame() {  // of the point
    blame_->reset();
    blame_->bind(1, hash_);
    return *blame_;
  }
  // A row of all blame, point after point.
  void next_blame() { has_blame_ = all_blame_->step(); }
  bool has_blame() const { return has_blame_; }
  const Statement& all_blame() const { return *all_blame_; }
  std::string blame_hash() const { return all_blame_->text(0); }

 private:
  Database database_;
  std::vector<std::string> columns_;
  std::vector<std::string> keys_;
  std::optional<Statement> points_;
  std::optional<Statement> blame_;
  std::optional<Statement> all_blame_;
  bool has_point_ = false;
  bool has_blame_ = false;
  std::string hash_;
};

// Everything that a file says about a point, as one text.
std::string whole_text(Reader& reader, const std::vector<std::string>& columns) {
  std::string text;
  for (const std::string& column : columns) {
    const auto found = std::find(reader.columns().begin(), reader.columns().end(), column);
    if (found != reader.columns().end()) {
      text += reader.point().text(static_cast<int>(found - reader.columns().begin()));
    }
    text += '\n';
  }
  Statement& blame = reader.blame();
  while (blame.step()) {
    for (int column = 1; column < blame.columns(); ++column) text += blame.text(column) + ' ';
  }
  blame.reset();
  return text;
}

// That all points are of one version.
void check_versions(const std::vector<std::unique_ptr<Reader>>& readers) {
  const Reader* first = nullptr;
  std::string of_first;
  for (const auto& reader : readers) {
    for (const std::string& version : reader->versions()) {
      if (first == nullptr) {
        first = reader.get();
        of_first = version;
      }
      if (version == of_first) continue;
      throw DatabaseError(fmt::format("{}: holds points of version {}, and {} of version {}: they do not mix",
                                      reader->path(), version, first->path(), of_first));
    }
  }
}

// That there is no column that differs from another only in case.
void check_columns(const std::vector<std::unique_ptr<Reader>>& readers) {
  const auto is_less = [](const std::string& a, const std::string& b) {
    return sqlite3_stricmp(a.c_str(), b.c_str()) < 0;
  };
  std::map<std::string, const Reader*, decltype(is_less)> all(is_less);
  for (const auto& reader : readers) {
    for (const std::string& column : reader->columns()) {
      const auto& [name, first] = *all.emplace(column, reader.get()).first;
      if (name == column) continue;
      throw DatabaseError(fmt::format("{}: its column {} differs from {} of {} only in case: they do not mix",
                                      reader->path(), column, name, first->path()));
    }
  }
}

std::vector<std::string> all_columns(const std::vector<std::unique_ptr<Reader>>& readers) {
  check_columns(readers);
  std::set<std::string> names;
  for (const auto& reader : readers) names.insert(reader->columns().begin(), reader->columns().end());
  for (const char* first : kFirstColumns) names.erase(first);
  std::vector<std::string> columns(names.begin(), names.end());
  std::sort(columns.begin(), columns.end(), is_before);
  return columns;
}

void copy_keys(const std::vector<std::unique_ptr<Reader>>& readers, Database& out) {
  std::set<std::string> keys;
  for (const auto& reader : readers) keys.insert(reader->keys().begin(), reader->keys().end());
  for (const std::string& key : keys) insert_key(out, key);
}

// Where each column of a reader lies among these.
std::vector<int> places_of(const Reader& reader, const std::vector<std::string>& columns) {
  std::vector<int> places;
  for (const std::string& column : reader.columns())
    places.push_back(static_cast<int>(std::find(columns.begin(), columns.end(), column) - columns.begin()));
  return places;
}

// Copies all points, each once.
void copy_points(std::vector<std::unique_ptr<Reader>>& readers, Database& out,
                 const std::vector<std::string>& columns) {
  Statement insert(out, insert_sql(columns));
  std::map<const Reader*, std::vector<int>> places;
  for (const auto& reader : readers) places.emplace(reader.get(), places_of(*reader, columns));
  for (;;) {
    Reader* first = nullptr;
    for (const auto& reader : readers) {
      if (!reader->at_end() && (first == nullptr || reader->hash() < first->hash())) first = reader.get();
    }
    if (first == nullptr) return;
    const std::string hash = first->hash();
    for (const auto& reader : readers) {
      if (reader.get() == first || reader->at_end() || reader->hash() != hash) continue;
      if (whole_text(*reader, columns) != whole_text(*first, columns)) {
        throw DatabaseError(
            fmt::format("{}: holds another result of point {} than {}", reader->path(), hash, first->path()));
      }
      reader->next();
    }
    insert.clear_bindings();
    int column = 0;
    for (const int place : places.at(first)) insert.bind_column(place + 1, first->point(), column++);
    insert.run();
    first->next();
  }
}

// Copies the blame of all points, behind them.
void copy_blame(std::vector<std::unique_ptr<Reader>>& readers, Database& out) {
  Statement insert(out, kInsertBlame);
  for (const auto& reader : readers) reader->next_blame();
  for (;;) {
    Reader* first = nullptr;
    for (const auto& reader : readers) {
      if (reader->has_blame() && (first == nullptr || reader->blame_hash() < first->blame_hash()))
        first = reader.get();
    }
    if (first == nullptr) return;
    const std::string hash = first->blame_hash();
    for (; first->has_blame() && first->blame_hash() == hash; first->next_blame()) {
      for (int i = 0; i < first->all_blame().columns(); ++i) insert.bind_column(i + 1, first->all_blame(), i);
      insert.run();
    }
    for (const auto& reader : readers) {  // it is the same, as the points are
      while (reader->has_blame() && reader->blame_hash() == hash) reader->next_blame();
    }
  }
}

// Both, of the one store that is attached as `input`.
void copy_attached(Database& out, const std::vector<std::string>& columns) {
  std::string names;
  for (const std::string& column : columns) names += (names.empty() ? "" : ", ") + quoted_name(column);
  out.execute(
      fmt::format("INSERT INTO main.points({}) SELECT {} FROM input.points ORDER BY hash", names, names));
  out.execute(
      fmt::format("INSERT INTO main.blame({0}) SELECT {0} FROM input.blame ORDER BY hash, port, bank, by",
                  kBlameColumns));
}

// Brings all that its journal holds into the file itself: the journal can go then, whatever follows.
void empty_journal(const std::string& path) {
  Database database(path, Database::Access::kWrite);
  check_layout(database);
  Statement checkpoint(database, "PRAGMA wal_checkpoint(TRUNCATE)");
  if (checkpoint.step() && checkpoint.integer(0) != 0) database.fail(SQLITE_BUSY);
}

// A new file beside a store, that takes its place or goes. Those that processes have left which were killed
// go too.
class NewFile {
 public:
  explicit NewFile(const std::string& store) {
    remove_left(store);
    std::random_device random;
    int file = -1;
    do {
      path_ = fmt::format("{}{}{:08x}{:08x}", store, kMark, random(), random());
      file = open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
    } while (file < 0 && errno == EEXIST);
    if (file < 0) throw DatabaseError(fmt::format("{}: cannot be made: {}", path_, std::strerror(errno)));
    close(file);
  }
  ~NewFile() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove(path_, ignored);
  }
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  const std::string& path() const { return path_; }

  void replace(const std::string& store) {
    if (std::rename(path_.c_str(), store.c_str()) != 0)
      throw DatabaseError(fmt::format("{}: cannot be replaced: {}", store, std::strerror(errno)));
    path_.clear();
  }

 private:
  static constexpr const char* kMark = ".merging-";  // and 16 hexadecimal digits: nobody else's name

  static void remove_left(const std::string& store) {
    const std::string begin = fs::path(store).filename().string() + kMark;
    const fs::path folder = fs::path(store).parent_path();
    std::error_code ignored;
    std::vector<fs::path> left;
    for (const auto& entry : fs::directory_iterator(folder.empty() ? "." : folder, ignored)) {
      const std::string name = entry.path().filename().string();
      const bool is_ours = name.size() == begin.size() + 16 && name.compare(0, begin.size(), begin) == 0 &&
                           name.find_first_not_of("0123456789abcdef", begin.size()) == std::string::npos;
      if (is_ours) left.push_back(entry.path());
    }
    for (const fs::path& path : left) fs::remove(path, ignored);
  }

  std::string path_;
};

}  // namespace

void merge_stores(const std::vector<std::string>& inputs, const std::string& out) {
  std::error_code none;
  if (fs::file_size(out, none) > 0 && !none) empty_journal(out);
  std::vector<std::unique_ptr<Reader>> readers;
  readers.reserve(inputs.size());
  for (const std::string& input : inputs) readers.push_back(std::make_unique<Reader>(input));
  check_versions(readers);
  NewFile file(out);
  {
    Database database(file.path(), Database::Access::kWrite);
    database.execute(
        "PRAGMA journal_mode = OFF; PRAGMA synchronous = NORMAL; PRAGMA main.locking_mode = EXCLUSIVE");
    if (inputs.size() == 1) {
      Statement attach(database, "ATTACH ? AS input");
      attach.bind(1, inputs.front());
      attach.run();
    }
    database.execute("BEGIN");
    std::vector<std::string> columns = all_columns(readers);
    create_tables(database, columns);
    columns.insert(columns.begin(), kFirstColumns.begin(), kFirstColumns.end());
    copy_keys(readers, database);
    if (inputs.size() == 1) {
      copy_attached(database, columns);
    } else {
      copy_points(readers, database, columns);
      copy_blame(readers, database);
    }
    database.execute("COMMIT");
  }
  readers.clear();
  for (const char* ending : {"-wal", "-shm"}) fs::remove(out + ending, none);
  file.replace(out);
}

}  // namespace stereotlm::explore
