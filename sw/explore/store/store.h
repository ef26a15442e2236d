#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "platform/config/board_yaml.h"
#include "sw/explore/store/database.h"

namespace stereotlm::explore {

// Stall cycles of one point, as platform::BlameRow has them.
struct StoredBlame {
  std::string port;
  std::string bank;
  std::string by;
  std::int64_t cycles = 0;
};

// What a database holds of one point.
struct StoredPoint {
  std::string hash;
  std::string status;  // "ok"; "impossible": no such board; "failed": the run has ended with an error
  std::string reason;  // unless it is ok
  std::string config;  // the board in full
  std::vector<platform::BoardValue> keys;     // of the board and the run: a column each
  std::vector<platform::BoardValue> figures;  // a column each, with other paths than the keys
  std::vector<StoredBlame> blame;
};

// Results of points in an SQLite file: table `points` with a row and table `blame` with further rows for
// each; table `keys` names the columns of `points` that are keys of a board or a run. A point is there whole
// or not at all, whatever ends the process. Several processes may add points at the same time. Member
// functions throw DatabaseError. Not to be used across fork().
class Store {
 public:
  // Opens the file, or makes it. All its points are of one version of the program.
  Store(const std::string& path, const std::string& version,
        std::chrono::milliseconds busy_timeout = Database::kBusyTimeout);

  // Throws if it has columns of a bank whose name differs from one of these only in case.
  void check_banks(const std::vector<std::string>& banks) const;

  bool has(const std::string& hash);
  // False if the point is there already.
  bool add(const StoredPoint& point);

 private:
  void create();
  void read_columns();
  // Of points with the same further columns, which it adds where they are missing.
  struct Insertion {
    std::vector<std::string> paths;
    std::unique_ptr<Statement> statement;
  };
  Statement& insertion(const StoredPoint& point, const std::vector<const platform::BoardValue*>& values);
  void add_columns(const StoredPoint& point);

  Database database_;
  std::string version_;
  std::set<std::string> columns_;
  std::unique_ptr<Statement> find_;
  std::unique_ptr<Statement> insert_blame_;
  std::vector<Insertion> insertions_;
};

// The file of a Store that nobody writes to. Any number of machines may read it at the same time if it has
// the final form of merge_stores(). Member functions throw DatabaseError. Not to be used across fork().
class FinishedStore {
 public:
  // Throws if it holds points of another version.
  FinishedStore(const std::string& path, const std::string& version);
  bool has(const std::string& hash);

 private:
  Database database_;
  std::optional<Statement> find_;
};

}  // namespace stereotlm::explore
