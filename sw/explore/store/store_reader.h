#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sw/sqlite/database.h"

namespace stereotlm::explore {

// Classes that read the file of a Store. Their member functions throw DatabaseError. They must not be used
// across fork().

// A store that no process writes to, as a set of points. Once merge_stores() has written the file, any number
// of machines may read it at the same time.
class FinishedStore {
 public:
  // Throws if the file holds points of another version of the program.
  FinishedStore(const std::string& path, const std::string& version);
  bool has(const std::string& hash);

 private:
  sqlite::Database database_;
  std::optional<sqlite::Statement> find_;
};

// Reads one point at a time, which it finds by its hash.
class StoredRow {
 public:
  explicit StoredRow(const std::string& path);

  // Selects a point; returns whether the store has it.
  bool find(const std::string& hash);

  // Columns of the selected point. A column that the file does not have, or that is NULL, reads as "" and 0.
  std::string text(const std::string& column) const;
  std::int64_t integer(const std::string& column) const;
  double real(const std::string& column) const;

 private:
  sqlite::Database database_;
  sqlite::Statement find_;
  std::map<std::string, int> columns_;
};

// Reads all points in the order of their hashes; merge_stores() uses it.
class StoreReader {
 public:
  // Selects the first point.
  explicit StoreReader(const std::string& path);

  const std::string& path() const { return database_.path(); }
  const std::vector<std::string>& columns() const { return columns_; }  // of `points`
  const std::vector<std::string>& keys() const { return keys_; }        // the columns that hold keys
  std::vector<std::string> versions() const;                            // of the program, of all points

  bool at_end() const { return !has_point_; }
  const std::string& hash() const { return hash_; }  // of the selected point
  const sqlite::Statement& point() const { return *points_; }
  void next();  // selects the next point
  // Everything that the file holds about the selected point, as one text to compare: the values of these
  // columns, and the blame.
  std::string whole_text(const std::vector<std::string>& columns);

  // Selects the next row of the blame of all points, in the order of the hashes. The first call selects the
  // first row.
  void next_blame() { has_blame_ = blame_->step(); }
  bool has_blame() const { return has_blame_; }
  const sqlite::Statement& blame() const { return *blame_; }
  std::string blame_hash() const { return blame_->text(0); }

 private:
  sqlite::Database database_;
  std::vector<std::string> columns_;
  std::vector<std::string> keys_;
  std::optional<sqlite::Statement> points_;
  std::optional<sqlite::Statement> blame_of_point_;
  std::optional<sqlite::Statement> blame_;
  bool has_point_ = false;
  bool has_blame_ = false;
  std::string hash_;
};

}  // namespace stereotlm::explore
