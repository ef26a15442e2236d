#include "sw/explore/plan/points.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>

#include "sw/files/text_forms.h"

namespace stereotlm::explore {
namespace {

using platform::BoardValue;

constexpr const char* kBankCount = "ssram.banks";
// Limits of one computation of a condition.
constexpr int kMostBytes = 20'000;     // of a text
constexpr int kMostSteps = 1'000'000;  // of SQLite's virtual machine, counted in portions
constexpr int kStepsOfPortion = 1000;
// These take as many steps as a number among their arguments says, and cannot be stopped.
constexpr std::array<const char*, 2> kUnlimitedFunctions = {"printf", "format"};

// The names that a condition may use, "table.column", in the order of the parameters.
const std::vector<std::string>& names() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> all;
    for (const platform::Key& key : platform::board_keys()) {
      if (platform::has_value(key)) all.push_back(key.path == "name" ? "board.name" : key.path);
    }
    all.insert(all.end(), {kBankCount, "run.source", "run.frames"});
    return all;
  }();
  return kNames;
}

// The SQL tables for the values of a point: "(SELECT ?1 AS width, ..) AS image, ..". If `has_point` is false,
// all values are NULL.
std::string tables_text(bool has_point) {
  std::vector<std::string> tables;
  std::map<std::string, std::string> columns;
  for (std::size_t i = 0; i < names().size(); ++i) {
    const std::string& name = names()[i];
    const std::size_t dot = name.find('.');
    const std::string table = name.substr(0, dot);
    std::string& list = columns[table];
    if (list.empty()) tables.push_back(table);
    list += fmt::format("{}{} AS \"{}\"", list.empty() ? "" : ", ",
                        has_point ? fmt::format("?{}", i + 1) : "NULL", name.substr(dot + 1));
  }
  std::string text;
  for (const std::string& table : tables) {
    text += fmt::format("{}(SELECT {}) AS {}", text.empty() ? "" : ", ", columns[table], table);
  }
  return text;
}

// The names of the functions whose result depends only on their arguments. The date functions are removed
// from SQLite's list, because their argument may be 'now'.
std::set<std::string> pure_functions(const sqlite::Database& database) {
  sqlite::Statement list(
      database, fmt::format("SELECT name FROM pragma_function_list WHERE flags & {}", SQLITE_DETERMINISTIC));
  std::set<std::string> names;
  while (list.step()) names.insert(list.text(0));
  for (const char* const of_dates :
       {"date", "datetime", "julianday", "strftime", "time", "timediff", "unixepoch"})
    names.erase(of_dates);
  return names;
}

}  // namespace

// Compiles each text twice. First without brackets, at the end of a statement, which refuses unbalanced
// quotes and brackets; SQLite's message then quotes only the text. Then in brackets, which refuses a clause
// behind the expression, such as LIMIT, and a comment that does not end.
Conditions::Conditions(const std::vector<Condition>& conditions)
    : database_("where", sqlite::Database::Access::kMemory), functions_(pure_functions(database_)) {
  sqlite3_set_authorizer(database_.handle(), authorize, this);
  static const std::string kNoPoint = tables_text(false);
  static const std::string kPoint = tables_text(true);
  for (const Condition& condition : conditions) {
    const auto alone = compile(fmt::format("SELECT 1 FROM {} WHERE {}", kNoPoint, condition.text));
    if (sqlite3_bind_parameter_count(alone->handle()) > 0)
      throw std::invalid_argument("parameters such as ? and :x have no value");
    compiled_.push_back({condition, compile(fmt::format("SELECT (({}\n)) FROM {}", condition.text, kPoint))});
  }
  sqlite3_limit(database_.handle(), SQLITE_LIMIT_LENGTH, kMostBytes);
  const auto exceeds_steps = [](void* self) {
    return ++static_cast<Conditions*>(self)->portions_ > kMostSteps / kStepsOfPortion ? 1 : 0;
  };
  sqlite3_progress_handler(database_.handle(), kStepsOfPortion, exceeds_steps, this);
}

std::unique_ptr<sqlite::Statement> Conditions::compile(const std::string& sql) {
  refusal_.clear();
  try {
    return std::make_unique<sqlite::Statement>(database_, sql);
  } catch (const sqlite::DatabaseError& error) {
    throw std::invalid_argument(refusal_.empty() ? reason_of(error) : refusal_);
  }
}

int Conditions::authorize(void* conditions, int action, const char* /*first*/, const char* second,
                          const char* /*database*/, const char* /*trigger*/) {
  auto& self = *static_cast<Conditions*>(conditions);
  if (action == SQLITE_SELECT) return SQLITE_OK;
  if (action == SQLITE_FUNCTION) {
    std::string function = second;
    std::transform(function.begin(), function.end(), function.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const bool is_unlimited = std::find(kUnlimitedFunctions.begin(), kUnlimitedFunctions.end(), function) !=
                              kUnlimitedFunctions.end();
    if (!is_unlimited && self.functions_.count(function) > 0) return SQLITE_OK;
    self.refusal_ =
        function + (is_unlimited ? "() may take any time" : "() depends on more than its arguments");
  } else {
    self.refusal_ = "reads more than the point";
  }
  return SQLITE_DENY;
}

// SQLite's message quotes the text from the error to its end, which may be many lines.
std::string Conditions::reason_of(const sqlite::DatabaseError& error) const {
  const int code = sqlite3_errcode(database_.handle());
  if (code == SQLITE_TOOBIG) return fmt::format("a text must be at most {} bytes", kMostBytes);
  if (code == SQLITE_INTERRUPT) return fmt::format("must be computed within {} steps of SQLite", kMostSteps);
  return platform::short_text(
      std::string(error.what()).substr(database_.path().size() + 2));  // without "where: "
}

bool Conditions::hold(const std::vector<BoardValue>& values) {
  if (compiled_.empty()) return true;
  std::vector<const BoardValue*> given(names().size());
  const auto place_of = [](const std::string& name) {
    return static_cast<std::size_t>(std::find(names().begin(), names().end(), name) - names().begin());
  };
  BoardValue banks{kBankCount, std::int64_t{0}};
  for (const BoardValue& value : values) {
    if (platform::schema_path(value.path) == "ssram.banks.NAME.words") ++std::get<std::int64_t>(banks.value);
    const std::size_t place = place_of(value.path == "name" ? "board.name" : value.path);
    if (place < given.size()) given[place] = &value;
  }
  given[place_of(kBankCount)] = &banks;
  for (const Compiled& compiled : compiled_) {
    sqlite::Statement& statement = *compiled.statement;
    statement.clear_bindings();
    for (std::size_t i = 0; i < given.size(); ++i) {
      if (given[i] != nullptr) statement.bind(static_cast<int>(i) + 1, given[i]->value);
    }
    portions_ = 0;
    try {
      const bool is_true = statement.step() && statement.is_true(0);
      statement.reset();
      if (!is_true) return false;
    } catch (const sqlite::DatabaseError& error) {
      const std::string reason = reason_of(error);
      throw ConditionError(
          fmt::format("{}: {}: {}", compiled.condition.place, compiled.condition.name, reason), reason);
    }
  }
  return true;
}

std::uint64_t frames_of(const PointRun& run, const platform::BoardConfig& board) {
  if (run.frames > 0) return run.frames;
  return platform::allocation_period_frames(board) + (run.camera ? kSteadyFrames : 0);
}

bool may_vary(const std::string& run_key) { return run_key == kSourcePath || run_key == kFramesPath; }

std::string run_key_problem(const std::string& run_key, const platform::YamlNode& value) {
  const bool is_source = value.is_scalar() && (value.text == "preloaded" || value.text == "camera");
  if (run_key == kSourcePath && !is_source)
    return "preloaded (the board alone) or camera (the whole computer)";
  if (run_key == kFramesPath && !kFramesRule.allows(platform::integer_of(value).value_or(0)))
    return kFramesRule.text() + ", the frames of each point";
  if (run_key == kCalibrationPath && (!value.is_scalar() || value.text.empty()))
    return "the file of a calibration, as written by stereotlm calibrate";
  return "";
}

void apply_run_key(const std::string& run_key, const platform::YamlNode& value, PointRun& run) {
  if (run_key == kSourcePath) run.camera = value.text == "camera";
  if (run_key == kFramesPath)
    run.frames = static_cast<std::uint64_t>(platform::integer_of(value).value_or(0));
}

Point make_point(std::uint64_t number, const platform::BoardConfig& board, const PointRun& run) {
  const PointRun its_run = {run.camera, frames_of(run, board), run.calibration};
  Point point = impossible_point(number, to_yaml(board), board, its_run, "");
  point.board = board;
  return point;
}

Point impossible_point(std::uint64_t number, const std::string& yaml, const platform::BoardConfig& asked_for,
                       const PointRun& run, const std::string& reason) {
  Point point;
  point.number = number;
  point.yaml = yaml;
  point.reason = reason;
  point.run = run;
  point.values = values_of(asked_for);
  const char* const source = run.camera ? "camera" : "preloaded";
  point.values.push_back({kSourcePath, source});
  point.values.push_back({kFramesPath, static_cast<std::int64_t>(run.frames)});
  std::string text = fmt::format("{}run: {{source: {}, frames: {}}}\n", yaml, source, run.frames);
  if (!run.calibration.empty()) {
    point.values.push_back({kCalibrationPath, run.calibration});
    text += fmt::format("calibration: {}\n", run.calibration);
  }
  point.hash = files::sha256_hex(text.data(), text.size());
  return point;
}

}  // namespace stereotlm::explore
