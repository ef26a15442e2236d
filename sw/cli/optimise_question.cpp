#include "sw/cli/optimise_question.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <regex>
#include <stdexcept>
#include <utility>

#include "platform/config/board_draft.h"
#include "platform/config/board_keys.h"
#include "platform/config/board_yaml.h"
#include "platform/yaml/yaml_tree.h"
#include "sw/cli/run_options.h"

namespace stereotlm::cli {
namespace {

using platform::BoardConfig;

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

}  // namespace

std::optional<double> seconds_of(const std::string& text) {
  static const std::regex kForm(R"((\d{1,9}(?:\.\d{1,9})?)(s|min|h))");
  std::smatch parts;
  if (!std::regex_match(text, parts, kForm)) return std::nullopt;
  return std::stod(parts[1]) * (parts[2] == "s" ? 1 : parts[2] == "min" ? 60 : 3600);
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
  if (options.stripes.is_given() && wishes.most_banks == 0)
    process::refuse("--stripes: goes with --banks N, or with placements in the plan");
  if (const std::size_t banks = question.board.banks.size();
      !has_plan && wishes.most_banks > static_cast<int>(banks))
    process::refuse(most_banks_text(wishes.most_banks, banks));
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

}  // namespace stereotlm::cli
