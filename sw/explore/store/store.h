#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "platform/config/board_yaml.h"
#include "sw/sqlite/database.h"

namespace stereotlm::explore {

// Stall cycles of one point, with the members of platform::BlameRow.
struct StoredBlame {
  std::string port;
  std::string bank;
  std::string by;
  std::int64_t cycles = 0;
};

// Everything that a database holds about one point.
struct StoredPoint {
  std::string hash;
  std::string status;  // "ok"; "impossible": there is no such board; "failed": the run ended with an error
  std::string reason;  // for the status, unless it is "ok"
  std::string config;  // the board in full
  std::vector<platform::BoardValue> keys;     // of the board and the run; each has a column
  std::vector<platform::BoardValue> figures;  // each has a column, and a path that no key has
  std::vector<StoredBlame> blame;
};

// Writes results of points to an SQLite file. Table `points` has one row for each point, table `blame`
// several, and table `keys` lists the columns of `points` that hold keys of a board or a run. A point is
// stored completely or not at all, whatever ends the process. Several processes may add points at the same
// time. Member functions throw DatabaseError. Must not be used across fork().
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
  // A prepared INSERT for points that have these columns behind kFirstColumns.
  struct Insertion {
    std::vector<std::string> paths;
    std::unique_ptr<sqlite::Statement> statement;
  };
  // The insertion for a point with these values. Adds the columns that the table lacks.
  sqlite::Statement& insertion(const StoredPoint& point,
                               const std::vector<const platform::BoardValue*>& values);
  void add_columns(const StoredPoint& point);

  sqlite::Database database_;
  std::string version_;
  std::set<std::string> columns_;
  std::unique_ptr<sqlite::Statement> find_;
  std::unique_ptr<sqlite::Statement> insert_blame_;
  std::vector<Insertion> insertions_;
};

}  // namespace stereotlm::explore
