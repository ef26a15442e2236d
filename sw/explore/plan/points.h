#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "platform/config/board_keys.h"
#include "platform/config/board_yaml.h"
#include "platform/yaml/yaml_tree.h"
#include "sw/explore/store/store.h"
#include "sw/sqlite/database.h"

namespace stereotlm::explore {

// The parts of a point that are not its board.
struct PointRun {
  bool camera = false;       // simulates the whole computer, else the board alone (preloaded)
  std::uint64_t frames = 0;  // 0: the default of the source, see frames_of()
  std::string calibration;   // SHA-256 of the tables; empty: the tables are the identity
  // The pictures from which the accuracy of a point is computed; at most one of them is not empty.
  std::string pairs = {};      // SHA-256 of the files and scales of the pairs
  std::string synthetic = {};  // seeds of made scenes, "[1, 2]"
};

// The least window of the steady rate (platform::SteadyRate) in a run of the default length. It is whole
// turns of lists of 1, 2 or 3 buffers.
inline constexpr std::uint64_t kSteadyFrames = 12;
// The same for the runs of `allocate`, whose rates mostly differ by less than a percent.
inline constexpr std::uint64_t kSearchSteadyFrames = 10 * kSteadyFrames;

// The number of frames of a run: run.frames if it is not 0. The default for the board alone is one turn of
// the allocation's lists. If no frame affects the next, one turn has the same frame rate as any number of
// turns. The default for the whole computer is one turn more than kSteadyFrames.
std::uint64_t frames_of(const PointRun& run, const platform::BoardConfig& board);

// Whether the points of a plan may differ in this key of the run.
bool may_vary(const std::string& run_key);

// The rule that the value breaks as a value of this key of the run; empty if the value is valid.
std::string run_key_problem(const std::string& run_key, const platform::YamlNode& value);
inline constexpr platform::IntegerRule kFramesRule = {1, 1'000'000};

// Sets the member of `run` for kSourcePath or kFramesPath to the value, which is valid. Ignores other keys.
void apply_run_key(const std::string& run_key, const platform::YamlNode& value, PointRun& run);

// One point: a board and its run; or the reason for which there is no such board.
struct Point {
  std::uint64_t number = 0;  // its place in Points, from 0
  std::string hash;          // SHA-256 of the board in full and of the run, 64 hexadecimal digits
  std::optional<platform::BoardConfig> board;  // nullopt if the point is impossible
  std::string yaml;    // the board in full, as config.yaml has it, also of an impossible point
  std::string reason;  // of an impossible point: every rule that it breaks
  PointRun run;        // if the point has a board, `frames` is frames_of()
  std::vector<platform::BoardValue> values;  // of every key of the board and of the run
};

// Makes the point of a board.
Point make_point(std::uint64_t number, const platform::BoardConfig& board, const PointRun& run);

// Makes an impossible point. `yaml` and `asked_for`: the combination of values; `reason`: why there is no
// such board.
Point impossible_point(std::uint64_t number, const std::string& yaml, const platform::BoardConfig& asked_for,
                       const PointRun& run, const std::string& reason);

// An SQL expression (see Conditions). A point for which it is not true is left out.
struct Condition {
  std::string text;
  std::string place;  // "plan.yaml:3:9"
  std::string name;   // for messages: "where = image.width > 4"
};

// A name in an SQL text, with all its dots; words of SQL are names too.
struct NamePlace {
  std::size_t begin = 0;
  std::size_t end = 0;
  bool is_quoted = false;  // or in [brackets] or `backticks`
};
// All but those in strings and comments.
std::vector<NamePlace> names_at(const std::string& text);

// What to say of a name of keys that are no single value of a board, such as those of banks; else empty.
std::string no_value_remark(const std::string& name);

// A sequence of points. Each point is made from its number when it is needed, and not stored.
struct Points {
  std::uint64_t size = 0;
  std::function<Point(std::uint64_t number)> point;  // number: 0..size-1
  // A point is left out unless all conditions are true for it.
  std::vector<Condition> conditions = {};
};

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
// use other tables, parameters, or functions of time or chance. The lengths of texts and the steps of SQLite
// are limited. Must not be used across fork().
class Conditions {
 public:
  // `figures`: further names that the texts may use, beside the keys. Throws std::invalid_argument with the
  // reason if a text is not such an expression.
  explicit Conditions(const std::vector<Condition>& conditions, const std::vector<std::string>& figures = {});

  // Whether all conditions are true. `values`: of keys, and of `figures`. Throws ConditionError.
  bool hold(const std::vector<platform::BoardValue>& values);
  // The value of the first expression on a board; nullopt: NULL. `values`: of the run, and of `figures`. The
  // last value is remembered. Throws ConditionError.
  std::optional<double> number(const platform::BoardConfig& board, std::vector<platform::BoardValue> values);

 private:
  struct Compiled {
    Condition condition;
    std::unique_ptr<sqlite::Statement> statement;
  };

  // SQLite calls this authorizer for each function and table that a text names. `conditions`: this object.
  static int authorize(void* conditions, int action, const char* first, const char* second,
                       const char* database, const char* trigger);
  std::unique_ptr<sqlite::Statement> compile(const std::string& sql);
  std::string reason_of(const sqlite::DatabaseError& error) const;
  void bind(const std::vector<platform::BoardValue>& values);
  // Calls `read` with the row of the statement.
  template <typename Read>
  auto computed(const Compiled& compiled, const Read& read);

  sqlite::Database database_;
  std::map<std::string, int> parameters_;   // [name whose column occurs in a text]
  std::vector<const platform::Key*> keys_;  // those of them that are keys of a board
  std::set<std::string> functions_;         // names of the functions that a text may call
  std::string refusal_;  // the reason for which authorize() refused the text being compiled
  std::vector<Compiled> compiled_;
  int portions_ = 0;  // of the steps of this computation
  std::optional<std::pair<std::vector<platform::BoardValue>, std::optional<double>>> last_;  // of number()
};

}  // namespace stereotlm::explore
