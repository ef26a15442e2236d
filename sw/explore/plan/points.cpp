#include "sw/explore/plan/points.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <string_view>

#include "sw/files/text_forms.h"
#include "sw/stats/figures.h"

namespace stereotlm::explore {
namespace {

using platform::BoardValue;

constexpr const char* kBankCount = "ssram.banks";
// Limits of one computation of a condition.
constexpr int kMostBytes = 20'000;     // of a text
constexpr int kMostSteps = 1'000'000;  // of SQLite's virtual machine, counted in portions
constexpr int kStepsOfPortion = 1000;
// These take as many steps as a number among their arguments says, and cannot be stopped.
constexpr std::array<std::string_view, 2> kUnlimitedFunctions = {"printf", "format"};

// The name of a key in a condition.
std::string parameter_of(const std::string& path) { return path == "name" ? "board.name" : path; }

// The names that a condition may use, "table.column".
const std::set<std::string>& names_of_conditions() {
  static const std::set<std::string> kNames = [] {
    std::set<std::string> all = {kBankCount, kSourcePath, kFramesPath};
    for (const platform::Key& key : platform::board_keys()) {
      if (platform::has_value(key)) all.insert(parameter_of(key.path));
    }
    return all;
  }();
  return kNames;
}

// The same expression with pci."load.burst_words" for pci.load.burst_words.
std::string with_columns(const std::string& text) {
  std::string result;
  std::size_t done = 0;
  for (const NamePlace& name : names_at(text)) {
    const std::size_t dot = text.find('.', name.begin);
    const bool is_long = dot < name.end && text.find('.', dot + 1) < name.end;
    if (name.is_quoted || !is_long || text[name.end - 1] == '.') continue;
    result +=
        fmt::format("{}\"{}\"", text.substr(done, dot + 1 - done), text.substr(dot + 1, name.end - dot - 1));
    done = name.end;
  }
  return result + text.substr(done);
}

// The column of a name "table.column".
std::string column_of(const std::string& name) { return name.substr(name.find('.') + 1); }

// The SQL tables for the values of a point: " FROM (SELECT ?1 AS width, ..) AS image, ..". If `has_point` is
// false, all values are NULL.
std::string tables_text(const std::map<std::string, int>& parameters, bool has_point) {
  std::map<std::string, std::string> columns;  // [table]
  for (const auto& [name, number] : parameters) {
    std::string& list = columns[name.substr(0, name.find('.'))];
    list += fmt::format("{}{} AS \"{}\"", list.empty() ? "" : ", ",
                        has_point ? fmt::format("?{}", number) : "NULL", column_of(name));
  }
  std::string text;
  for (const auto& [table, list] : columns)
    text += fmt::format("{}(SELECT {}) AS {}", text.empty() ? " FROM " : ", ", list, table);
  return text;
}

// A reason of SQLite; behind an unknown name the one that was probably meant.
std::string with_nearest(const std::string& reason) {
  const std::string unknown = "no such column: ";
  if (reason.rfind(unknown, 0) != 0) return reason;
  const std::string name = reason.substr(unknown.size());
  if (names_of_conditions().count(name) > 0) return reason + "; write the key without quotes";
  if (stats::find_figure(name) != nullptr)
    return reason + "; a figure is not known before the point is simulated";
  if (const std::string remark = no_value_remark(name); !remark.empty()) return reason + remark;
  const std::set<std::string>& names = names_of_conditions();
  const std::string nearest = platform::nearest_path(name, {names.begin(), names.end()});
  return nearest.empty() ? reason : reason + "; nearest: " + nearest;
}

// The names of the functions whose result depends only on their arguments. Left out are the date functions,
// whose argument may be 'now', and kUnlimitedFunctions.
std::set<std::string> allowed_functions(const sqlite::Database& database) {
  const std::vector<std::string> names = database.texts(fmt::format(
      "SELECT name FROM pragma_function_list WHERE flags & {} AND name NOT IN ('date', 'datetime', "
      "'julianday', 'strftime', 'time', 'timediff', 'unixepoch', '{}')",
      SQLITE_DETERMINISTIC, fmt::join(kUnlimitedFunctions, "', '")));
  return {names.begin(), names.end()};
}

}  // namespace

std::vector<NamePlace> names_at(const std::string& text) {
  const auto is_of_name = [&](std::size_t place) {
    const auto c = static_cast<unsigned char>(text[place]);
    return std::isalnum(c) != 0 || c == '_' || c == '.';
  };
  // Where a part that begins here ends.
  const auto behind = [&](std::size_t place, std::string_view end) {
    const std::size_t found = text.find(end, place);
    return found == std::string::npos ? text.size() : found + end.size();
  };
  std::vector<NamePlace> names;
  char quote = '\0';  // the end of the quotes in which `at` is
  for (std::size_t at = 0; at < text.size();) {
    const char c = text[at];
    if (is_of_name(at)) {
      const std::size_t begin = at;
      while (at < text.size() && is_of_name(at)) ++at;
      if (std::isdigit(static_cast<unsigned char>(c)) == 0) names.push_back({begin, at, quote != '\0'});
    } else if (quote != '\0') {
      if (c == quote) quote = '\0';
      ++at;
    } else if (c == '\'') {
      at = behind(at + 1, "'");
    } else if (text.compare(at, 2, "--") == 0) {
      at = behind(at, "\n");
    } else if (text.compare(at, 2, "/*") == 0) {
      at = behind(at + 2, "*/");
    } else {
      if (c == '"' || c == '`') quote = c;
      if (c == '[') quote = ']';
      ++at;
    }
  }
  return names;
}

std::string no_value_remark(const std::string& name) {
  const platform::Key* const key = platform::find_key(platform::schema_path(name));
  if (key == nullptr || platform::has_value(*key)) return "";
  return key->path.rfind("ssram.", 0) == 0
             ? "; a key of banks: of these a condition knows only their number, ssram.banks"
             : "; no single value: name a key below it, or the one of which it is a part";
}

// Compiles each text twice. First without brackets, at the end of a statement, which refuses unbalanced
// quotes and brackets; SQLite's message then quotes only the text. Then in brackets, which refuses a clause
// behind the expression, such as LIMIT, and a comment that does not end.
Conditions::Conditions(const std::vector<Condition>& conditions, const std::vector<std::string>& figures)
    : database_("where", sqlite::Database::Access::kMemory), functions_(allowed_functions(database_)) {
  sqlite3_set_authorizer(database_.handle(), authorize, this);
  std::string all;
  for (const Condition& condition : conditions) all += without_case(condition.text) + '\n';
  const auto add = [&](const std::string& name) {
    const bool may_be_used = all.find(without_case(column_of(name))) != std::string::npos;
    if (may_be_used) parameters_.emplace(name, static_cast<int>(parameters_.size()) + 1);
  };
  for (const std::string& name : names_of_conditions()) add(name);
  for (const std::string& figure : figures) add(figure);
  for (const platform::Key& key : platform::board_keys()) {
    if (platform::has_value(key) && parameters_.count(parameter_of(key.path)) > 0) keys_.push_back(&key);
  }
  const std::string no_point = tables_text(parameters_, false);
  const std::string point = tables_text(parameters_, true);
  for (const Condition& condition : conditions) {
    const std::string expression = with_columns(condition.text);
    const auto alone = compile(fmt::format("SELECT 1{} WHERE {}", no_point, expression));
    if (sqlite3_bind_parameter_count(alone->handle()) > 0)
      throw std::invalid_argument("parameters such as ? and :x have no value");
    compiled_.push_back({condition, compile(fmt::format("SELECT (({}\n)){}", expression, point))});
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
  const std::string function = action == SQLITE_FUNCTION ? without_case(second) : "";
  if (action == SQLITE_SELECT || self.functions_.count(function) > 0) return SQLITE_OK;
  const bool is_unlimited = std::count(kUnlimitedFunctions.begin(), kUnlimitedFunctions.end(), function) > 0;
  self.refusal_ = function.empty() ? "reads more than the point"
                  : is_unlimited   ? function + "() may take any time"
                                   : function + "() depends on more than its arguments";
  return SQLITE_DENY;
}

// SQLite's message quotes the text from the error to its end, which may be many lines.
std::string Conditions::reason_of(const sqlite::DatabaseError& error) const {
  const int code = sqlite3_errcode(database_.handle());
  if (code == SQLITE_TOOBIG) return fmt::format("a text must be at most {} bytes", kMostBytes);
  if (code == SQLITE_INTERRUPT) return fmt::format("must be computed within {} steps of SQLite", kMostSteps);
  return with_nearest(platform::short_text(
      std::string(error.what()).substr(database_.path().size() + 2)));  // without "where: "
}

void Conditions::bind(const std::vector<BoardValue>& values) {
  for (const Compiled& compiled : compiled_) compiled.statement->clear_bindings();
  const auto bind_one = [this](const std::string& name, const auto& value) {
    const auto parameter = parameters_.find(name);
    if (parameter == parameters_.end()) return;
    for (const Compiled& compiled : compiled_) compiled.statement->bind(parameter->second, value);
  };
  const bool counts_banks = parameters_.count(kBankCount) > 0;
  std::int64_t banks = 0;
  for (const BoardValue& value : values) {
    if (counts_banks && platform::schema_path(value.path) == "ssram.banks.NAME.words") ++banks;
    bind_one(parameter_of(value.path), value.value);
  }
  if (banks > 0) bind_one(kBankCount, banks);
}

template <typename Read>
auto Conditions::computed(const Compiled& compiled, const Read& read) {
  portions_ = 0;
  try {
    sqlite::Statement& statement = *compiled.statement;
    const auto value = read(statement);
    statement.reset();
    return value;
  } catch (const sqlite::DatabaseError& error) {
    const std::string reason = reason_of(error);
    throw ConditionError(fmt::format("{}: {}: {}", compiled.condition.place, compiled.condition.name, reason),
                         reason);
  }
}

bool Conditions::hold(const std::vector<BoardValue>& values) {
  if (compiled_.empty()) return true;
  bind(values);
  return std::all_of(compiled_.begin(), compiled_.end(), [this](const Compiled& compiled) {
    return computed(compiled, [](sqlite::Statement& row) { return row.step() && row.is_true(0); });
  });
}

std::optional<double> Conditions::number(const platform::BoardConfig& board, std::vector<BoardValue> values) {
  for (const platform::Key* const key : keys_) {
    if (has_key(board, *key)) values.push_back({key->path, value_of(*key, board)});
  }
  if (parameters_.count(kBankCount) > 0)
    values.push_back({kBankCount, static_cast<std::int64_t>(board.banks.size())});
  const auto is_same = [](const BoardValue& a, const BoardValue& b) {
    return a.path == b.path && a.value == b.value;
  };
  if (last_ && std::equal(values.begin(), values.end(), last_->first.begin(), last_->first.end(), is_same))
    return last_->second;
  bind(values);
  const auto number = computed(compiled_.front(), [](sqlite::Statement& row) {
    const int type = row.step() ? sqlite3_column_type(row.handle(), 0) : SQLITE_NULL;
    const bool is_number = type == SQLITE_INTEGER || type == SQLITE_FLOAT;
    return is_number ? std::optional<double>(row.real(0)) : std::nullopt;
  });
  last_.emplace(std::move(values), number);
  return number;
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
  PointRun its_run = run;
  its_run.frames = frames_of(run, board);
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
  for (const auto& [path, value] :
       {std::pair(kCalibrationPath, &run.calibration), std::pair(kPairsPath, &run.pairs),
        std::pair(kSyntheticPath, &run.synthetic)}) {
    if (value->empty()) continue;
    point.values.push_back({path, *value});
    text += fmt::format("{}: {}\n", std::string(path).substr(4), *value);  // without "run."
  }
  point.hash = files::sha256_hex(text.data(), text.size());
  return point;
}

}  // namespace stereotlm::explore
