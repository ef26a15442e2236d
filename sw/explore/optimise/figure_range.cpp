#include "sw/explore/optimise/figure_range.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <regex>

#include "platform/config/board_area.h"
#include "platform/config/board_keys.h"
#include "platform/config/buffer_layout.h"
#include "platform/yaml/words.h"
#include "sw/stats/figures.h"

namespace stereotlm::explore {
namespace {

std::optional<double> number_of(const platform::KeyValue& value) {
  if (const auto* const integer = std::get_if<std::int64_t>(&value)) return static_cast<double>(*integer);
  if (const auto* const decimal = std::get_if<double>(&value)) return *decimal;
  return std::nullopt;
}

}  // namespace

std::vector<std::string> names_in(const std::string& text) {
  std::vector<std::string> names;
  for (const NamePlace& name : names_at(text))
    names.push_back(text.substr(name.begin, name.end - name.begin));
  return names;
}

std::string name_of_bank(const std::string& text) {
  for (const std::string& name : names_in(text)) {
    const std::string plain = without_case(name);
    for (const char* const section : {"allocation", "banks"}) {
      if (plain == section || platform::is_below(plain, section)) return name;
    }
  }
  return "";
}

namespace {

// The names, numbers and operators of an SQL text.
std::vector<std::string> tokens_of(const std::string& text) {
  std::vector<std::string> tokens;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = at;
    const auto is_of_word = [&] {
      const auto c = static_cast<unsigned char>(text[end]);
      return std::isalnum(c) != 0 || c == '_' || c == '.';
    };
    while (end < text.size() && is_of_word()) ++end;
    if (end == at)
      end += std::strchr("<>=!|-/", text[at]) != nullptr &&
                     std::strchr("<>=|-*", at + 1 < text.size() ? text[at + 1] : ' ') != nullptr
                 ? 2
                 : 1;
    if (std::isspace(static_cast<unsigned char>(text[at])) == 0) tokens.push_back(text.substr(at, end - at));
    at = end;
  }
  return tokens;
}

// Whether it is sure that an expression rises all the way with this figure, or falls: the figure is in it
// once, with numbers, other names, + - * /, brackets, comparisons, round(), min() and max(). A quotient may
// jump at one place, which range_along() sees. So what it is divided by has the figure only if none of the
// last four is there. Behind a comma, round() may take the figure for a number of decimals.
bool is_monotone(const std::string& text, const std::string& figure) {
  static const std::set<std::string> kSigns = {"+", "-", "*", "/", "(", ")", ","};
  static const std::set<std::string> kSteps = {"round", "min", "max", "<", "<=", ">", ">="};
  const std::vector<std::string> tokens = tokens_of(text);
  bool has_step = false;
  bool divides = false;
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    const std::string& token = tokens[i];
    const bool is_name = stats::find_figure(token) != nullptr || platform::find_key(token) != nullptr;
    const bool is_number = std::isdigit(static_cast<unsigned char>(token[0])) != 0;
    const bool is_step = kSteps.count(token) > 0;
    if (!is_name && !is_number && !is_step && kSigns.count(token) == 0) return false;
    has_step = has_step || is_step;
    divides = divides || (i > 0 && tokens[i - 1] == "/" && !is_number && (!is_name || token == figure));
  }
  const auto place = std::find(tokens.begin(), tokens.end(), figure);
  const bool may_be_decimals =
      std::count(tokens.begin(), tokens.end(), "round") > 0 && std::count(tokens.begin(), place, ",") > 0;
  return std::count(tokens.begin(), tokens.end(), figure) == 1 && !(has_step && divides) && !may_be_decimals;
}

}  // namespace

// FIGURE < NUMBER, and the like.
struct Expression::Comparison {
  std::string figure;
  std::string sign;
  double number;

  static std::unique_ptr<Comparison> read(const std::string& text, const std::set<std::string>& figures) {
    static const std::regex kForm(R"(\s*([A-Za-z_][\w.]*)\s*(<=|>=|==|=|<|>)\s*(-?\d+(?:\.\d+)?)\s*)");
    constexpr std::size_t kMostBytes = 200;  // std::regex takes stack for each
    std::smatch parts;
    if (text.size() > kMostBytes || !std::regex_match(text, parts, kForm) || figures.count(parts[1]) == 0)
      return nullptr;
    return std::make_unique<Comparison>(Comparison{parts[1], parts[2], std::stod(parts[3])});
  }

  std::optional<bool> of(const Range& range) const {
    const auto both = [](bool of_least, bool of_most) {
      return of_least == of_most ? std::optional(of_least) : std::nullopt;
    };
    if (sign == "<") return both(range.least < number, range.most < number);
    if (sign == "<=") return both(range.least <= number, range.most <= number);
    if (sign == ">") return both(range.least > number, range.most > number);
    if (sign == ">=") return both(range.least >= number, range.most >= number);
    if (range.is_exact()) return range.least == number;
    return range.least > number || range.most < number ? std::optional(false) : std::nullopt;
  }
};

Expression::Expression(Expression&& other) noexcept = default;
Expression::~Expression() = default;

Expression::Expression(const Condition& condition, const std::set<std::string>& figures)
    : condition_(condition) {
  const std::string& text = condition_.text;
  key_ = platform::find_key(text);
  if (key_ != nullptr && !platform::has_value(*key_)) key_ = nullptr;
  is_figure_ = figures.count(text) > 0;
  for (const std::string& name : names_in(text)) {
    if (figures.count(name) > 0) used_.insert(name);
  }
  name_of_bank_ = explore::name_of_bank(text);
  comparison_ = Comparison::read(text, figures);
  if (key_ == nullptr && !is_figure_ && comparison_ == nullptr)
    Conditions({condition_}, {used_.begin(), used_.end()});  // throws if it is no expression
}

bool Expression::is_fixed() const {
  const auto& without = figures_without_simulation();
  return std::all_of(used_.begin(), used_.end(), [&without](const std::string& name) {
    return std::find(without.begin(), without.end(), name) != without.end();
  });
}

Range narrowed(const Range& proven, double rate, double uncertainty) {
  constexpr double kRounding = 1e-9;
  if (proven.is_exact()) return proven;
  const Range both = {std::max(rate - uncertainty, proven.least), std::min(rate + uncertainty, proven.most)};
  if (both.least <= both.most) return both;
  return both.least - both.most < kRounding * rate ? Range::of(both.most) : proven;
}

Range Known::range(const std::string& figure) const {
  if (const auto found = without_simulation.find(figure); found != without_simulation.end())
    return found->second;
  const auto found = others.find(figure);
  return found == others.end() ? Range() : found->second;
}

// By SQLite. All figures that it names are exact. nullopt: NULL.
std::optional<double> Expression::computed(const Known& known) {
  std::vector<platform::BoardValue> values = {{kSourcePath, known.run.camera ? "camera" : "preloaded"},
                                              {kFramesPath, static_cast<std::int64_t>(known.run.frames)}};
  for (const std::string& name : used_) values.push_back({name, known.range(name).least});
  if (!sql_)
    sql_ = std::make_unique<Conditions>(std::vector<Condition>{condition_},
                                        std::vector<std::string>{used_.begin(), used_.end()});
  return sql_->number(known.board, std::move(values));
}

// The values at places of the range of this figure, which alone is not exact, from end to end. Empty if the
// range has no end, or a value is NULL.
std::vector<double> Expression::values_along(const Known& known, const std::string& figure) {
  constexpr int kSteps = 8;
  const Range along = known.range(figure);
  if (!std::isfinite(along.least) || !std::isfinite(along.most)) return {};
  Known now = known;
  std::vector<double> values;
  for (int step = 0; step <= kSteps; ++step) {
    const double share = static_cast<double>(step) / kSteps;
    now.others[figure] = Range::of(along.least * (1 - share) + along.most * share);
    const auto value = computed(now);
    if (!value) return {};
    values.push_back(*value);
  }
  return values;
}

// What it can be if this figure alone is not exact.
Range Expression::range_along(const Known& known, const std::string& figure) {
  if (!is_monotone(condition_.text, figure)) return {};
  const std::vector<double> values = values_along(known, figure);
  if (values.empty()) return {};
  if (std::is_sorted(values.begin(), values.end())) return {values.front(), values.back()};
  if (std::is_sorted(values.rbegin(), values.rend())) return {values.back(), values.front()};
  return {};
}

Range Expression::range(const Known& known) {
  if (is_figure_) return known.range(condition_.text);
  std::vector<std::string> open;
  for (const std::string& name : used_) {
    if (!known.range(name).is_exact()) open.push_back(name);
  }
  if (open.size() > 1) return {};
  if (!open.empty()) return range_along(known, open.front());
  const auto number = key_ != nullptr ? number_of(platform::value_of(*key_, known.board)) : computed(known);
  if (number) return Range::of(*number);
  throw ConditionError(fmt::format("{}: {}: not a number on each board", condition_.place, condition_.name),
                       "not a number on each board");
}

std::optional<bool> Expression::holds(const Known& known) {
  if (comparison_) return comparison_->of(known.range(comparison_->figure));
  std::vector<std::string> open;
  for (const std::string& name : used_) {
    if (!known.range(name).is_exact()) open.push_back(name);
  }
  if (open.empty()) return computed(known).value_or(0) != 0;
  if (open.size() > 1) return std::nullopt;
  const auto values = values_along(known, open.front());
  const bool hold = std::all_of(values.begin(), values.end(), [](double value) { return value != 0; });
  return hold && !values.empty() ? std::optional(true) : std::nullopt;
}

const std::vector<std::string>& accuracy_figures() {
  static const std::vector<std::string> kNames = {"accuracy.bad_1_percent", "accuracy.bad_2_percent",
                                                  "accuracy.answered_percent"};
  return kNames;
}

const std::vector<std::string>& figures_without_simulation() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names = {"area.lut_equivalents",
                                      "area.slices",
                                      "area.slices_percent",
                                      "area.luts",
                                      "area.flip_flops",
                                      "area.block_rams",
                                      "area.block_rams_percent",
                                      "area.multipliers",
                                      "area.multipliers_percent",
                                      "pins",
                                      "banks_used",
                                      "area.pins",
                                      "area.pins_percent"};
    names.insert(names.end(), accuracy_figures().begin(), accuracy_figures().end());
    return names;
  }();
  return kNames;
}

// Those of the first names; of the last two only if the board has them.
FigureRanges figures_without_simulation(const platform::BoardConfig& board) {
  const area::Area its = platform::area_of(board);
  const std::vector<bool> used = platform::used_banks(board);
  std::vector<double> values = {
      static_cast<double>(its.lut_equivalents),
      static_cast<double>(its.slices),
      its.slices_percent,
      static_cast<double>(its.luts),
      static_cast<double>(its.flip_flops),
      static_cast<double>(its.block_rams),
      its.block_rams_percent,
      static_cast<double>(its.multipliers),
      its.multipliers_percent,
      static_cast<double>(platform::pins_of(board)),
      static_cast<double>(std::count(used.begin(), used.end(), true)),
  };
  if (its.pins && its.pins_percent) {
    values.push_back(static_cast<double>(*its.pins));
    values.push_back(*its.pins_percent);
  }
  FigureRanges figures;
  for (std::size_t i = 0; i < values.size(); ++i)
    figures.emplace(figures_without_simulation()[i], Range::of(values[i]));
  return figures;
}

}  // namespace stereotlm::explore
