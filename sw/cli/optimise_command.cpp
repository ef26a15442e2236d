#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "platform/config/board_draft.h"
#include "platform/config/board_keys.h"
#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"
#include "platform/yaml/yaml_tree.h"
#include "sw/cli/command.h"
#include "sw/cli/run_options.h"
#include "sw/cli/searching.h"
#include "sw/explore/optimise/key_effects.h"
#include "sw/explore/optimise/search.h"
#include "sw/explore/optimise/search_store.h"
#include "sw/explore/plan/plan.h"
#include "sw/files/text_forms.h"
#include "sw/runs/simulation/board_model.h"
#include "sw/runs/sources/calibration_input.h"

namespace stereotlm::cli {
namespace {

using explore::Search;
using platform::BoardConfig;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostPoints = 40;  // of the front that the text lists

// "90s", "5min", "2h": seconds; nullopt for any other text.
std::optional<double> seconds_of(const std::string& text) {
  static const std::regex kForm(R"((\d{1,9}(?:\.\d{1,9})?)(s|min|h))");
  std::smatch parts;
  if (!std::regex_match(text, parts, kForm)) return std::nullopt;
  return std::stod(parts[1]) * (parts[2] == "s" ? 1 : parts[2] == "min" ? 60 : 3600);
}

struct OptimiseOptions : Options {
  using Options::Options;

  process::FileContents sent = process::sent_files({"plan.yaml"});
  Option plan = Option(this, "PLAN", " ", "A plan as sweep takes it, a preset, or a board file",
                       {required("a plan or a board")});
  Option sets = Option(this, "--set", "KEY=VALUE",
                       "Give a key of the board another value, a YAML flow value; again for further keys", {},
                       Takes::kRepeated);
  Option requirements = Option(this, "--for", "CONDITION",
                               "What a board must keep, such as 'frames_per_second.core >= 60'; again for "
                               "further conditions",
                               {}, Takes::kRepeated);
  Option maxima = Option(this, "--maximise", "FIGURE",
                         "A figure, a key or an SQL expression over them, that is to be large; again for "
                         "further goals",
                         {}, Takes::kRepeated);
  Option minima = Option(this, "--minimise", "FIGURE", "The same, that is to be small", {}, Takes::kRepeated);
  Option banks = Option(this, "--banks", "N", "Place the buffers in at most N banks, in every different way",
                        {number<int>("1..64", [](int n) { return n >= 1 && n <= 64; })});
  Option stripes =
      Option(this, "--stripes", "M", "Each buffer in one bank, or striped over up to M",
             {number<int>("1..16", [](int n) { return n >= 1 && n <= 16; }), goes_with(banks, "N")});
  Option source = Option(this, "--source", "camera|preloaded",
                         "The whole computer, the default where a goal or condition needs it, or the "
                         "core alone; a plan says it in run.source",
                         {one_of({"camera", "preloaded"})});
  Option calibration = Option(this, "--calibration", "F", "The tables, in place of the identity");
  Option why = Option(this, "--why", "KEY=VALUE",
                      "Say why the board of the plan with this value is not the best; again for further keys",
                      {}, Takes::kRepeated);
  Option within = Option(this, "--within", "TIME", "End after 90s, 5min or 2h with the best so far",
                         {valid("a time such as 90s, 5min or 2h",
                                [](const std::string& text) { return seconds_of(text).has_value(); })});
  Option out = Option(this, "--out", "DB",
                      "The database of the answer and its certificate, written or continued (default: none)");
  Option jobs = Option(this, "--jobs", "N", "Worker processes; default: the processors of this machine",
                       {number<unsigned>("1..1024", [](unsigned n) { return n >= 1 && n <= 1024; })});
  JsonOption json{this};

  void check_together(process::Problems& problems) override {
    if (why.is_given() && json.is_given()) problems.add("--why: does not go with --json");
  }
};

// What the command is to find: a plan, and the goals and conditions of plan and options.
struct Question {
  std::optional<explore::Plan> plan;
  explore::SearchWishes wishes;
  std::string text;               // of the plan; of a board the plan that is made from it
  std::string varied;             // of a board: what the plan varies, as text
  std::string board_name;         // a preset or a board file
  std::vector<std::string> sets;  // of that board
  BoardConfig board;              // the board with them
  std::string calibration;        // its path; empty: none
};

// Whether this is the text of a plan: a map with a key that only plans have. A text that is no YAML is taken
// for a board, which reports why.
bool is_plan(const std::string& text) {
  try {
    const platform::YamlNode tree = platform::parse_yaml(text, platform::Place::kBoard);
    constexpr std::array kKeys = {"board", "vary", "zip", "placements", "maximise", "minimise", "require"};
    return tree.is_map() && std::any_of(kKeys.begin(), kKeys.end(),
                                        [&](const char* key) { return tree.find(key) != nullptr; });
  } catch (const std::runtime_error&) {
    return false;
  }
}

// Whether a goal or a requirement names a figure.
bool names(const explore::SearchWishes& wishes, const std::string& figure) {
  const auto has = [&](const explore::Condition& one) { return one.text.find(figure) != std::string::npos; };
  return std::any_of(wishes.goals.begin(), wishes.goals.end(),
                     [&](const auto& goal) { return has(goal.figure); }) ||
         std::any_of(wishes.requirements.begin(), wishes.requirements.end(), has);
}

// Whether a goal or a condition of the options names one of these.
bool names(const OptimiseOptions& options, std::initializer_list<const char*> figures) {
  for (const Option* const option : {&options.requirements, &options.maxima, &options.minima}) {
    for (const std::string& text : option->texts()) {
      for (const char* const figure : figures)
        if (text.find(figure) != std::string::npos) return true;
    }
  }
  return false;
}

// Whether one of them is a figure that only a whole computer has.
bool names_computer(const OptimiseOptions& options) {
  return names(options, {"frames_per_second.steady", "frames_per_second.system", "lost_pixels"});
}

// Makes the plan that varies the usual knobs of a board: those with which the paper's board and its relatives
// differ. A knob that `--set` names keeps its value.
void vary_knobs(const OptimiseOptions& options, Question& question) {
  const BoardConfig& board = question.board;
  const bool has_computer =
      options.source.is_given() ? options.source.text() == "camera" : names_computer(options);
  std::vector<std::string> units = {"all"};
  for (const int folds : {2, 3, 4}) {
    const std::string number = std::to_string((board.matcher.disparities + folds - 1) / folds);
    if (number != units.back() && folds <= board.matcher.disparities) units.push_back(number);
  }
  std::vector<std::pair<std::string, std::string>> knobs = {
      {"matcher.units", fmt::format("{}", fmt::join(units, ", "))},
      {"matcher.rows", "1, 2, 4"},
      {"fpga.lanes", "1, 2, 4"},
      {"matcher.fetch", "column, line_buffer"},
      {"fpga.pixel_cache", "none, word"},
      {"fpga.lane_fifo_slots", "4, 8, 16"}};
  if (board.allocation.left_lut && board.allocation.right_lut)
    knobs.emplace_back("fpga.tables", "separate, joint");
  std::string vary;
  for (const auto& [key, values] : knobs) {
    const bool is_set =
        std::any_of(question.sets.begin(), question.sets.end(),
                    [&key = key](const auto& set) { return set.compare(0, key.size() + 1, key + "=") == 0; });
    if (is_set) continue;
    vary += fmt::format("  {}: [{}]\n", key, values);
    question.varied += fmt::format("{}: {}; ", key, values);
  }
  const std::string banks =
      options.banks.is_given() ? options.banks.text() : std::to_string(board.banks.size());
  question.varied +=
      fmt::format("all placements of the buffers in at most {} bank{}", banks, banks == "1" ? "" : "s");
  question.text = fmt::format("run: {{source: {}{}}}\n{}{}placements: {{banks: {}}}\n",
                              has_computer ? "camera" : "preloaded",
                              has_computer && names(options, {"energy."}) ? ", frames: 120" : "",
                              vary.empty() ? "" : "vary:\n", vary, banks);
}

Question question_of(const OptimiseOptions& options) {
  Question question;
  const std::string& name = options.plan.text();
  const std::string* const sent = sent_content(options.sent, "plan.yaml", name);
  std::optional<std::string> content;
  if (sent != nullptr) content = *sent;
  process::attempt_or_refuse("", [&] {
    if (!content && platform::is_board_file(name)) content = platform::read_text_file(name, "plan or board");
  });
  const bool has_plan = content && is_plan(*content);
  if (has_plan && options.sets.is_given()) process::refuse("--set: of a board; a plan has the section set");
  if (has_plan && options.source.is_given())
    process::refuse("--source: of a board; a plan says it in run.source");
  process::attempt_or_refuse("", [&] {
    question.board_name = name;
    question.sets = options.sets.texts();
    question.calibration = options.calibration.text();
    if (has_plan) {
      question.text = *content;
      question.plan = explore::Plan::load(name, "", &question.text);
      question.board_name = question.plan->board();
      question.board = platform::BoardDraft(question.board_name).read_with_problems().board;
      if (question.calibration.empty()) question.calibration = question.plan->calibration();
    } else {
      platform::BoardDraft draft(name, content ? &*content : nullptr);
      for (const std::string& set : question.sets) draft.set(set);
      question.board = draft.read();
      vary_knobs(options, question);
      const std::string file = platform::to_yaml(question.board);
      question.plan = explore::Plan::load(name, "board.yaml", &question.text, &file);
    }
  });
  question.wishes = question.plan->wishes();
  const auto add = [](const Option& option, const auto& take) {
    for (const std::string& text : option.texts()) take(explore::Condition{text, option.name(), text});
  };
  explore::SearchWishes& wishes = question.wishes;
  add(options.maxima, [&](const auto& text) { wishes.goals.push_back({text, true}); });
  add(options.minima, [&](const auto& text) { wishes.goals.push_back({text, false}); });
  add(options.requirements, [&](const auto& text) { wishes.requirements.push_back(text); });
  if (const auto banks = options.banks.number<int>()) wishes.most_banks = *banks;
  if (const auto parts = options.stripes.number<int>()) wishes.most_parts = *parts;
  return question;
}

explore::SearchStore::Asked asked_of(const Question& question, const std::string& tables) {
  explore::SearchStore::Asked asked = {{"version", process::kVersion},
                                       {"plan", question.text},
                                       {"board", platform::to_yaml(question.plan->base().read())},
                                       {"pictures", question.plan->run().pairs},
                                       {"tables", tables}};
  std::string goals;
  for (const auto& goal : question.wishes.goals)
    goals += fmt::format("{} {}\n", goal.is_maximum ? "maximise" : "minimise", goal.figure.text);
  for (const auto& one : question.wishes.requirements) goals += fmt::format("require {}\n", one.text);
  goals += fmt::format("placements {} {}\n", question.wishes.most_banks, question.wishes.most_parts);
  asked.emplace("goals", goals);
  return asked;
}

std::string value_text(const explore::Range& value) {
  const auto short_number = [](double number) {
    return number == std::floor(number) && std::abs(number) < 1e15 ? fmt::format("{:.0f}", number)
                                                                   : fmt::format("{:.3f}", number);
  };
  if (value.is_exact()) return short_number(value.least);
  return fmt::format("{:.3f} ± {:.3f}", (value.least + value.most) / 2, (value.most - value.least) / 2);
}

// The front as a table: goals, number of boards, and the keys that differ, of the first board of each.
std::string front_text(Search& search, const explore::Plan& plan) {
  std::vector<std::vector<std::string>> rows(1);
  for (const auto& goal : search.wishes().goals) rows[0].push_back(goal.figure.text);
  rows[0].emplace_back("boards");
  const auto& front = search.front();
  const std::size_t listed = std::min(front.size(), kMostPoints);
  std::vector<std::vector<std::string>> values;  // of the keys that vary, in the first boards
  for (std::size_t i = 0; i < front.size(); ++i)
    values.push_back(plan.varied_values(front[i].first.front().combination));
  const std::vector<std::string> keys = plan.varied();
  std::string same;
  std::vector<std::size_t> varied;
  for (std::size_t key = 0; key < keys.size(); ++key) {
    const std::string& first = values.front()[key];
    if (std::all_of(values.begin(), values.end(), [&](const auto& its) { return its[key] == first; })) {
      same += fmt::format("{}{}: {}", same.empty() ? "" : ", ", keys[key], first);
    } else {
      varied.push_back(key);
      rows[0].push_back(keys[key]);
    }
  }
  if (search.wishes().most_banks > 0) rows[0].emplace_back("banks");
  for (std::size_t i = 0; i < listed; ++i) {
    std::vector<std::string>& row = rows.emplace_back();
    for (const explore::Range& value : front[i].values) row.push_back(value_text(value));
    row.push_back(std::to_string(front[i].boards));
    for (const std::size_t key : varied) row.push_back(values[i][key]);
    if (search.wishes().most_banks == 0) continue;
    const std::vector<bool> used = platform::used_banks(*search.board(front[i].first.front()).board);
    row.push_back(std::to_string(std::count(used.begin(), used.end(), true)));
  }
  std::vector<std::size_t> widths(rows[0].size());
  for (const auto& row : rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t i = 0; i < row.size(); ++i)
      line += fmt::format("{}{:>{}}", i == 0 ? "" : "  ", row[i], widths[i]);
    text += line + '\n';
  }
  if (front.size() > listed) text += fmt::format("and {} more\n", front.size() - listed);
  if (!same.empty()) {
    const bool is_one = front.size() == 1;
    const char* const which = is_one && front[0].boards == 1 ? "it has "
                              : is_one                       ? "the first of them has "
                                                             : "the first of each row has ";
    text += paragraph(which, 2, same);
  }
  return text;
}

// The command that explains a board further.
std::string command_of(const Question& question, const BoardConfig& board, const explore::PointRun& run) {
  std::vector<std::string> words = {"stereotlm", "explain", question.board_name};
  const std::vector<std::string> changes = platform::sets_between(question.board, board);
  const auto is_changed = [&](const std::string& set) {
    const std::string path = set.substr(0, set.find('=') + 1);
    return std::any_of(changes.begin(), changes.end(),
                       [&](const std::string& change) { return change.rfind(path, 0) == 0; });
  };
  for (const std::string& set : question.sets) {
    if (!is_changed(set)) words.insert(words.end(), {"--set", set});
  }
  if (!run.camera) words.insert(words.end(), {"--source", "preloaded"});
  if (!question.calibration.empty()) words.insert(words.end(), {"--calibration", question.calibration});
  for (const std::string& set : changes) words.insert(words.end(), {"--set", set});
  return files::shell_command(words);
}

// Why there is no front, whatever the requirements are.
std::string none_left_text(const Question& question) {
  const bool can_lose_pixels = names(question.wishes, "frames_per_second.steady");
  if (question.plan->conditions().empty()) return "every board loses pixels\n";
  return can_lose_pixels ? "where leaves out every board, or those that are left lose pixels\n"
                         : "where leaves out every board\n";
}

// Which requirement no board meets, and what the nearest board has.
std::string empty_text(const Question& question, const explore::BoardModel& model, unsigned processes) {
  static const std::regex kForm(R"(\s*([A-Za-z_][\w.]*)\s*(<=|>=|<|>)\s*(-?\d+(?:\.\d+)?)\s*)");
  constexpr std::size_t kMostBytes = 200;  // std::regex takes stack for each
  std::string text;
  for (const bool alone : {true, false}) {
    for (std::size_t i = 0; i < question.wishes.requirements.size(); ++i) {
      const std::string& condition = question.wishes.requirements[i].text;
      std::smatch parts;
      if (condition.size() > kMostBytes || !std::regex_match(condition, parts, kForm)) continue;
      explore::SearchWishes wishes = question.wishes;
      const bool is_maximum = parts[2].str()[0] == '>';
      explore::Condition goal = question.wishes.requirements[i];
      goal.text = parts[1];
      wishes.goals = {{goal, is_maximum}};
      if (alone) wishes.requirements.clear();
      if (!alone) wishes.requirements.erase(wishes.requirements.begin() + static_cast<std::ptrdiff_t>(i));
      Search search(*question.plan, wishes, model, processes);
      try {
        if (!search.run([](const explore::SearchState&) { return !process::interrupted(); })) return text;
      } catch (const std::runtime_error&) {
        continue;  // it is a word on some boards, and no goal
      }
      if (search.front().empty() && alone) return none_left_text(question);
      if (search.front().empty()) continue;
      const explore::Range best = search.front().front().values.front();
      const double value = is_maximum ? best.most : best.least;
      const double asked = std::stod(parts[3]);
      const bool is_met = parts[2] == ">="   ? value >= asked
                          : parts[2] == "<=" ? value <= asked
                          : is_maximum       ? value > asked
                                             : value < asked;
      if (is_met) continue;
      text += fmt::format("no board{} meets {}: the nearest has {}, which misses by {:.6g}\n",
                          alone ? "" : " that meets the other requirements", condition, value_text(best),
                          std::abs(asked - value));
    }
    if (!text.empty()) return text;
  }
  return question.wishes.requirements.empty() ? none_left_text(question)
                                              : "no board meets all requirements together\n";
}

// Why there is no board.
std::string no_board_text(Search& search) {
  return fmt::format("no combination is a board; the first: {}\n", search.board({0, 0}).reason);
}

std::string judgement_text(const Search::Judgement& judgement, const Search& search, bool is_proven) {
  if (!judgement.refused.empty()) return "is refused: " + judgement.refused + '\n';
  if (!judgement.unmet.empty()) return "does not meet " + judgement.unmet + '\n';
  const auto values_text = [&](const std::vector<explore::Range>& values) {
    std::string text;
    for (std::size_t goal = 0; goal < values.size(); ++goal)
      text += fmt::format("{}{} {}", goal == 0 ? "" : ", ", search.wishes().goals[goal].figure.text,
                          value_text(values[goal]));
    return text;
  };
  const std::string its = (judgement.is_bound ? "can at best have " : "has ") + values_text(judgement.values);
  if (!judgement.dominated_by) {
    const auto& front = search.front();
    const bool is_on_front = std::any_of(front.begin(), front.end(), [&](const explore::FrontPoint& point) {
      return std::equal(point.values.begin(), point.values.end(), judgement.values.begin(),
                        [](const auto& a, const auto& b) { return a.least == b.least && a.most == b.most; });
    });
    const char* const verdict = is_proven && is_on_front ? "is one of the best"
                                : is_proven ? "is no board of the plan, and none of those beats it"
                                            : "is not beaten so far";
    return fmt::format("{}: {}\n", verdict, its);
  }
  const explore::FrontPoint& better = search.front()[*judgement.dominated_by];
  return fmt::format("{}; {} board{} the better {}\n", its, better.boards,
                     better.boards == 1 ? " has" : "s have", values_text(better.values));
}

// Whether the first boards of the rows do not fit their FPGA.
std::string too_large_text(Search& search) {
  std::map<std::string, std::size_t> rows;  // by the figure that is above 100 %
  for (const explore::FrontPoint& point : search.front()) {
    for (const auto& [figure, value] :
         explore::figures_without_simulation(*search.board(point.first.front()).board)) {
      const std::string percent = "_percent";
      const bool is_share = figure.size() > percent.size() &&
                            figure.compare(figure.size() - percent.size(), percent.size(), percent) == 0;
      if (is_share && value.least > 100) ++rows[figure];
    }
  }
  std::string text;
  for (const auto& [figure, count] : rows)
    text += fmt::format("{} too large for the FPGA: require {} <= 100\n",
                        search.front().size() == 1 ? "the first of them is"
                                                   : fmt::format("the first boards of {} rows are", count),
                        figure);
  return text;
}

// How a search has ended.
struct Answer {
  Search& search;
  const Question& question;
  bool is_proven = true;
  std::uint64_t boards = 0;
  bool is_counted = true;
  Search::Impossible impossible = {};
  double seconds = 0;
};

nlohmann::ordered_json document_of(const Answer& answer) {
  Search& search = answer.search;
  nlohmann::ordered_json document = {{"schema", 1},
                                     {"state", answer.is_proven ? "complete" : "interrupted"},
                                     {"boards", answer.boards},
                                     {"combinations", search.combinations()}};
  auto& front = document["front"] = nlohmann::ordered_json::array();
  for (const explore::FrontPoint& point : search.front()) {
    nlohmann::ordered_json one = {{"boards", point.boards}};
    for (std::size_t goal = 0; goal < point.values.size(); ++goal)
      one["values"].push_back({{"figure", search.wishes().goals[goal].figure.text},
                               {"least", point.values[goal].least},
                               {"most", point.values[goal].most}});
    const Search::Board board = search.board(point.first.front());
    one["config"] = platform::to_yaml(*board.board);
    one["command"] = command_of(answer.question, *board.board, board.run);
    front.push_back(std::move(one));
  }
  return document;
}

std::string text_of(const Answer& answer, const explore::BoardModel& model, unsigned processes) {
  Search& search = answer.search;
  const explore::Plan& plan = *answer.question.plan;
  const std::uint64_t combinations = search.combinations();
  std::string text = fmt::format("{} board{} in {} combination{} of values{}\n", answer.boards,
                                 answer.boards == 1 ? "" : "s", combinations, combinations == 1 ? "" : "s",
                                 answer.is_counted ? "" : ", as far as they are counted");
  if (!answer.question.varied.empty())
    text +=
        paragraph(plan.run().camera ? "the whole computer; " : "the core alone; ", 2, answer.question.varied);
  if (answer.impossible.count > 0 && answer.boards > 0)
    text += paragraph(fmt::format("{} combination{} no board; the first: ", answer.impossible.count,
                                  answer.impossible.count == 1 ? " is" : "s are"),
                      2, search.board({answer.impossible.first, 0}).reason);
  if (search.front().empty()) {
    text += !answer.is_proven    ? "no board so far\n"
            : answer.boards == 0 ? no_board_text(search)
                                 : empty_text(answer.question, model, processes);
  } else {
    text += front_text(search, plan);
    if (search.front().size() == 1) {
      const Search::Board board = search.board(search.front().front().first.front());
      text += "the first of them: " + command_of(answer.question, *board.board, board.run) + '\n';
    } else {
      text += "--json has the command of the first board of each row\n";
    }
    text += too_large_text(search);
  }
  text += answer.is_proven
              ? "proven: every other board was simulated, or is ruled out by a bound\n"
              : fmt::format("not proven: {}\n",
                            progress_text(search.state(), search.wishes().goals.size() == 1, answer.seconds));
  const auto& figures = explore::accuracy_figures();
  const bool judges = std::any_of(figures.begin(), figures.end(), [&](const std::string& figure) {
    return names(answer.question.wishes, figure);
  });
  if (judges) return text;
  const std::vector<std::string> varied = plan.varied();
  const bool changes_disparities = std::any_of(varied.begin(), varied.end(), [](const std::string& path) {
    const platform::Key* const key = platform::find_key(path);
    return key != nullptr && explore::effects_of_key(key->path).disparities;
  });
  if (changes_disparities) text += "how good the disparities are is not among the goals\n";
  return text;
}

int optimise(const OptimiseOptions& options) {
  Question question = question_of(options);
  const auto calibration = calibration_of(*question.plan, options.calibration, options.sent);
  const explore::Plan& plan = *question.plan;
  process::Problems problems;
  runs::PointQuality quality(*question.plan, problems);
  problems.check();
  const explore::BoardModel model =
      runs::board_model(calibration ? &calibration->tables : nullptr, std::move(quality));
  const unsigned processes =
      options.jobs.number<unsigned>().value_or(std::max(1U, std::thread::hardware_concurrency()));
  std::unique_ptr<Search> search;
  process::attempt_or_refuse(
      "", [&] { search = std::make_unique<Search>(plan, question.wishes, model, processes); });
  std::optional<platform::BoardDraft> asked;
  process::attempt_or_refuse("--why ", [&] {
    if (options.why.is_given()) asked = plan.base();
    std::vector<platform::Diagnostic> problems_of_values;
    for (const std::string& set : options.why.texts()) asked->set(set);
    if (!asked) return;
    for (const platform::Diagnostic& problem : asked->read_with_problems().problems) {
      if (!problem.is_between_keys) problems_of_values.push_back({"--why", problem.text});
    }
    if (!problems_of_values.empty()) throw platform::BoardError(problems_of_values);
  });
  std::optional<explore::SearchStore> store;
  process::attempt_or_refuse("--out ", [&] {
    if (!options.out.is_given()) return;
    store.emplace(options.out.text(),
                  asked_of(question, calibration ? runs::sha256_of(calibration->tables) : ""));
  });
  process::catch_interrupts();
  const auto start = Clock::now();
  Answer answer = {*search, question};
  if (store && store->is_finished()) {
    search->set_front(store->front(question.wishes.goals.size()));
    answer.boards = store->boards();
    answer.impossible = store->impossible();
  } else {
    answer.is_proven = run_search(*search, store ? &*store : nullptr, question.wishes.goals.size() == 1,
                                  seconds_of(options.within.text()));
    answer.boards = search->state().boards;
    answer.is_counted = search->state().is_counted;
    answer.impossible = search->impossible();
    if (store && answer.is_proven) store->finish(*search);
  }
  answer.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  std::string text =
      options.json.is_given() ? json_text(document_of(answer)) : text_of(answer, model, processes);
  const auto& sets = options.why.texts();
  const bool places = std::none_of(sets.begin(), sets.end(),
                                   [](const std::string& set) { return set.rfind("allocation", 0) == 0; });
  if (asked)
    text +=
        "this board " + judgement_text(search->judge(*asked, plan.run(), places), *search, answer.is_proven);
  process::print(text);
  if (!process::interrupted()) return kDone;
  return interrupted(resume_text(store.has_value()));
}

}  // namespace

void add_optimise(Commands& commands) {
  add_command(
      commands, "optimise", "Find the best boards of a plan, or for a task, and prove it", optimise,
      "A plan of sweep, and in it\n"
      "  placements: {banks: N, stripes: M}   # every different way to place the buffers in at most N "
      "banks,\n"
      "                                       # each in one, or striped over up to M\n"
      "  maximise: [FIGURE, ..]               # figures (stereotlm keys --figures), keys, SQL expressions\n"
      "  minimise: [FIGURE, ..]\n"
      "  require: [CONDITION, ..]             # such as frames_per_second.core >= 25\n"
      "With one goal all boards that tie for the best are found, with several the front: no other board is\n"
      "at least as good in all goals and better in one. Of a BOARD the usual knobs are varied: modules, "
      "rows,\n"
      "lanes, fetch, cache, queues, tables and all placements.\n"
      "A condition on a rate with an uncertainty holds if it holds for all rates that this leaves open.\n"
      "Ctrl-C, or --within, ends the search with the best so far. DB is continued by the same command.");
}

}  // namespace stereotlm::cli
