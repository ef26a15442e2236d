#pragma once

#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "platform/config/board_yaml.h"
#include "sw/explore/plan/points.h"
#include "sw/explore/store/database.h"

namespace stereotlm::explore {

// A condition cannot be computed for a point. what() has its place, its name and the reason.
class ConditionError : public std::runtime_error {
 public:
  ConditionError(const std::string& what, const std::string& its_reason)
      : std::runtime_error(what), reason(its_reason) {}
  std::string reason;
};

// Conditions on a point: SQL expressions (SQLite's) over the board's keys as a file has them, such as
// `image.width * image.height <= 307200`. A list or a filter is its text; `ssram.banks` is their number; the
// name is `board.name`; `run.source` and `run.frames` are there too. An absent value is NULL. They depend on
// nothing but the point: no other tables, no parameters, no function of the time or of chance. Not to be used
// across fork().
class Conditions {
 public:
  // Throws std::invalid_argument with the reason if a text is no such expression.
  explicit Conditions(const std::vector<Condition>& conditions);

  // Whether all of them are true. Throws ConditionError.
  bool hold(const std::vector<platform::BoardValue>& values);

 private:
  struct Compiled {
    Condition condition;
    std::unique_ptr<Statement> statement;
  };

  // SQLite's authorizer: called for each function and table that a text names. `conditions` is this object.
  static int authorize(void* conditions, int action, const char* first, const char* second,
                       const char* database, const char* trigger);
  std::unique_ptr<Statement> compile(const std::string& sql);
  std::string reason_of(const DatabaseError& error) const;

  Database database_;
  std::set<std::string> functions_;  // those that a text may call
  std::string refusal_;              // why authorize() has refused the text that is being compiled
  std::vector<Compiled> compiled_;
};

}  // namespace stereotlm::explore
