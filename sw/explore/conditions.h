#pragma once

#include <memory>
#include <string>
#include <vector>

#include "platform/board_yaml.h"
#include "sw/explore/database.h"

namespace stereotlm::explore {

// Conditions on a point: SQL expressions (SQLite's) over the board's keys as a file has them, such as
// `image.width * image.height <= 307200`. A list or a filter is its text; `ssram.banks` is their number; the
// name is `board.name`; `run.source` and `run.frames` are there too. An absent value is NULL. Not to be used
// across fork().
class Conditions {
 public:
  // Throws std::invalid_argument with SQLite's message if a text is no such expression.
  explicit Conditions(const std::vector<std::string>& texts);

  // Whether all of them are true. Throws DatabaseError if SQLite cannot compute one.
  bool hold(const std::vector<platform::BoardValue>& values);

 private:
  Database database_;
  std::vector<std::unique_ptr<Statement>> statements_;
};

}  // namespace stereotlm::explore
