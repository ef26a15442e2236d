#pragma once

#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "platform/config/board_yaml.h"
#include "sw/explore/plan/points.h"
#include "sw/sqlite/database.h"

namespace stereotlm::explore {

// A condition cannot be computed for a point. what() has the place of the condition, its name and the reason;
// `reason` is the reason alone.
class ConditionError : public std::runtime_error {
 public:
  ConditionError(const std::string& what, const std::string& its_reason)
      : std::runtime_error(what), reason(its_reason) {}
  std::string reason;
};

// The conditions of a plan, computed for one point after another. A condition is an SQL expression of SQLite
// over the keys of the board, such as `image.width * image.height <= 307200`. The value of a list or a filter
// is its text. `ssram.banks` is the number of banks, `board.name` the name of the board; `run.source` and
// `run.frames` are also defined. An absent value is NULL. A condition depends only on the point: it cannot
// use other tables, parameters, or functions of time or chance. Its texts and its steps are limited. Must
// not be used across fork().
class Conditions {
 public:
  // Throws std::invalid_argument with the reason if a text is not such an expression.
  explicit Conditions(const std::vector<Condition>& conditions);

  // Whether all conditions are true. Throws ConditionError.
  bool hold(const std::vector<platform::BoardValue>& values);

 private:
  struct Compiled {
    Condition condition;
    std::unique_ptr<sqlite::Statement> statement;
  };

  // SQLite's authorizer: SQLite calls it for each function and table that a text names. `conditions` is this
  // object.
  static int authorize(void* conditions, int action, const char* first, const char* second,
                       const char* database, const char* trigger);
  // SQLite's progress handler. Returns 1, which ends the computation, if it has too many steps.
  static int exceeds_steps(void* conditions);
  std::unique_ptr<sqlite::Statement> compile(const std::string& sql);
  std::string reason_of(const sqlite::DatabaseError& error) const;

  sqlite::Database database_;
  std::set<std::string> functions_;  // names of the functions that a text may call
  std::string refusal_;              // the reason for which authorize() refused the text being compiled
  std::vector<Compiled> compiled_;
  int portions_ = 0;  // of the steps of this computation
};

}  // namespace stereotlm::explore
