#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "platform/config/board_yaml.h"
#include "platform/figures/statistics.h"
#include "sw/files/aside.h"
#include "sw/sqlite/database.h"

namespace stereotlm::explore {

// Keys of a point that are not keys of its board.
inline constexpr const char* kSourcePath = "run.source";
inline constexpr const char* kFramesPath = "run.frames";
inline constexpr const char* kCalibrationPath = "run.calibration";
inline constexpr const char* kPairsPath = "run.pairs";
inline constexpr const char* kSyntheticPath = "run.synthetic";
// What a key of the run means; empty for any other path.
std::string run_key_meaning(const std::string& path);

// The contents of stats.json as one row of a database.
struct Figures {
  // Each value has the dotted path of its key. The path of an element of a list has the element's member
  // `name`, as in "banks.bank0.reads". A list of numbers is one text, "[1,2]".
  std::vector<platform::BoardValue> values;
  std::vector<platform::BlameRow> blame;
};

// `document`: as stats::point_document() returns it.
Figures figures_of(const nlohmann::ordered_json& document);

// Everything that a database holds about one point.
struct StoredPoint {
  std::string hash;
  std::string status;  // "ok"; "impossible": there is no such board; "failed": the run ended with an error
  std::string reason;  // for the status, unless it is "ok"
  std::string config;  // the board in full
  std::vector<platform::BoardValue> keys;  // of the board and the run; each has a column
  Figures figures;                         // each value has a column, and a path that no key has
};

// The names of banks are parts of names of columns. SQLite ignores the case of letters there, but names of
// banks are case-sensitive.

// The name with letters A to Z in lower case.
std::string without_case(std::string name);

// Whether two different names become equal without_case().
bool differ_in_case(const std::string& a, const std::string& b);

// The rule that two names that differ_in_case() break as names of banks, as `key = value: rule`: a database
// cannot have a column for each.
std::string bank_names_problem(const std::string& one, const std::string& other);

// Writes results of points to an SQLite file. Table `points` has one row for each point, table `blame`
// several. Table `columns` has the name, unit and meaning of each column of `points`, whether it is a key of
// board or run, and whether points differ in it (`varied`; NULL until merge_stores() has written the file).
// View `plain` is `points` under names that need no quotes, as matcher_window. A point is stored completely
// or not at all, whatever ends the process. Several processes may add points at the same time. Member
// functions throw DatabaseError. Must not be used across fork().
class Store {
 public:
  // Opens the file, or makes it. Throws if it holds points of another version of the program.
  Store(const std::string& path, const std::string& version,
        std::chrono::milliseconds busy_timeout = sqlite::Database::kBusyTimeout);

  // Throws if the file has columns of a bank whose name differs from one of these only in case.
  void check_banks(const std::vector<std::string>& banks) const;

  // Whether the store has the point.
  bool has(const std::string& hash);
  // Returns false, and changes nothing, if the store has the point already.
  bool add(const StoredPoint& point);

 private:
  void create();
  void read_columns();
  sqlite::Statement& insertion(const StoredPoint& point, const std::vector<std::string>& columns);
  void add_columns(const StoredPoint& point);

  sqlite::Database database_;
  std::string version_;
  std::set<std::string> columns_;
  std::optional<sqlite::Statement> find_;
  std::optional<sqlite::Statement> insert_blame_;
  std::map<std::vector<std::string>, sqlite::Statement> insertions_;  // [columns]
};

// The columns of table `points`, in their order. Throws DatabaseError if the file is not a store, or has
// another layout.
std::vector<std::string> store_columns(sqlite::Database& database);

// Reads the points in the file of a Store, one at a time: find() selects a point by its hash. Member
// functions throw DatabaseError. Must not be used across fork(). A file that merge_stores() has written may
// be read by any number of machines at the same time.
class StoredRow {
 public:
  // Throws if the file holds points of another version of the program; an empty version allows any.
  explicit StoredRow(const std::string& path, const std::string& version = "");

  // Selects a point; returns whether the store has it.
  bool find(const std::string& hash);

  // Columns of the selected point. A column that the file does not have, or that is NULL, reads as "" and 0.
  std::string text(const std::string& column) const;
  std::int64_t integer(const std::string& column) const;
  double real(const std::string& column) const;
  std::int64_t lost_pixels() const { return integer("lost_pixels"); }

 private:
  sqlite::Database database_;
  std::optional<sqlite::Statement> find_;
  std::map<std::string, int> columns_;
};

// Writes the points of all `inputs` to the file `store`, in the order of their hashes. The inputs are files
// that a Store or merge_stores() has written. The bytes of the new file depend only on the points. `store`
// may be one of the inputs. If `store` is a symbolic link, the file behind it is replaced. The old file is
// replaced only when the new one is complete and on the disk; its mode and owner are kept. No other process
// may write to `store` meanwhile (see StoreLock). Throws DatabaseError (database.h), also in these cases: two
// inputs have different results of one point; points have different versions; `store` is neither missing,
// empty nor a file of a Store; `is_interrupted` returns true (null: never).
void merge_stores(const std::vector<std::string>& inputs, const std::string& store,
                  const std::function<bool()>& is_interrupted = nullptr);

// Follows the symbolic links in the path of a store to write, and returns the path of the file. Throws
// DatabaseError, also for a file in a result folder of `run`.
std::string behind_links(const std::string& store);

// The file of a store was removed or replaced while it was in use. The points that were added to it are lost.
class StoreGone : public sqlite::DatabaseError {
 public:
  explicit StoreGone(const std::string& store)
      : sqlite::DatabaseError(store + ": was removed or replaced while in use: its points are lost") {}
};

// Reserves a store for one writer. The merge at the end of a sweep replaces the file, and would lose points
// that another process added during the sweep. The operating system holds the lock: it is released when this
// object is destroyed, or when this process and all its forks have ended. It does not stop readers.
class StoreLock {
 public:
  // How long the constructor waits: the processes of a sweep that was killed take a moment to end.
  static constexpr std::chrono::milliseconds kBusyTimeout{3000};

  // Makes an empty file if there is none. The destructor, or the end of this process, removes this file if it
  // is still empty. Throws DatabaseError, also if another process holds the lock.
  explicit StoreLock(const std::string& store, std::chrono::milliseconds busy_timeout = kBusyTimeout);
  ~StoreLock();
  StoreLock(const StoreLock&) = delete;
  StoreLock& operator=(const StoreLock&) = delete;

  // Throws StoreGone unless the path still leads to the locked file.
  void check() const;

 private:
  std::string store_;
  std::string path_;  // of the file behind all symbolic links
  int file_ = -1;
  bool is_made_ = false;  // this lock has made the file
  std::optional<files::Remover> remover_;
};

}  // namespace stereotlm::explore
