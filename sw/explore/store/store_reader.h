#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

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

}  // namespace stereotlm::explore
