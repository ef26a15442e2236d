#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "sw/explore/store/database.h"

namespace stereotlm::explore {

// Reads what a Store holds of points, one at a time. Member functions throw DatabaseError.
class StoredRow {
 public:
  explicit StoredRow(const std::string& path);

  // Goes to a point; false if it is not there.
  bool find(const std::string& hash);

  // Of the point that it stands at. A column that the file does not have, or that is NULL, reads as "" and 0.
  std::string text(const std::string& column) const;
  std::int64_t integer(const std::string& column) const;
  double real(const std::string& column) const;

 private:
  Database database_;
  Statement find_;
  std::map<std::string, int> columns_;
};

}  // namespace stereotlm::explore
