#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>

#include "platform/config/board_keys.h"
#include "platform/config/board_yaml.h"
#include "platform/yaml/yaml_tree.h"
#include "sw/explore/plan/conditions.h"
#include "sw/explore/plan/plan.h"
#include "sw/explore/plan/plan_findings.h"
#include "sw/explore/store/bank_names.h"

namespace stereotlm::explore {

using platform::Diagnostic;
using platform::Place;
using platform::YamlNode;

namespace {

constexpr std::uint64_t kMostPoints = std::uint64_t{1} << 62U;
constexpr std::size_t kMostConditions = 1000;

}  // namespace

// Reads one plan, and collects everything that is wrong with it.
class PlanReader {
 public:
  PlanReader(const std::string& path, const std::string& board) : plan_(path, board), findings_(path) {}

  Plan read() {
    YamlNode tree;
    try {
      tree = platform::parse_yaml(platform::read_text_file(plan_.path_, "plan"), Place::kBoard);
    } catch (const platform::YamlError& error) {
      findings_.report(error.place, error.what());
      fail();
    }
    if (const Entries* sections = findings_.read_map(
            "", tree, {"board", "run", "set", "vary", "zip", "where", "sample"}, "a plan is a map")) {
      read_base(*sections, tree);
      if (const YamlNode* vary = find(*sections, "vary")) read_vary(*vary);
      if (const YamlNode* zip = find(*sections, "zip")) read_zip(*zip);
      if (const YamlNode* where = find(*sections, "where")) read_conditions(*where);
      count_points();
      if (const YamlNode* sample = find(*sections, "sample")) read_sample(*sample);
    }
    if (findings_.all().empty()) check_first_point();
    if (findings_.all().empty()) compute_conditions();
    if (!findings_.all().empty()) fail();
    std::sort(plan_.banks_.begin(), plan_.banks_.end());
    return std::move(plan_);
  }

 private:
  using Entries = PlanFindings::Entries;

  [[noreturn]] void fail() const {
    throw platform::BoardError(
        findings_.all(), plan_.product_ > 1
                             ? fmt::format("{}: the plan would have {} points", plan_.path_, plan_.size())
                             : "");
  }

  static const YamlNode* find(const Entries& entries, const std::string& name) {
    for (const YamlNode::Entry& entry : entries) {
      if (entry.key.text == name) return &entry.value;
    }
    return nullptr;
  }

  // Reads `board`, `set` and `run`: the board and the run that all points have in common.
  void read_base(const Entries& sections, const YamlNode& tree) {
    if (const YamlNode* run = find(sections, "run")) read_run(*run);
    const YamlNode* const board = find(sections, "board");
    if (board == nullptr)
      return findings_.report(tree.place, "board: missing: a preset, or the path of a board file");
    if (!board->is_scalar() || board->text.empty())
      return findings_.report("board", *board, "a preset, or the path of a board file");
    const bool is_option = !plan_.board_.empty();
    if (!is_option) plan_.board_ = board->text;
    try {
      plan_.base_.emplace(plan_.board_);
    } catch (const platform::BoardError& error) {
      for (const Diagnostic& problem : error.diagnostics()) {
        // The problem is in the name of the board, or in a line of its file.
        const bool is_of_name = problem.place == plan_.board_;
        const std::string text = fmt::format("board = {}: {}", plan_.board_, problem.text);
        findings_.add({!is_of_name ? problem
                       : is_option ? Diagnostic{"--board", text}
                                   : Diagnostic{findings_.place_text(board->place), text}});
      }
      return;
    }
    auto base = plan_.base_->read_with_problems();
    findings_.add(base.problems);
    if (!base.problems.empty()) return plan_.base_.reset();
    if (const YamlNode* set = find(sections, "set")) {
      const Entries* const entries =
          findings_.read_map("set", *set, {}, "a map of keys of the board and their values");
      if (entries == nullptr) return;
      for (const YamlNode::Entry& entry : *entries) {
        take_path("set", entry.key);
        plan_.base_->replace(entry.key.text, entry.value, plan_.path_);
        take_banks(entry.key, {entry.value});
      }
    }
    base = plan_.base_->read_with_problems();
    findings_.add(base.problems);
    if (!base.problems.empty()) return;
    for (const platform::BankConfig& bank : base.board.banks) take_bank(bank.name, board->place);
    plan_.base_board_ = std::move(base.board);
  }

  void read_run(const YamlNode& node) {
    const Entries* const entries =
        findings_.read_map("run", node, {"source", "frames", "calibration"}, "a map");
    if (entries == nullptr) return;
    for (const YamlNode::Entry& entry : *entries) {
      const std::string path = "run." + entry.key.text;
      if (const std::string rule = run_key_problem(path, entry.value); !rule.empty()) {
        findings_.report(path, entry.value, rule);
        continue;
      }
      apply_run_key(path, entry.value, plan_.run_);
      if (path != kCalibrationPath) continue;
      plan_.calibration_ = entry.value.text;
      plan_.calibration_place_ = findings_.place_text(entry.value.place);
    }
  }

  // Records a path that occurs in a section of the plan. Reports a path that is not allowed in the section,
  // or that has occurred before; returns false for both. Also reports a path if the plan has another path
  // above or below it.
  bool take_path(const std::string& section, const YamlNode& key) {
    const std::string& path = key.text;
    const bool is_run = section != "set" && may_vary(path);
    const bool is_checked_later = section == "set";  // by the draft of the board
    const std::string rule = is_run || is_checked_later ? ""
                             : path == kCalibrationPath ? "can only be given in `run`: one for all points"
                                                        : platform::path_problem(path);
    const auto [first, is_new] = places_.emplace(path, key.place);
    if (!rule.empty()) {
      findings_.report(key.place, fmt::format("{}: {}: {}", section, path, rule));
    } else if (!is_new) {
      findings_.report(key.place, fmt::format("{}: {}: given before, at {}:{}", section, path,
                                              first->second.line, first->second.column));
    }
    const auto report_overlap = [&](const auto& other) {
      findings_.report(key.place, fmt::format("{}: {}: overlaps {}, given at {}:{}", section, path,
                                              other->first, other->second.line, other->second.column));
    };
    for (std::size_t dot = path.find('.'); dot != std::string::npos; dot = path.find('.', dot + 1)) {
      const auto around = places_.find(path.substr(0, dot));
      if (around != places_.end()) report_overlap(around);
    }
    for (auto inside = places_.lower_bound(path + '.'); inside != places_.end(); ++inside) {
      if (inside->first.compare(0, path.size() + 1, path + '.') != 0) break;
      report_overlap(inside);
    }
    return rule.empty() && is_new;
  }

  // Records the names of banks in values of `ssram.banks`, or in a key below it.
  void take_banks(const YamlNode& key, const std::vector<YamlNode>& values) {
    static const std::string kBanks = "ssram.banks";
    if (key.text == kBanks) {
      for (const YamlNode& value : values) {
        for (const YamlNode::Entry& bank : value.entries) take_bank(bank.key.text, bank.key.place);
      }
    } else if (key.text.rfind(kBanks + '.', 0) == 0) {
      const std::size_t begin = kBanks.size() + 1;
      take_bank(key.text.substr(begin, key.text.find('.', begin) - begin), key.place);
    }
  }

  // Records the name of a bank. Reports it if it differs from an earlier name only in case: all points are
  // rows of one table, and SQL ignores the case of its columns.
  void take_bank(const std::string& name, const Place& place) {
    const auto [known, is_new] = banks_.emplace(without_case(name), name);
    if (is_new) {
      plan_.banks_.push_back(name);
    } else if (known->second != name) {
      findings_.report(place, bank_names_problem(known->second, name));
    }
  }

  void read_vary(const YamlNode& node) {
    const Entries* const entries = findings_.read_map(
        "vary", node, {}, "a map of keys of the board and lists or ranges of their values");
    if (entries == nullptr) return;
    for (const YamlNode::Entry& entry : *entries) {
      if (!take_path("vary", entry.key)) continue;
      if (auto values = values_of("vary", entry))
        plan_.axes_.push_back({{entry.key.text}, {std::move(*values)}});
    }
  }

  void read_zip(const YamlNode& node) {
    if (!node.is_list())
      return findings_.report("zip", node, "a list of maps; the keys of a map move together");
    for (const YamlNode& group : node.items) {
      const Entries* const entries = findings_.read_map("zip", group, {}, "a map of keys that move together");
      if (entries == nullptr) continue;
      Plan::Axis axis;
      for (const YamlNode::Entry& entry : *entries) {
        if (!take_path("zip", entry.key)) continue;
        auto values = values_of("zip", entry);
        if (!values) continue;
        if (!axis.values.empty() && values->size() != axis.size()) {
          findings_.report(entry.value.place,
                           fmt::format("zip: {}: {} values; must be as many as {} has, {}", entry.key.text,
                                       values->size(), axis.paths.front(), axis.size()));
          continue;
        }
        axis.paths.push_back(entry.key.text);
        axis.values.push_back(std::move(*values));
      }
      if (!axis.values.empty()) plan_.axes_.push_back(std::move(axis));
    }
  }

  // Reads the values of a key that varies, and reports each value that is wrong by itself. (A value that is
  // wrong only beside a value of another key makes points impossible.) If there are no values, reports that
  // and returns nullopt.
  std::optional<PlanValues> values_of(const std::string& section, const YamlNode::Entry& entry) {
    const std::string& path = entry.key.text;
    const YamlNode& node = entry.value;
    const std::string name = section + ": " + path;
    if (node.is_list() && !node.items.empty()) {
      for (const YamlNode& value : node.items) findings_.add(problems_of(path, value));
      take_banks(entry.key, node.items);
      return PlanValues(node.items);
    }
    if (!node.is_map() || node.find("from") == nullptr) {
      findings_.report(name, node, "a list of values, or a range such as {from: 16, to: 128, step: 16}");
      return std::nullopt;
    }
    const auto range = read_range(name, node, findings_);
    if (!range) return std::nullopt;
    take_banks(entry.key, {});
    PlanValues values(*range, node.place);
    check_range(name, path, node, values);
    return values;
  }

  // Reports all refused values of a range in one line.
  void check_range(const std::string& name, const std::string& path, const YamlNode& node,
                   const PlanValues& values) {
    const platform::Key* const key = platform::find_key(platform::schema_path(path));
    const auto allows = [&](const YamlNode& number) {
      if (path == kFramesPath) return kFramesRule.allows(platform::integer_of(number).value_or(0));
      return key == nullptr || platform::allows_number(*key, number);
    };
    std::uint64_t refused = 0;
    YamlNode first = values.at(0);
    for (std::uint64_t i = 0; i < values.size(); ++i) {
      const YamlNode number = values.at(i);
      if (!allows(number) && refused++ == 0) first = number;
    }
    const std::vector<Diagnostic> problems = problems_of(path, first);
    // A key without a rule for numbers allows all numbers or none.
    if (refused == 0 && !problems.empty()) refused = values.size();
    if (refused == 0) return;
    findings_.report(name, node,
                     fmt::format("{} of {} values refused, the first: {}", refused, values.size(),
                                 problems.empty() ? first.text : problems.front().text));
  }

  std::vector<Diagnostic> problems_of(const std::string& path, const YamlNode& value) const {
    if (may_vary(path)) {
      const std::string rule = run_key_problem(path, value);
      if (rule.empty()) return {};
      return {{findings_.place_text(value.place), fmt::format("{} = {}: {}", path, short_text(value), rule)}};
    }
    if (!plan_.base_board_) return {};
    return plan_.base_->problems_of(path, value, plan_.path_);
  }

  void read_conditions(const YamlNode& node) {
    const std::vector<YamlNode> single = {node};
    if (node.items.size() > kMostConditions)
      return findings_.report("where", node, fmt::format("at most {} conditions", kMostConditions));
    for (const YamlNode& item : node.is_list() ? node.items : single) {
      if (!item.is_scalar()) {
        findings_.report("where", item,
                         "an SQL expression over keys, such as image.width * image.height <= 307200");
        continue;
      }
      try {
        const Condition condition = {item.text, findings_.place_text(item.place),
                                     "where = " + short_text(item)};
        const Conditions compiled({condition});
        plan_.conditions_.push_back(condition);
      } catch (const std::invalid_argument& error) {
        findings_.report("where", item, fmt::format("not an SQL expression over keys: {}", error.what()));
      }
    }
  }

  // Reports the keys that are missing in the first point, because they are missing in all points.
  void check_first_point() {
    const auto [draft, run] = plan_.combination(0);
    for (const Diagnostic& problem : draft.read_with_problems().problems) {
      if (!problem.is_between_keys) findings_.add({problem});
    }
  }

  // Computes each condition for the first and the last point, so that a condition that can never be computed
  // is refused.
  void compute_conditions() {
    if (plan_.conditions_.empty()) return;
    const auto first = plan_.point(0).values;
    const auto last = plan_.point(plan_.size() - 1).values;
    for (const Condition& condition : plan_.conditions_) {
      try {
        Conditions compiled({condition});
        compiled.hold(first);
        compiled.hold(last);
      } catch (const ConditionError& error) {
        findings_.add({{condition.place, condition.name + ": " + error.reason}});
      }
    }
  }

  void count_points() {
    for (const Plan::Axis& axis : plan_.axes_) {
      const std::uint64_t values = axis.size();
      if (plan_.product_ > kMostPoints / values) {
        findings_.add({{plan_.path_, "more than 2^62 points"}});
        plan_.product_ = 1;
        return;
      }
      plan_.product_ *= values;
    }
  }

  void read_sample(const YamlNode& node) {
    const Entries* const entries = findings_.read_map("sample", node, {"points", "seed"}, "a map");
    if (entries == nullptr) return;
    Plan::Sample sample;
    const auto read = [&](const std::string& name, std::uint64_t least, std::uint64_t most,
                          std::uint64_t& out) {
      const YamlNode* const value = find(*entries, name);
      if (value == nullptr)
        return findings_.report(node.place, fmt::format("sample.{}: missing: {}..{}", name, least, most));
      const auto number = platform::integer_of(*value);
      if (!number || *number < 0 || static_cast<std::uint64_t>(*number) < least ||
          static_cast<std::uint64_t>(*number) > most) {
        return findings_.report("sample." + name, *value, fmt::format("{}..{}", least, most));
      }
      out = static_cast<std::uint64_t>(*number);
    };
    const std::size_t before = findings_.all().size();
    read("points", 1, plan_.product_, sample.points);
    read("seed", 0, std::numeric_limits<std::int64_t>::max(), sample.seed);
    if (findings_.all().size() == before) plan_.sample_ = sample;
  }

  Plan plan_;
  PlanFindings findings_;
  std::map<std::string, Place> places_;       // [path that occurs in the plan]
  std::map<std::string, std::string> banks_;  // [name without_case()]: name
};

Plan Plan::load(const std::string& path, const std::string& board) { return PlanReader(path, board).read(); }

}  // namespace stereotlm::explore
