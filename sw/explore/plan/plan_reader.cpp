#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>
#include <variant>

#include "platform/config/board_keys.h"
#include "platform/config/text_file.h"
#include "platform/config/value_reader.h"
#include "platform/config/yaml_tree.h"
#include "platform/config/yaml_values.h"
#include "sw/explore/plan/conditions.h"
#include "sw/explore/plan/plan.h"
#include "sw/explore/store/bank_names.h"

namespace stereotlm::explore {

using platform::Diagnostic;
using platform::Place;
using platform::YamlNode;

namespace {

constexpr std::uint64_t kMostPoints = std::uint64_t{1} << 62U;
constexpr platform::IntegerRule kFramesRule = {1, 1'000'000};
constexpr std::int64_t kMostValues = 1'000'000;  // of one key
constexpr std::size_t kMostConditions = 1000;
constexpr int kMostRangeDigits = 18;  // of a number of a range, written with all its places

}  // namespace

// Reads one plan; what is wrong with it is collected.
class PlanReader {
 public:
  PlanReader(const std::string& path, const std::string& board) : plan_(path, board) {}

  Plan read() {
    YamlNode tree;
    try {
      tree = platform::parse_yaml(platform::read_text_file(plan_.path_, "plan"), Place::kBoard);
    } catch (const platform::YamlError& error) {
      report(error.place, error.what());
      fail();
    }
    if (const Entries* sections = read_map(
            "", tree, {"board", "run", "set", "vary", "zip", "where", "sample"}, "a plan is a map")) {
      read_base(*sections, tree);
      if (const YamlNode* vary = find(*sections, "vary")) read_vary(*vary);
      if (const YamlNode* zip = find(*sections, "zip")) read_zip(*zip);
      if (const YamlNode* where = find(*sections, "where")) read_conditions(*where);
      count_points();
      if (const YamlNode* sample = find(*sections, "sample")) read_sample(*sample);
    }
    if (diagnostics_.empty()) check_first_point();
    if (diagnostics_.empty()) compute_conditions();
    if (!diagnostics_.empty()) fail();
    std::sort(plan_.banks_.begin(), plan_.banks_.end());
    return std::move(plan_);
  }

 private:
  using Entries = std::vector<YamlNode::Entry>;

  void report(const Place& place, const std::string& text) {
    diagnostics_.push_back({place_text(place), text});
  }
  std::string place_text(const Place& place) const {
    return fmt::format("{}:{}:{}", plan_.path_, place.line, place.column);
  }
  void report(const std::string& path, const YamlNode& node, const std::string& rule) {
    report(node.place, fmt::format("{} = {}: {}", path, short_text(node), rule));
  }
  [[noreturn]] void fail() {
    throw platform::BoardError(
        std::move(diagnostics_),
        plan_.product_ > 1 ? fmt::format("{}: the plan would have {} points", plan_.path_, plan_.size())
                           : "");
  }

  // The entries of a map, whose keys are `known` if any are given; nullptr, and reported, if it is none.
  // Entries that are not known or repeated are reported too.
  const Entries* read_map(const std::string& path, const YamlNode& node,
                          const std::vector<std::string>& known, const std::string& rule) {
    if (!node.is_map()) {
      report(path.empty() ? "the plan" : path, node,
             known.empty() ? rule : fmt::format("{} of {}", rule, fmt::join(known, ", ")));
      return nullptr;
    }
    std::map<std::string, Place> first;
    for (const YamlNode::Entry& entry : node.entries) {
      const std::string name = short_text(entry.key);
      const std::string full = platform::below(path, name);
      const auto [at, is_new] = first.emplace(name, entry.key.place);
      if (!known.empty() && std::find(known.begin(), known.end(), name) == known.end()) {
        report(entry.key.place, fmt::format("{} = {}: unknown key{}; keys: {}", full, short_text(entry.value),
                                            platform::nearest_text(name, known), platform::listed(known)));
      } else if (!is_new) {
        report(entry.key.place, fmt::format("{} = {}: repeated key, first at {}:{}", full,
                                            short_text(entry.value), at->second.line, at->second.column));
      }
    }
    return &node.entries;
  }

  static const YamlNode* find(const Entries& entries, const std::string& name) {
    for (const YamlNode::Entry& entry : entries) {
      if (entry.key.text == name) return &entry.value;
    }
    return nullptr;
  }

  // The board that all points begin with, as `board`, `set` and `run` give it.
  void read_base(const Entries& sections, const YamlNode& tree) {
    if (const YamlNode* run = find(sections, "run")) read_run(*run);
    const YamlNode* const board = find(sections, "board");
    if (board == nullptr) return report(tree.place, "board: missing: a preset, or the path of a board file");
    if (!board->is_scalar() || board->text.empty())
      return report("board", *board, "a preset, or the path of a board file");
    const bool is_option = !plan_.board_.empty();
    if (!is_option) plan_.board_ = board->text;
    try {
      plan_.base_.emplace(plan_.board_);
    } catch (const platform::BoardError& error) {
      for (const Diagnostic& problem : error.diagnostics()) {
        // Of the name of the board, or of a line in its file.
        const bool is_of_name = problem.place == plan_.board_;
        const std::string text = fmt::format("board = {}: {}", plan_.board_, problem.text);
        diagnostics_.push_back(!is_of_name ? problem
                               : is_option ? Diagnostic{"--board", text}
                                           : Diagnostic{place_text(board->place), text});
      }
      return;
    }
    auto base = plan_.base_->read_with_problems();
    take_all(base.problems);
    if (!base.problems.empty()) return plan_.base_.reset();
    if (const YamlNode* set = find(sections, "set")) {
      const Entries* const entries = read_map("set", *set, {}, "a map of keys of the board and their values");
      if (entries == nullptr) return;
      for (const YamlNode::Entry& entry : *entries) {
        take_path("set", entry.key);
        plan_.base_->replace(entry.key.text, entry.value, plan_.path_);
        take_banks(entry.key, {entry.value});
      }
    }
    base = plan_.base_->read_with_problems();
    take_all(base.problems);
    if (!base.problems.empty()) return;
    for (const platform::BankConfig& bank : base.board.banks) take_bank(bank.name, board->place);
    plan_.base_board_ = std::move(base.board);
  }

  void read_run(const YamlNode& node) {
    const Entries* const entries = read_map("run", node, {"source", "frames", "calibration"}, "a map");
    if (entries == nullptr) return;
    for (const YamlNode::Entry& entry : *entries) {
      const std::string path = "run." + entry.key.text;
      if (const std::string rule = run_problem(path, entry.value); !rule.empty()) {
        report(path, entry.value, rule);
        continue;
      }
      Plan::apply_to_run(path, entry.value, plan_.run_);
      if (path != kCalibrationPath) continue;
      plan_.calibration_ = entry.value.text;
      plan_.calibration_place_ = place_text(entry.value.place);
    }
  }

  static bool is_of_run(const std::string& path) { return path == kSourcePath || path == kFramesPath; }

  // Empty if it keeps its rule.
  static std::string run_problem(const std::string& path, const YamlNode& value) {
    const bool is_source = value.is_scalar() && (value.text == "preloaded" || value.text == "camera");
    if (path == kSourcePath && !is_source)
      return "preloaded (the board alone) or camera (the whole computer)";
    if (path == kFramesPath && !kFramesRule.allows(platform::integer_of(value).value_or(0)))
      return kFramesRule.text() + ", the frames of each point";
    if (path == kCalibrationPath && (!value.is_scalar() || value.text.empty()))
      return "the file of a calibration, as written by stereotlm calibrate";
    return "";
  }

  // A path may be given once in the whole plan.
  bool take_path(const std::string& section, const YamlNode& key) {
    const std::string& path = key.text;
    const bool is_run = section != "set" && is_of_run(path);
    const bool is_checked_later = section == "set";  // by the board
    const std::string rule = is_run || is_checked_later ? ""
                             : path == kCalibrationPath ? "goes with `run`: one for all points"
                                                        : platform::path_problem(path);
    const auto [first, is_new] = places_.emplace(path, key.place);
    if (!rule.empty()) {
      report(key.place, fmt::format("{}: {}: {}", section, path, rule));
    } else if (!is_new) {
      report(key.place, fmt::format("{}: {}: given before, at {}:{}", section, path, first->second.line,
                                    first->second.column));
    }
    const auto report_overlap = [&](const auto& other) {
      report(key.place, fmt::format("{}: {}: overlaps {}, given at {}:{}", section, path, other->first,
                                    other->second.line, other->second.column));
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

  // The names of banks that values bring, of `ssram.banks` or of a key below.
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

  // All points of a plan have their rows in one table.
  void take_bank(const std::string& name, const Place& place) {
    const auto [known, is_new] = banks_.emplace(without_case(name), name);
    if (is_new) {
      plan_.banks_.push_back(name);
    } else if (known->second != name) {
      report(place, bank_names_problem(known->second, name));
    }
  }

  void read_vary(const YamlNode& node) {
    const Entries* const entries =
        read_map("vary", node, {}, "a map of keys of the board and lists or ranges of their values");
    if (entries == nullptr) return;
    for (const YamlNode::Entry& entry : *entries) {
      if (!take_path("vary", entry.key)) continue;
      if (auto values = values_of("vary", entry))
        plan_.axes_.push_back({{entry.key.text}, {std::move(*values)}});
    }
  }

  void read_zip(const YamlNode& node) {
    if (!node.is_list()) return report("zip", node, "a list of maps; the keys of a map move together");
    for (const YamlNode& group : node.items) {
      const Entries* const entries = read_map("zip", group, {}, "a map of keys that move together");
      if (entries == nullptr) continue;
      Plan::Axis axis;
      for (const YamlNode::Entry& entry : *entries) {
        if (!take_path("zip", entry.key)) continue;
        auto values = values_of("zip", entry);
        if (!values) continue;
        if (!axis.values.empty() && values->size() != axis.size()) {
          report(entry.value.place,
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

  // Each is checked by itself: what another key can make right is left to the points. Nothing if there are
  // none.
  std::optional<PlanValues> values_of(const std::string& section, const YamlNode::Entry& entry) {
    const std::string& path = entry.key.text;
    const YamlNode& node = entry.value;
    const std::string name = section + ": " + path;
    if (node.is_list() && !node.items.empty()) {
      for (const YamlNode& value : node.items) take_all(problems_of(path, value));
      take_banks(entry.key, node.items);
      return PlanValues(node.items);
    }
    if (!node.is_map() || node.find("from") == nullptr) {
      report(name, node, "a list of values, or a range such as {from: 16, to: 128, step: 16}");
      return std::nullopt;
    }
    const auto range = range_of(name, node);
    if (!range) return std::nullopt;
    take_banks(entry.key, {});
    PlanValues values(*range, node.place);
    check_range(name, path, node, *range, values);
    return values;
  }

  // One line for all values of a range.
  void check_range(const std::string& name, const std::string& path, const YamlNode& node,
                   const DecimalRange& range, const PlanValues& values) {
    RefusedOfRange refused = refused_by_rule(path, range);
    // A key without a rule for numbers takes all of them or none.
    if (refused.count == 0 && !problems_of(path, values.at(0)).empty()) refused = {range.count, 0};
    if (refused.count == 0) return;
    const std::vector<Diagnostic> first = problems_of(path, values.at(refused.first));
    report(name, node,
           fmt::format("{} of {} values refused, the first: {}", refused.count, range.count,
                       first.empty() ? values.at(refused.first).text : first.front().text));
  }

  static RefusedOfRange refused_by_rule(const std::string& path, const DecimalRange& range) {
    if (path == kFramesPath) return refused_of(range, kFramesRule);
    const std::string schema = platform::schema_path(path);
    for (const platform::Key& key : platform::board_keys()) {
      if (key.path != schema) continue;
      if (const auto* rule = std::get_if<platform::IntegerKey>(&key.rule))
        return refused_of(range, rule->rule);
      if (const auto* rule = std::get_if<platform::DecimalKey>(&key.rule)) return refused_of(range, *rule);
      const auto* other = std::get_if<platform::OtherKey>(&key.rule);
      if (other != nullptr && other->numbers) return refused_of(range, *other->numbers);
    }
    return {};
  }

  std::vector<Diagnostic> problems_of(const std::string& path, const YamlNode& value) const {
    if (is_of_run(path)) {
      const std::string rule = run_problem(path, value);
      if (rule.empty()) return {};
      return {{place_text(value.place), fmt::format("{} = {}: {}", path, short_text(value), rule)}};
    }
    if (!plan_.base_board_) return {};
    return plan_.base_->problems_of(path, value, plan_.path_);
  }

  void take_all(const std::vector<Diagnostic>& diagnostics) {
    diagnostics_.insert(diagnostics_.end(), diagnostics.begin(), diagnostics.end());
  }

  std::optional<DecimalRange> range_of(const std::string& name, const YamlNode& node) {
    if (read_map(name, node, {"from", "to", "step"}, "a range") == nullptr) return std::nullopt;
    constexpr std::array kKeys = {"from", "to", "step"};
    const std::string rule = fmt::format("a decimal number of at most {} digits", kMostDigits);
    std::array<Decimal, kKeys.size()> numbers;
    int places = 0;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const char* const key = kKeys[i];
      const YamlNode::Entry* const entry = node.find(key);
      if (entry == nullptr) {
        report(node.place, fmt::format("{}.{}: missing: {}", name, key, rule));
        return std::nullopt;
      }
      const auto number = exact_decimal(entry->value);
      if (!number) {
        report(fmt::format("{}.{}", name, key), entry->value, rule);
        return std::nullopt;
      }
      numbers[i] = *number;
      places = std::max(places, number->places);
    }
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (digits_with(numbers[i], places) > kMostRangeDigits) {
        report(fmt::format("{}.{}", name, kKeys[i]), node.find(kKeys[i])->value,
               fmt::format("at most {} digits, with the {} decimal places that the range has",
                           kMostRangeDigits, places));
        return std::nullopt;
      }
    }
    for (Decimal& number : numbers) {
      for (; number.places < places; ++number.places) number.digits *= 10;
    }
    const auto& [from, to, step] = numbers;
    const std::int64_t distance = to.digits - from.digits;
    if (step.digits <= 0 || distance < 0 || distance % step.digits != 0 ||
        distance / step.digits >= kMostValues) {
      report(name, node,
             fmt::format("to must be from plus a number of steps, at most {} values", kMostValues));
      return std::nullopt;
    }
    return DecimalRange{from.digits, step.digits, static_cast<std::uint64_t>(distance / step.digits) + 1,
                        places};
  }

  void read_conditions(const YamlNode& node) {
    const std::vector<YamlNode> single = {node};
    if (node.items.size() > kMostConditions)
      return report("where", node, fmt::format("at most {} conditions", kMostConditions));
    for (const YamlNode& item : node.is_list() ? node.items : single) {
      if (!item.is_scalar()) {
        report("where", item, "an SQL expression over keys, such as image.width * image.height <= 307200");
        continue;
      }
      try {
        const Condition condition = {item.text, place_text(item.place), "where = " + short_text(item)};
        const Conditions compiled({condition});
        plan_.conditions_.push_back(condition);
      } catch (const std::invalid_argument& error) {
        report("where", item, fmt::format("not an SQL expression over keys: {}", error.what()));
      }
    }
  }

  // A key that is missing beside those that the plan gives is missing in all points.
  void check_first_point() {
    const auto [draft, run] = plan_.combination(0);
    for (const Diagnostic& problem : draft.read_with_problems().problems) {
      if (!problem.is_between_keys) diagnostics_.push_back(problem);
    }
  }

  // Computes each condition for the first and the last point, so that what can never be computed is refused.
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
        diagnostics_.push_back({condition.place, condition.name + ": " + error.reason});
      }
    }
  }

  void count_points() {
    for (const Plan::Axis& axis : plan_.axes_) {
      const std::uint64_t values = axis.size();
      if (plan_.product_ > kMostPoints / values) {
        diagnostics_.push_back({plan_.path_, "more than 2^62 points"});
        plan_.product_ = 1;
        return;
      }
      plan_.product_ *= values;
    }
  }

  void read_sample(const YamlNode& node) {
    const Entries* const entries = read_map("sample", node, {"points", "seed"}, "a map");
    if (entries == nullptr) return;
    Plan::Sample sample;
    const auto read = [&](const std::string& name, std::uint64_t least, std::uint64_t most,
                          std::uint64_t& out) {
      const YamlNode* const value = find(*entries, name);
      if (value == nullptr)
        return report(node.place, fmt::format("sample.{}: missing: {}..{}", name, least, most));
      const auto number = platform::integer_of(*value);
      if (!number || *number < 0 || static_cast<std::uint64_t>(*number) < least ||
          static_cast<std::uint64_t>(*number) > most) {
        return report("sample." + name, *value, fmt::format("{}..{}", least, most));
      }
      out = static_cast<std::uint64_t>(*number);
    };
    const std::size_t before = diagnostics_.size();
    read("points", 1, plan_.product_, sample.points);
    read("seed", 0, std::numeric_limits<std::int64_t>::max(), sample.seed);
    if (diagnostics_.size() == before) plan_.sample_ = sample;
  }

  Plan plan_;
  std::vector<Diagnostic> diagnostics_;
  std::map<std::string, Place> places_;
  std::map<std::string, std::string> banks_;  // by their names without_case()
};

Plan Plan::load(const std::string& path, const std::string& board) { return PlanReader(path, board).read(); }

}  // namespace stereotlm::explore
