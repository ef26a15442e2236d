#include "sw/explore/plan/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <map>
#include <stdexcept>
#include <utility>

#include "calib/split_mix.h"
#include "platform/config/board_keys.h"
#include "platform/config/board_yaml.h"
#include "platform/config/tables.h"
#include "platform/yaml/words.h"
#include "sw/explore/store/store.h"

namespace stereotlm::explore {

using platform::Diagnostic;
using platform::Place;
using platform::YamlNode;

namespace {

constexpr std::uint64_t kMostPoints = std::uint64_t{1} << 62U;
constexpr std::size_t kMostConditions = 1000;
constexpr std::int64_t kMostValues = 1'000'000;  // of one range
constexpr std::size_t kMostDigits = 15;          // of a number as the plan has it
constexpr std::size_t kMostRangeDigits =
    18;  // of a number that is written with as many places as its range has

int places_of(const std::string& number) {
  const std::size_t point = number.find('.');
  return point == std::string::npos ? 0 : static_cast<int>(number.size() - point - 1);
}

// The digits of a decimal number, written with so many places, without the point.
std::string digits_with(std::string number, int places) {
  number.append(static_cast<std::size_t>(places - places_of(number)), '0');
  number.erase(std::remove(number.begin(), number.end(), '.'), number.end());
  return number;
}

// The Feistel network of shuffled_number(), for numbers of 2 * half_bits bits.
std::uint64_t permuted(std::uint64_t number, unsigned half_bits, std::uint64_t seed) {
  constexpr int kRounds = 6;
  const std::uint64_t mask = (std::uint64_t{1} << half_bits) - 1;
  calib::SplitMix keys(seed);
  std::uint64_t left = number >> half_bits;
  std::uint64_t right = number & mask;
  for (int round = 0; round < kRounds; ++round)
    left = std::exchange(right, left ^ (calib::mixed(right ^ keys.next()) & mask));
  return left << half_bits | right;
}

}  // namespace

std::uint64_t shuffled_number(std::uint64_t size, std::uint64_t seed, std::uint64_t place) {
  unsigned half_bits = 1;
  while (std::uint64_t{1} << 2 * half_bits < size) ++half_bits;
  std::uint64_t number = permuted(place, half_bits, seed);
  while (number >= size) number = permuted(number, half_bits, seed);
  return number;
}

platform::YamlNode PlanValues::at(std::uint64_t number) const {
  if (!list.empty()) return list.at(number);
  const std::int64_t value = from + static_cast<std::int64_t>(number) * step;
  std::string text = std::to_string(std::abs(value));
  const auto behind = static_cast<std::size_t>(places);
  if (text.size() <= behind) text.insert(0, behind + 1 - text.size(), '0');
  if (behind > 0) text.insert(text.size() - behind, ".");
  return platform::YamlNode::plain((value < 0 ? "-" : "") + text, place);
}

void Plan::each_value(std::uint64_t number,
                      const std::function<void(const std::string&, const platform::YamlNode&)>& visit) const {
  std::uint64_t rest = sample_ ? shuffled_number(product_, sample_->seed, number) : number;
  std::vector<std::uint64_t> places(axes_.size());
  for (std::size_t axis = axes_.size(); axis-- > 0; rest /= axes_[axis].size())
    places[axis] = rest % axes_[axis].size();
  for (std::size_t axis = 0; axis < axes_.size(); ++axis) {
    for (std::size_t i = 0; i < axes_[axis].paths.size(); ++i)
      visit(axes_[axis].paths[i], axes_[axis].values[i].at(places[axis]));
  }
}

Plan::Combination Plan::combination(std::uint64_t number) const {
  Combination made = {*base_, run_};
  each_value(number, [&](const std::string& path, const platform::YamlNode& value) {
    if (may_vary(path)) {
      apply_run_key(path, value, made.run);
    } else {
      made.draft.replace(path, value, path_);
    }
  });
  return made;
}

Plan::ReadPoint Plan::read(std::uint64_t number) const {
  Combination made = combination(number);
  platform::BoardDraft::Reading reading = made.draft.read_with_problems();
  return {std::move(made.draft), std::move(reading), std::move(made.run)};
}

std::vector<std::string> Plan::varied() const {
  std::vector<std::string> paths;
  for (const Axis& axis : axes_) paths.insert(paths.end(), axis.paths.begin(), axis.paths.end());
  return paths;
}

std::vector<std::string> Plan::varied_values(std::uint64_t number) const {
  std::vector<std::string> values;
  each_value(number, [&values](const std::string& /*path*/, const platform::YamlNode& value) {
    values.push_back(value.is_scalar() ? value.text : platform::flow_text(value));
  });
  return values;
}

std::string Plan::varied_banks() const {
  for (const Axis& axis : axes_) {
    std::set<std::vector<std::size_t>> buffers;
    for (std::uint64_t place = 0; place < axis.size(); ++place) {
      std::vector<std::size_t> counts;
      for (std::size_t i = 0; i < axis.paths.size(); ++i) {
        const platform::YamlNode value = axis.values[i].at(place);
        if (!platform::is_below(axis.paths[i], "allocation")) break;
        counts.push_back(value.is_list() ? value.items.size() : value.text == "none" ? 0 : 1);
      }
      if (counts.size() == axis.paths.size() && !buffers.insert(counts).second) return axis.paths.front();
    }
  }
  return "";
}

Point Plan::point(std::uint64_t number) const {
  const ReadPoint made = read(number);
  const platform::BoardDraft& draft = made.draft;
  const platform::BoardDraft::Reading& reading = made.reading;
  const PointRun& run = made.run;
  std::string rules;
  for (const Diagnostic& problem : reading.problems) rules += (rules.empty() ? "" : "; ") + problem.text;
  if (!rules.empty()) return impossible_point(number, draft.to_yaml(), reading.board, run, rules);
  const auto impossible = [&](const char* path, const std::string& problem) {
    return impossible_point(number, to_yaml(reading.board), reading.board, run,
                            fmt::format("{}: {}", path, problem));
  };
  if (const auto problem = tables_problem(reading.board)) return impossible(kCalibrationPath, *problem);
  if (const auto problem = pairs_problem(reading.board)) return impossible(kPairsPath, *problem);
  return make_point(number, reading.board, run);
}

bool Plan::is_fixed(const char* path) const {
  return std::none_of(axes_.begin(), axes_.end(), [path](const Axis& axis) {
    return std::any_of(axis.paths.begin(), axis.paths.end(), [path](const std::string& one) {
      return one == path || platform::is_below(one, path);
    });
  });
}

std::optional<std::string> Plan::use_pairs(const std::string& sha256, int width, int height) {
  run_.pairs = sha256;
  pairs_width_ = width;
  pairs_height_ = height;
  return is_fixed("image") ? pairs_problem(*base_board_) : std::nullopt;
}

std::optional<std::string> Plan::pairs_problem(const platform::BoardConfig& board) const {
  if (run_.pairs.empty() || (board.image.width == pairs_width_ && board.image.height == pairs_height_))
    return std::nullopt;
  return fmt::format("the pictures have {}x{} pixels: must be as large as the board's images, {}x{}",
                     pairs_width_, pairs_height_, board.image.width, board.image.height);
}

std::optional<std::string> Plan::use_calibration(const std::string& sha256, int width, int height,
                                                 const std::optional<std::string>& joint_problem) {
  run_.calibration = sha256;
  tables_width_ = width;
  tables_height_ = height;
  tables_joint_problem_ = joint_problem;
  return table_problem(*base_board_, [this](const char* path) { return is_fixed(path); });
}

std::optional<std::string> Plan::table_problem(const platform::BoardConfig& board,
                                               const std::function<bool(const char*)>& is_checked) const {
  if (run_.calibration.empty()) return std::nullopt;
  std::optional<std::string> problem;
  if (is_checked("image")) problem = platform::calibration_size_problem(board, tables_width_, tables_height_);
  if (!problem && is_checked("allocation")) problem = platform::calibration_buffer_problem(board);
  if (!problem && is_checked("fpga.tables") && board.fpga.joint_tables) problem = tables_joint_problem_;
  return problem;
}

class PlanReader {
 public:
  PlanReader(const std::string& path, const std::string& board, const std::string* board_text)
      : plan_(path, board), board_text_(board_text) {}

  Plan read(const std::string* text) {
    YamlNode tree;
    plan_.text_ = text != nullptr ? *text : platform::read_text_file(plan_.path_, "plan");
    try {
      tree = platform::parse_yaml(plan_.text_, Place::kBoard);
    } catch (const platform::YamlError& error) {
      report(error.place, error.what());
      fail();
    }
    const std::vector<std::string> keys = {"board",  "run",        "set",      "vary",     "zip",    "where",
                                           "sample", "placements", "maximise", "minimise", "require"};
    if (is_map("", tree, keys, "a plan is a map")) {
      read_base(tree);
      if (const auto* vary = tree.find("vary")) read_vary(vary->value);
      if (const auto* zip = tree.find("zip")) read_zip(zip->value);
      if (const auto* where = tree.find("where")) read_conditions(where->value);
      read_wishes(tree);
      count_points();
      if (const auto* sample = tree.find("sample")) read_sample(sample->value);
    }
    if (findings_.empty()) check_first_point();
    if (findings_.empty()) compute_conditions();
    if (!findings_.empty()) fail();
    std::sort(plan_.banks_.begin(), plan_.banks_.end());
    return std::move(plan_);
  }

 private:
  [[noreturn]] void fail() const {
    throw platform::BoardError(
        findings_, plan_.product_ > 1
                       ? fmt::format("{}: the plan would have {} points", plan_.path_, plan_.size())
                       : "");
  }

  std::string place_text(const Place& place) const {  // "plan.yaml:3:9"
    return fmt::format("{}:{}:{}", plan_.path(), place.line, place.column);
  }
  void report(const Place& place, const std::string& text) { findings_.push_back({place_text(place), text}); }
  void report(const std::string& path, const YamlNode& node, const std::string& rule) {
    report(node.place, fmt::format("{} = {}: {}", path, short_text(node), rule));
  }
  void add(const std::vector<Diagnostic>& found) {
    findings_.insert(findings_.end(), found.begin(), found.end());
  }

  // Whether a value is a map; if it is not, reports it with `rule`. Reports repeated keys, and keys that are
  // not among `known`; without known keys all keys are allowed.
  bool is_map(const std::string& path, const YamlNode& node, const std::vector<std::string>& known,
              const std::string& rule) {
    if (!node.is_map()) {
      report(path.empty() ? "the plan" : path, node,
             known.empty() ? rule : fmt::format("{} of {}", rule, fmt::join(known, ", ")));
      return false;
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
    return true;
  }

  void read_base(const YamlNode& tree) {
    if (const auto* run = tree.find("run")) read_run(run->value);
    const auto* const named = tree.find("board");
    const YamlNode* const board = named == nullptr ? nullptr : &named->value;
    const bool is_option = !plan_.board_.empty();
    if (board == nullptr && !is_option)
      return report(tree.place, "board: missing: a preset, or the path of a board file");
    if (board != nullptr && (!board->is_scalar() || board->text.empty()))
      return report("board", *board, "a preset, or the path of a board file");
    const Place place = board == nullptr ? tree.place : board->place;
    if (!is_option) plan_.board_ = board->text;
    try {
      plan_.base_.emplace(plan_.board_, board_text_);
    } catch (const platform::BoardError& error) {
      for (const Diagnostic& problem : error.diagnostics()) {
        // The problem is in the name of the board, or in a line of its file.
        const bool is_of_name = problem.place == plan_.board_;
        const std::string text = fmt::format("board = {}: {}", plan_.board_, problem.text);
        add({!is_of_name ? problem
             : is_option ? Diagnostic{"--board", text}
                         : Diagnostic{place_text(place), text}});
      }
      return;
    }
    auto base = plan_.base_->read_with_problems();
    add(base.problems);
    if (!base.problems.empty()) return plan_.base_.reset();
    if (const auto* set = tree.find("set")) {
      if (!is_map("set", set->value, {}, "a map of keys of the board and their values")) return;
      for (const YamlNode::Entry& entry : set->value.entries) {
        take_path("set", entry.key);
        plan_.base_->replace(entry.key.text, entry.value, plan_.path_);
        take_banks(entry.key, {entry.value});
      }
    }
    base = plan_.base_->read_with_problems();
    const bool varies = tree.find("vary") != nullptr || tree.find("zip") != nullptr;
    bool is_wrong = false;
    for (const Diagnostic& problem : base.problems) {
      if (varies && problem.is_between_keys && !problem.is_missing) continue;  // a point may keep the rule
      add({problem});
      is_wrong = true;
    }
    if (is_wrong) return;
    for (const platform::BankConfig& bank : base.board.banks) take_bank(bank.name, place);
    plan_.base_board_ = std::move(base.board);
  }

  void read_run(const YamlNode& node) {
    if (!is_map("run", node, {"source", "frames", "calibration", "pairs", "synthetic"}, "a map")) return;
    for (const YamlNode::Entry& entry : node.entries) {
      const std::string path = "run." + entry.key.text;
      if (path == kPairsPath) read_pairs(entry.value);
      if (path == kSyntheticPath) read_seeds(entry.value);
      if (const std::string rule = run_key_problem(path, entry.value); !rule.empty()) {
        report(path, entry.value, rule);
        continue;
      }
      apply_run_key(path, entry.value, plan_.run_);
      if (path != kCalibrationPath) continue;
      plan_.calibration_ = entry.value.text;
      plan_.calibration_place_ = place_text(entry.value.place);
    }
    if (!plan_.pairs_.empty() && !plan_.seeds_.empty())
      report(node.place, fmt::format("{}: does not go with {}", kSyntheticPath, kPairsPath));
  }

  void read_pairs(const YamlNode& node) {
    if (!node.is_list() || node.items.empty())
      return report(kPairsPath, node, "a list of maps {left: FILE, right: FILE, truth: FILE, scale: NUMBER}");
    for (const YamlNode& item : node.items) {
      const std::string path = fmt::format("{}[{}]", kPairsPath, plan_.pairs_.size());
      if (!is_map(path, item, {"left", "right", "truth", "scale"}, "a map")) return;
      PlanPair& pair = plan_.pairs_.emplace_back();
      pair.place = place_text(item.place);
      for (const auto& [name, file] : {std::pair("left", &pair.left), std::pair("right", &pair.right),
                                       std::pair("truth", &pair.truth)}) {
        const YamlNode::Entry* const entry = item.find(name);
        if (entry == nullptr) {
          report(item.place, fmt::format("{}.{}: missing: the path of a picture", path, name));
        } else if (!entry->value.is_scalar() || entry->value.text.empty()) {
          report(fmt::format("{}.{}", path, name), entry->value, "the path of a picture");
        } else {
          *file = entry->value.text;
        }
      }
      const YamlNode::Entry* const scale = item.find("scale");
      if (scale == nullptr) continue;
      pair.scale = platform::decimal_of(scale->value);
      if (!(pair.scale.value_or(0) > 0))
        report(path + ".scale", scale->value, "a decimal number above 0: levels of the truth per disparity");
    }
  }

  void read_seeds(const YamlNode& node) {
    constexpr platform::IntegerRule kSeeds = {0, std::numeric_limits<std::int64_t>::max() - 1};
    if (!node.is_list() || node.items.empty())
      return report(kSyntheticPath, node, "a list of seeds, each " + kSeeds.text());
    for (const YamlNode& item : node.items) {
      const std::int64_t seed = platform::integer_of(item).value_or(-1);
      if (!kSeeds.allows(seed)) report(kSyntheticPath, item, kSeeds.text());
      plan_.seeds_.push_back(static_cast<std::uint64_t>(seed));
    }
    plan_.run_.synthetic = fmt::format("[{}]", fmt::join(plan_.seeds_, ", "));
  }

  // Records a path that occurs in a section of the plan. Reports a path that is not allowed in the section,
  // or that has occurred before; returns false for both. Also reports a path if the plan has another path
  // above or below it.
  bool take_path(const std::string& section, const YamlNode& key) {
    const std::string& path = key.text;
    const bool is_run = section != "set" && may_vary(path);
    const bool is_checked_later = section == "set";  // by the draft of the board
    const std::string rule = is_run || is_checked_later ? ""
                             : !run_key_meaning(path).empty()
                                 ? "can only be given in `run`: one for all points"
                                 : platform::path_problem(path);
    const auto [first, is_new] = places_.emplace(path, key.place);
    if (!rule.empty()) {
      report(key.place, fmt::format("{}: {}: {}", section, path, rule));
    } else if (!is_new) {
      report(key.place, fmt::format("{}: {}: given before, at {}:{}", section, path, first->second.line,
                                    first->second.column));
    }
    for (const auto& [other, place] : places_) {
      if (platform::is_below(path, other) || platform::is_below(other, path)) {
        report(key.place, fmt::format("{}: {}: overlaps {}, given at {}:{}", section, path, other, place.line,
                                      place.column));
      }
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
      report(place, bank_names_problem(known->second, name));
    }
  }

  void read_vary(const YamlNode& node) {
    if (!is_map("vary", node, {}, "a map of keys of the board and lists or ranges of their values")) return;
    for (const YamlNode::Entry& entry : node.entries) add_axis("vary", {entry});
  }

  void read_zip(const YamlNode& node) {
    if (!node.is_list()) return report("zip", node, "a list of maps; the keys of a map move together");
    for (const YamlNode& group : node.items) {
      if (is_map("zip", group, {}, "a map of keys that move together")) add_axis("zip", group.entries);
    }
  }

  void add_axis(const std::string& section, const std::vector<YamlNode::Entry>& entries) {
    Plan::Axis axis;
    for (const YamlNode::Entry& entry : entries) {
      if (!take_path(section, entry.key)) continue;
      auto values = values_of(section, entry);
      if (!values) continue;
      if (!axis.values.empty() && values->size() != axis.size()) {
        report(entry.value.place,
               fmt::format("{}: {}: {} values; must be as many as {} has, {}", section, entry.key.text,
                           values->size(), axis.paths.front(), axis.size()));
        continue;
      }
      axis.paths.push_back(entry.key.text);
      axis.values.push_back(std::move(*values));
    }
    if (!axis.values.empty()) plan_.axes_.push_back(std::move(axis));
  }

  // Reads the values of a key that varies, and reports each value that is wrong by itself. (A value that is
  // wrong only beside a value of another key makes points impossible.) If there are no values, reports that
  // and returns nullopt.
  std::optional<PlanValues> values_of(const std::string& section, const YamlNode::Entry& entry) {
    const std::string& path = entry.key.text;
    const YamlNode& node = entry.value;
    const std::string name = section + ": " + path;
    if (node.is_list() && !node.items.empty()) {
      for (const YamlNode& value : node.items) add(problems_of(path, value));
      take_banks(entry.key, node.items);
      return PlanValues{node.items};
    }
    if (!node.is_map() || node.find("from") == nullptr) {
      report(name, node, "a list of values, or a range such as {from: 16, to: 128, step: 16}");
      return std::nullopt;
    }
    const auto range = read_range(name, node);
    if (!range) return std::nullopt;
    take_banks(entry.key, {});
    check_range(name, path, node, *range);
    return range;
  }

  // Reads a range such as {from: 16, to: 128, step: 16}. If the value is no range, reports the problems and
  // returns nullopt. `name` is the name of the range in messages.
  std::optional<PlanValues> read_range(const std::string& name, const YamlNode& node) {
    constexpr std::array kKeys = {"from", "to", "step"};
    if (!is_map(name, node, {kKeys.begin(), kKeys.end()}, "a range")) return std::nullopt;
    const std::string rule = fmt::format("a decimal number of at most {} digits", kMostDigits);
    int places = 0;
    for (const YamlNode::Entry& entry : node.entries) places = std::max(places, places_of(entry.value.text));
    std::array<std::int64_t, kKeys.size()> numbers{};
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const std::string key = fmt::format("{}.{}", name, kKeys[i]);
      const YamlNode::Entry* const entry = node.find(kKeys[i]);
      if (entry == nullptr) {
        report(node.place, fmt::format("{}: missing: {}", key, rule));
        return std::nullopt;
      }
      const std::string& text = entry->value.text;
      if (!platform::decimal_of(entry->value) || digits_with(text, places_of(text)).size() > kMostDigits) {
        report(key, entry->value, rule);
        return std::nullopt;
      }
      const std::string digits = digits_with(text, places);
      if (digits.size() > kMostRangeDigits) {
        report(key, entry->value,
               fmt::format("at most {} digits, with the {} decimal places that the range has",
                           kMostRangeDigits, places));
        return std::nullopt;
      }
      numbers[i] = std::stoll(digits);
    }
    const auto [from, to, step] = numbers;
    const std::int64_t distance = to - from;
    if (step == 0 || (distance != 0 && (distance < 0) != (step < 0))) {
      report(fmt::format("{}.step", name), node.find("step")->value,
             distance < 0 ? "must be below 0: to is below from" : "must be above 0: to is not below from");
      return std::nullopt;
    }
    if (distance % step != 0 || distance / step >= kMostValues) {
      report(name, node,
             fmt::format("to must be from plus a number of steps, at most {} values", kMostValues));
      return std::nullopt;
    }
    return PlanValues{{}, from, step, static_cast<std::uint64_t>(distance / step) + 1, places, node.place};
  }

  // Reports all refused values of a range in one line.
  void check_range(const std::string& name, const std::string& path, const YamlNode& node,
                   const PlanValues& values) {
    const platform::Key* const key = platform::find_key(platform::schema_path(path));
    const auto allows = [&](const YamlNode& number) {
      if (path == kFramesPath) return kFramesRule.allows(platform::integer_of(number).value_or(0));
      return key == nullptr || key->rule.allows_number(number);
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
    report(name, node,
           fmt::format("{} of {} values refused, the first: {}", refused, values.size(),
                       problems.empty() ? first.text : problems.front().text));
  }

  std::vector<Diagnostic> problems_of(const std::string& path, const YamlNode& value) const {
    if (may_vary(path)) {
      const std::string rule = run_key_problem(path, value);
      if (rule.empty()) return {};
      return {{place_text(value.place), fmt::format("{} = {}: {}", path, short_text(value), rule)}};
    }
    if (!plan_.base_board_) return {};
    return plan_.base_->problems_of(path, value, plan_.path_);
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

  void read_wishes(const YamlNode& tree) {
    SearchWishes& wishes = plan_.wishes_;
    for (const char* const name : {"maximise", "minimise", "require"}) {
      const auto* const entry = tree.find(name);
      if (entry == nullptr) continue;
      plan_.wishes_place_ = fmt::format("{}: {}", place_text(entry->key.place), name);
      const std::vector<YamlNode> single = {entry->value};
      for (const YamlNode& item : entry->value.is_list() ? entry->value.items : single) {
        if (!item.is_scalar() || item.text.empty()) {
          report(name, item,
                 "a figure (see stereotlm keys --figures), a key, or an SQL expression over them");
          continue;
        }
        const Condition text = {item.text, place_text(item.place),
                                fmt::format("{} = {}", name, short_text(item))};
        if (name == std::string("require")) {
          wishes.requirements.push_back(text);
        } else {
          wishes.goals.push_back({text, name == std::string("maximise")});
        }
      }
    }
    const auto* const placements = tree.find("placements");
    if (placements == nullptr) return;
    plan_.wishes_place_ = fmt::format("{}: placements", place_text(placements->key.place));
    if (!is_map("placements", placements->value, {"banks", "stripes"}, "a map")) return;
    const auto read = [&](const char* name, const platform::IntegerRule& rule, int& value) {
      const YamlNode::Entry* const entry = placements->value.find(name);
      if (entry == nullptr) return;
      const std::int64_t number = platform::integer_of(entry->value).value_or(0);
      if (!rule.allows(number)) report(fmt::format("placements.{}", name), entry->value, rule.text());
      value = static_cast<int>(number);
    };
    read("banks", {1, 64}, wishes.most_banks);
    read("stripes", {1, 16}, wishes.most_parts);
    if (placements->value.find("banks") == nullptr)
      report(placements->value.place, "placements.banks: missing: the most banks that a board may use");
  }

  // Reports the keys that are missing in the first point, because they are missing in all points.
  void check_first_point() {
    const auto [draft, run] = plan_.combination(0);
    for (const Diagnostic& problem : draft.read_with_problems().problems) {
      if (!problem.is_between_keys) add({problem});
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
        add({{condition.place, condition.name + ": " + error.reason}});
      }
    }
  }

  void count_points() {
    for (const Plan::Axis& axis : plan_.axes_) {
      const std::uint64_t values = axis.size();
      if (plan_.product_ > kMostPoints / values) {
        add({{plan_.path_, "more than 2^62 points"}});
        plan_.product_ = 1;
        return;
      }
      plan_.product_ *= values;
    }
  }

  void read_sample(const YamlNode& node) {
    if (!is_map("sample", node, {"points", "seed"}, "a map")) return;
    const std::size_t before = findings_.size();
    const auto read = [&](const std::string& name, const platform::IntegerRule& rule) {
      const YamlNode::Entry* const entry = node.find(name);
      const std::int64_t number = entry == nullptr ? -1 : platform::integer_of(entry->value).value_or(-1);
      if (entry == nullptr) {
        report(node.place, fmt::format("sample.{}: missing: {}", name, rule.text()));
      } else if (!rule.allows(number)) {
        report("sample." + name, entry->value, rule.text());
      }
      return static_cast<std::uint64_t>(number);
    };
    const Plan::Sample sample = {read("points", {1, static_cast<std::int64_t>(plan_.product_)}),
                                 read("seed", {0, std::numeric_limits<std::int64_t>::max() - 1})};
    if (findings_.size() == before) plan_.sample_ = sample;
  }

  Plan plan_;
  const std::string* board_text_;  // see Plan::load()
  std::vector<Diagnostic> findings_;
  std::map<std::string, Place> places_;       // [path that occurs in the plan]
  std::map<std::string, std::string> banks_;  // [name without_case()]: name
};

Plan Plan::load(const std::string& path, const std::string& board, const std::string* text,
                const std::string* board_text) {
  return PlanReader(path, board, board_text).read(text);
}

}  // namespace stereotlm::explore
