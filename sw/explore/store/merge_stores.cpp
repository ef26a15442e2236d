#include "sw/explore/store/merge_stores.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <system_error>

#include "sw/explore/store/store_layout.h"
#include "sw/explore/store/store_lock.h"
#include "sw/explore/store/store_reader.h"
#include "sw/files/output_file.h"

namespace stereotlm::explore {
namespace {

namespace fs = std::filesystem;

using Readers = std::vector<std::unique_ptr<StoreReader>>;

// The order of column names. Numbers inside names compare as numbers: bank2 comes before bank10.
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

// Throws unless all points have the same version.
void check_versions(const Readers& readers) {
  const StoreReader* first = nullptr;
  std::string of_first;
  for (const auto& reader : readers) {
    for (const std::string& version : reader->versions()) {
      if (first == nullptr) {
        first = reader.get();
        of_first = version;
      }
      if (version == of_first) continue;
      throw sqlite::DatabaseError(
          fmt::format("{}: holds points of version {}, and {} of version {}: they do not mix", reader->path(),
                      version, first->path(), of_first));
    }
  }
}

// Throws if two columns differ only in case.
void check_columns(const Readers& readers) {
  const auto is_less = [](const std::string& a, const std::string& b) {
    return sqlite3_stricmp(a.c_str(), b.c_str()) < 0;
  };
  std::map<std::string, const StoreReader*, decltype(is_less)> all(is_less);
  for (const auto& reader : readers) {
    for (const std::string& column : reader->columns()) {
      const auto& [name, first] = *all.emplace(column, reader.get()).first;
      if (name == column) continue;
      throw sqlite::DatabaseError(
          fmt::format("{}: its column {} differs from {} of {} only in case: they do not mix", reader->path(),
                      column, name, first->path()));
    }
  }
}

// The columns of all readers without kFirstColumns, in the order of is_before().
std::vector<std::string> further_columns(const Readers& readers) {
  check_columns(readers);
  std::set<std::string> names;
  for (const auto& reader : readers) names.insert(reader->columns().begin(), reader->columns().end());
  for (const char* first : kFirstColumns) names.erase(first);
  std::vector<std::string> columns(names.begin(), names.end());
  std::sort(columns.begin(), columns.end(), is_before);
  return columns;
}

void copy_keys(const Readers& readers, sqlite::Database& out) {
  std::set<std::string> keys;
  for (const auto& reader : readers) keys.insert(reader->keys().begin(), reader->keys().end());
  for (const std::string& key : keys) insert_board_key(out, key);
}

// The index in `columns` of each column of a reader.
std::vector<int> places_of(const StoreReader& reader, const std::vector<std::string>& columns) {
  std::vector<int> places;
  for (const std::string& column : reader.columns())
    places.push_back(static_cast<int>(std::find(columns.begin(), columns.end(), column) - columns.begin()));
  return places;
}

// Copies each point once. Throws if two readers hold different results of the same point.
void copy_points(Readers& readers, sqlite::Database& out, const std::vector<std::string>& columns) {
  sqlite::Statement insert(out, insert_point_sql(columns));
  std::map<const StoreReader*, std::vector<int>> places;
  for (const auto& reader : readers) places.emplace(reader.get(), places_of(*reader, columns));
  for (;;) {
    StoreReader* first = nullptr;
    for (const auto& reader : readers) {
      if (!reader->at_end() && (first == nullptr || reader->hash() < first->hash())) first = reader.get();
    }
    if (first == nullptr) return;
    const std::string hash = first->hash();
    for (const auto& reader : readers) {
      if (reader.get() == first || reader->at_end() || reader->hash() != hash) continue;
      if (reader->whole_text(columns) != first->whole_text(columns)) {
        throw sqlite::DatabaseError(
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

// Copies the blame of each point once. Readers that hold the same point hold the same blame.
void copy_blame(Readers& readers, sqlite::Database& out) {
  sqlite::Statement insert(out, insert_blame_sql());
  for (const auto& reader : readers) reader->next_blame();
  for (;;) {
    StoreReader* first = nullptr;
    for (const auto& reader : readers) {
      if (reader->has_blame() && (first == nullptr || reader->blame_hash() < first->blame_hash()))
        first = reader.get();
    }
    if (first == nullptr) return;
    const std::string hash = first->blame_hash();
    for (; first->has_blame() && first->blame_hash() == hash; first->next_blame()) {
      for (int i = 0; i < first->blame().columns(); ++i) insert.bind_column(i + 1, first->blame(), i);
      insert.run();
    }
    for (const auto& reader : readers) {
      while (reader->has_blame() && reader->blame_hash() == hash) reader->next_blame();
    }
  }
}

// Copies the points and the blame of a single store, which is attached as `input`, to the same bytes as the
// functions above do.
void copy_attached(sqlite::Database& out, const std::vector<std::string>& columns) {
  std::string names;
  for (const std::string& column : columns)
    names += (names.empty() ? "" : ", ") + sqlite::quoted_name(column);
  out.execute(
      fmt::format("INSERT INTO main.points({}) SELECT {} FROM input.points ORDER BY hash", names, names));
  out.execute(
      fmt::format("INSERT INTO main.blame({0}) SELECT {0} FROM input.blame ORDER BY hash, port, bank, by",
                  kBlameColumns));
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
  Readers readers;
  readers.reserve(inputs.size());
  for (const std::string& input : inputs) readers.push_back(std::make_unique<StoreReader>(input));
  if (readers.size() > 1) check_versions(readers);  // Store refuses a second version
  files::OutputFile file(out, store_kind());
  {
    sqlite::Database database(file.aside().path().string(), sqlite::Database::Access::kWrite,
                              sqlite::Database::kBusyTimeout, out);
    if (is_interrupted != nullptr) database.interrupt_if(is_interrupted);
    database.execute(
        "PRAGMA journal_mode = OFF; PRAGMA synchronous = NORMAL; PRAGMA main.locking_mode = EXCLUSIVE");
    if (inputs.size() == 1) {
      database.attach(inputs.front(), "input");
      database.execute("PRAGMA input.mmap_size = 0x40000000");  // pages are read without a system call
    }
    database.execute("BEGIN");
    std::vector<std::string> columns = further_columns(readers);
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
  file.complete();
  for (const char* ending : {"-wal", "-shm"}) fs::remove(out + ending, none);
  file.commit();
} catch (const sqlite::DatabaseError&) {
  throw;
} catch (const std::runtime_error& error) {  // of the file
  throw sqlite::DatabaseError(error.what());
}

}  // namespace stereotlm::explore
