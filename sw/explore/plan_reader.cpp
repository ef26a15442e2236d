#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "platform/board_keys.h"
#include "platform/text_file.h"
#include "platform/value_reader.h"
#include "platform/yaml_tree.h"
#include "platform/yaml_values.h"
#include "sw/explore/bank_names.h"
#include "sw/explore/conditions.h"
#include "sw/explore/plan.h"

namespace stereotlm::explore {

using platform::Diagnostic;
using platform::Place;
using platform::YamlNode;

namespace {

constexpr std::uint64_t kMostPoints = std::uint64_t{1} << 62U;
constexpr std::uint64_t kMostFrames = 1'000'000;
constexpr std::int64_t kMostValues = 1'000'000;  // of one key
constexpr int kMostRangeDigits = 18;             // of a number of a range, written with all its places

// A decimal number as an integer and a number of digits behind the point.
struct Decimal {
  std::int64_t digits = 0;
  int places = 0;
};

std::optional<Decimal> decimal(const YamlNode& node) {
  if (!platform::decimal_of(node)) return std::nullopt;
  constexpr std::size_t kMostDigits = 15;
  std::string text = node.text;
  const std::size_t point = text.find('.');
  Decimal value;
  if (point != std::string::npos) {
    value.places = static_cast<int>(text.size() - point - 1);
    text.erase(point, 1);
  }
  if (text.size() > kMostDigits) return std::nullopt;
  value.digits = std::stoll(text);
  return value;
}

// How many digits it has if it is written with so many places.
int digits_with(const Decimal& value, int places) {
  return static_cast<int>(std::to_string(std::abs(value.digits)).size()) + places - value.places;
}

void scale(Decimal& value, int places) {
  for (; value.places < places; ++value.places) value.digits *= 10;
}

std::string text_of(const Decimal& value) {
  std::string text = std::to_string(value.digits < 0 ? -value.digits : value.digits);
  const auto places = static_cast<std::size_t>(value.places);
  if (text.size() <= places) text.insert(0, places + 1 - text.size(), '0');
  if (places > 0) text.insert(text.size() - places, ".");
  return (value.digits < 0 ? "-" : "") + text;
}

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
    if (diagnostics_.empty()) compute_conditions();
    if (!diagnostics_.empty()) fail();
    plan_.banks_ = {banks_.begin(), banks_.end()};
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
    if (plan_.product_ > 1) {
      diagnostics_.push_back({plan_.path_, fmt::format("the plan would have {} points", plan_.size())});
    }
    throw platform::BoardError(std::move(diagnostics_));
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
    if (!board->is_scalar()) return report("board", *board, "a preset, or the path of a board file");
    if (plan_.board_.empty()) plan_.board_ = board->text;
    try {
      plan_.base_.emplace(plan_.board_);
      plan_.base_->read();
    } catch (const platform::BoardError& error) {
      plan_.base_.reset();
      diagnostics_.insert(diagnostics_.end(), error.diagnostics().begin(), error.diagnostics().end());
      return;
    }
    if (const YamlNode* set = find(sections, "set")) {
      const Entries* const entries = read_map("set", *set, {}, "a map of keys of the board and their values");
      if (entries == nullptr) return;
      for (const YamlNode::Entry& entry : *entries) {
        take_path("set", entry.key);
        plan_.base_->replace(entry.key.text, entry.value, plan_.path_);
        take_banks(entry.key, entry.value);
      }
    }
    try {
      plan_.base_board_ = plan_.base_->read();
      plan_.base_yaml_ = to_yaml(*plan_.base_board_);
      for (const platform::BankConfig& bank : plan_.base_board_->banks) take_bank(bank.name, board->place);
    } catch (const platform::BoardError& error) {
      diagnostics_.insert(diagnostics_.end(), error.diagnostics().begin(), error.diagnostics().end());
    }
  }

  void read_run(const YamlNode& node) {
    const Entries* const entries = read_map("run", node, {"source", "frames", "calibration"}, "a map");
    if (entries == nullptr) return;
    for (const YamlNode::Entry& entry : *entries) {
      const std::string path = "run." + entry.key.text;
      if (!check_run(path, entry.value)) continue;
      Plan::apply_to_run(path, entry.value, plan_.run_);
      if (path != kCalibrationPath) continue;
      plan_.calibration_ = entry.value.text;
      plan_.calibration_place_ = place_text(entry.value.place);
    }
  }

  bool check_run(const std::string& path, const YamlNode& value) {
    const std::size_t before = diagnostics_.size();
    if (path == kSourcePath &&
        (!value.is_scalar() || (value.text != "preloaded" && value.text != "camera"))) {
      report(path, value, "preloaded (the board alone) or camera (the whole computer)");
    }
    if (path == kFramesPath) {
      const auto frames = platform::integer_of(value);
      if (!frames || *frames < 1 || *frames > static_cast<std::int64_t>(kMostFrames))
        report(path, value, fmt::format("1..{}, the frames of each point", kMostFrames));
    }
    if (path == kCalibrationPath && (!value.is_scalar() || value.text.empty()))
      report(path, value, "the file of a calibration, as written by stereotlm calibrate");
    return diagnostics_.size() == before;
  }

  // A path may be given once in the whole plan.
  bool take_path(const std::string& section, const YamlNode& key) {
    const std::string& path = key.text;
    const bool is_run = section != "set" && (path == kSourcePath || path == kFramesPath);
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
    for (const auto& [other, place] : places_) {
      const bool is_inside =
          path.size() > other.size() && path.compare(0, other.size() + 1, other + '.') == 0;
      const bool is_around = other.size() > path.size() && other.compare(0, path.size() + 1, path + '.') == 0;
      if (is_inside || is_around) {
        report(key.place, fmt::format("{}: {}: overlaps {}, given at {}:{}", section, path, other, place.line,
                                      place.column));
      }
    }
    return rule.empty() && is_new;
  }

  // The names of banks that a value brings, of `ssram.banks` or of a key below.
  void take_banks(const YamlNode& key, const YamlNode& value) {
    static const std::string kBanks = "ssram.banks";
    if (key.text == kBanks) {
      for (const YamlNode::Entry& bank : value.entries) take_bank(bank.key.text, bank.key.place);
    } else if (key.text.rfind(kBanks + '.', 0) == 0) {
      const std::size_t begin = kBanks.size() + 1;
      take_bank(key.text.substr(begin, key.text.find('.', begin) - begin), key.place);
    }
  }

  // All points of a plan have their rows in one table.
  void take_bank(const std::string& name, const Place& place) {
    if (!banks_.insert(name).second) return;
    for (const std::string& other : banks_) {
      if (differ_in_case(name, other)) report(place, bank_names_problem(other, name));
    }
  }

  void read_vary(const YamlNode& node) {
    const Entries* const entries =
        read_map("vary", node, {}, "a map of keys of the board and lists or ranges of their values");
    if (entries == nullptr) return;
    for (const YamlNode::Entry& entry : *entries) {
      if (!take_path("vary", entry.key)) continue;
      Plan::Axis axis;
      axis.paths = {entry.key.text};
      for (YamlNode& value : values_of("vary", entry)) axis.values.push_back({std::move(value)});
      if (!axis.values.empty()) plan_.axes_.push_back(std::move(axis));
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
        std::vector<YamlNode> values = values_of("zip", entry);
        if (axis.values.empty()) axis.values.resize(values.size());
        if (values.size() != axis.values.size()) {
          report(entry.value.place,
                 fmt::format("zip: {}: {} values; must be as many as {} has, {}", entry.key.text,
                             values.size(), axis.paths.front(), axis.values.size()));
          continue;
        }
        axis.paths.push_back(entry.key.text);
        for (std::size_t i = 0; i < values.size(); ++i) axis.values[i].push_back(std::move(values[i]));
      }
      if (!axis.values.empty() && !axis.paths.empty()) plan_.axes_.push_back(std::move(axis));
    }
  }

  // Each checked by itself: what another key can make right is left to the points.
  std::vector<YamlNode> values_of(const std::string& section, const YamlNode::Entry& entry) {
    const std::string& path = entry.key.text;
    const YamlNode& node = entry.value;
    std::vector<YamlNode> values;
    if (node.is_list() && !node.items.empty()) {
      values = node.items;
    } else if (node.is_map() && node.find("from") != nullptr) {
      values = range_of(section + ": " + path, node);
    } else {
      report(section + ": " + path, node,
             "a list of values, or a range such as {from: 16, to: 128, step: 16}");
    }
    for (const YamlNode& value : values) {
      check_value(path, value);
      take_banks(entry.key, value);
    }
    return values;
  }

  void check_value(const std::string& path, const YamlNode& value) {
    if (path == kSourcePath || path == kFramesPath) {
      check_run(path, value);
      return;
    }
    if (!plan_.base_board_) return;
    platform::BoardDraft draft = *plan_.base_;
    draft.replace(path, value, plan_.path_);
    try {
      draft.read();
    } catch (const platform::BoardError& error) {
      for (const Diagnostic& diagnostic : error.diagnostics()) {
        if (!diagnostic.is_between_keys) diagnostics_.push_back(diagnostic);
      }
    }
  }

  std::vector<YamlNode> range_of(const std::string& name, const YamlNode& node) {
    if (read_map(name, node, {"from", "to", "step"}, "a range") == nullptr) return {};
    constexpr std::array kKeys = {"from", "to", "step"};
    std::array<Decimal, kKeys.size()> numbers;
    int places = 0;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const char* const key = kKeys[i];
      constexpr const char* kRule = "a decimal number of at most 15 digits";
      const YamlNode::Entry* const entry = node.find(key);
      if (entry == nullptr) {
        report(node.place, fmt::format("{}.{}: missing: {}", name, key, kRule));
        return {};
      }
      const auto number = decimal(entry->value);
      if (!number) {
        report(fmt::format("{}.{}", name, key), entry->value, kRule);
        return {};
      }
      numbers[i] = *number;
      places = std::max(places, number->places);
    }
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (digits_with(numbers[i], places) > kMostRangeDigits) {
        report(fmt::format("{}.{}", name, kKeys[i]), node.find(kKeys[i])->value,
               fmt::format("at most {} digits, with the {} decimal places that the range has",
                           kMostRangeDigits, places));
        return {};
      }
    }
    for (Decimal& number : numbers) scale(number, places);
    const auto& [from, to, step] = numbers;
    const std::int64_t distance = to.digits - from.digits;
    if (step.digits <= 0 || distance < 0 || distance % step.digits != 0 ||
        distance / step.digits >= kMostValues) {
      report(name, node,
             fmt::format("to must be from plus a number of steps, at most {} values", kMostValues));
      return {};
    }
    std::vector<YamlNode> values;
    for (std::int64_t digits = from.digits; digits <= to.digits; digits += step.digits) {
      YamlNode value;
      value.kind = YamlNode::Kind::kScalar;
      value.place = node.place;
      value.text = text_of({digits, places});
      values.push_back(std::move(value));
    }
    return values;
  }

  void read_conditions(const YamlNode& node) {
    const std::vector<YamlNode> single = {node};
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

  // For the first and the last point: what cannot be computed at all is known before anything runs.
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
      const std::uint64_t values = axis.values.size();
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
  std::set<std::string> banks_;
};

Plan Plan::load(const std::string& path, const std::string& board) { return PlanReader(path, board).read(); }

}  // namespace stereotlm::explore
