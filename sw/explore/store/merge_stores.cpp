#include "sw/explore/store/merge_stores.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sqlite3.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <system_error>

#include "sw/explore/store/store_layout.h"
#include "sw/explore/store/store_lock.h"
#include "sw/files/replaced_file.h"

namespace stereotlm::explore {
namespace {

namespace fs = std::filesystem;

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
  Statement insert(out, insert_point_sql(columns));
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
  Statement insert(out, insert_blame_sql());
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
class MergedFile {
 public:
  explicit MergedFile(const std::string& store) {
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
  ~MergedFile() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove(path_, ignored);
  }
  MergedFile(const MergedFile&) = delete;
  MergedFile& operator=(const MergedFile&) = delete;

  const std::string& path() const { return path_; }

  void replace(const std::string& store) {
    try {
      files::take_place(path_, store);
    } catch (const std::system_error& error) {
      throw DatabaseError(fmt::format("{}: cannot be replaced: {}", store, error.code().message()));
    }
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

void merge_stores(const std::vector<std::string>& inputs, const std::string& store) {
  const std::string out = behind_links(store);
  std::error_code none;
  if (fs::file_size(out, none) > 0 && !none) empty_journal(out);
  std::vector<std::unique_ptr<Reader>> readers;
  readers.reserve(inputs.size());
  for (const std::string& input : inputs) readers.push_back(std::make_unique<Reader>(input));
  check_versions(readers);
  MergedFile file(out);
  {
    Database database(file.path(), Database::Access::kWrite);
    database.execute(
        "PRAGMA journal_mode = OFF; PRAGMA synchronous = NORMAL; PRAGMA main.locking_mode = EXCLUSIVE");
    if (inputs.size() == 1) {
      database.attach(inputs.front(), "input");
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
