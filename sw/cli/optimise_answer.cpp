#include "sw/cli/optimise_answer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <stdexcept>
#include <utility>
#include <vector>

#include "platform/config/board_keys.h"
#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"
#include "sw/cli/command.h"
#include "sw/cli/searching.h"
#include "sw/explore/optimise/key_effects.h"
#include "sw/files/text_forms.h"

namespace stereotlm::cli {
namespace {

using explore::Search;
using platform::BoardConfig;

constexpr std::size_t kMostPoints = 40;  // of the front that the text lists

// Whether a goal or a requirement names a figure.
bool names(const explore::SearchWishes& wishes, const std::string& figure) {
  const auto has = [&](const explore::Condition& one) { return one.text.find(figure) != std::string::npos; };
  return std::any_of(wishes.goals.begin(), wishes.goals.end(),
                     [&](const auto& goal) { return has(goal.figure); }) ||
         std::any_of(wishes.requirements.begin(), wishes.requirements.end(), has);
}

std::string value_text(const explore::Range& value) {
  const auto short_number = [](double number) {
    return number == std::floor(number) && std::abs(number) < 1e15 ? fmt::format("{:.0f}", number)
                                                                   : fmt::format("{:.3f}", number);
  };
  if (value.is_exact()) return short_number(value.least);
  const double half = (value.most - value.least) / 2;
  int decimals = 3;
  while (decimals < 12 && half < 0.5 * std::pow(10, -decimals)) ++decimals;
  return fmt::format("{:.{}f} ± {:.{}f}", (value.least + value.most) / 2, decimals, half, decimals);
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
  const std::vector<std::string> varied = question.plan->varied();
  const bool can_lose_pixels =
      question.plan->run().camera ||
      std::count(varied.begin(), varied.end(), std::string(explore::kSourcePath)) > 0;
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
      const double asked = std::stod(parts[3]);
      const auto meets = [&](double value) {
        return parts[2] == ">="   ? value >= asked
               : parts[2] == "<=" ? value <= asked
               : is_maximum       ? value > asked
                                  : value < asked;
      };
      const double value = is_maximum ? best.most : best.least;
      if (meets(best.least) && meets(best.most)) continue;
      if (meets(value)) {
        text += fmt::format("no board{} surely meets {}: the nearest has {}, which leaves it open\n",
                            alone ? "" : " that meets the other requirements", condition, value_text(best));
        continue;
      }
      text += fmt::format("no board{} meets {}: the nearest has {}, which misses by {:.6g}\n",
                          alone ? "" : " that meets the other requirements", condition, value_text(best),
                          std::abs(asked - value));
    }
    if (!text.empty()) return text;
  }
  return question.wishes.requirements.empty() ? none_left_text(question)
         : question.wishes.requirements.size() == 1
             ? fmt::format("no board meets {}\n", question.wishes.requirements.front().text)
             : "no board meets all requirements together\n";
}

// Why there is no board.
std::string no_board_text(Search& search) {
  return fmt::format("no combination is a board; the first: {}\n", search.board({0, 0}).reason);
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

}  // namespace

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
  const bool has_board = answer.impossible.count < combinations;
  if (answer.impossible.count > 0 && has_board)
    text += paragraph(fmt::format("{} combination{} no board; the first: ", answer.impossible.count,
                                  answer.impossible.count == 1 ? " is" : "s are"),
                      2, search.board({answer.impossible.first, 0}).reason);
  if (search.front().empty()) {
    text += !answer.is_proven ? "no board so far\n"
            : !has_board      ? no_board_text(search)
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

}  // namespace stereotlm::cli
