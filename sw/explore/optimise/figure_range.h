#pragma once

#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "sw/explore/plan/plan.h"
#include "sw/explore/plan/points.h"

namespace stereotlm::explore {

// What a figure can be, as far as is known: any number from `least` to `most`.
struct Range {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();

  static Range of(double value) { return {value, value}; }
  bool is_exact() const { return least == most; }
};

// What is known of a rate in the long run: by what is proven, and by a measured rate with its uncertainty. If
// the two contradict each other, by more than rounding, what is proven holds.
Range narrowed(const Range& proven, double rate, double uncertainty);

using FigureRanges = std::map<std::string, Range>;  // by name; one that is missing can have any value

// What is known of a board.
struct Known {
  const platform::BoardConfig& board;  // with its buffers placed
  const PointRun& run;
  const FigureRanges& without_simulation;
  FigureRanges others = {};

  Range range(const std::string& figure) const;
};

// A figure, a key, or an SQL expression over them, for a goal or a requirement of a search.
class Expression {
 public:
  // `place`, `section`: for messages. `is_figure`: whether a name, if it is no key, is a figure. Throws
  // platform::BoardError if the text is no such expression.
  Expression(const Condition& condition, const std::set<std::string>& figures);
  Expression(Expression&& other) noexcept;
  ~Expression();

  const std::string& text() const { return condition_.text; }
  // The figures that it names, that are no keys.
  const std::set<std::string>& figures() const { return used_; }
  // A name in it that depends on the names of banks; empty if there is none.
  const std::string& name_of_bank() const { return name_of_bank_; }
  // Whether no simulation is needed.
  bool is_fixed() const;

  // If one figure in it is not exact, what lies between the values at both ends of its range. Any number if
  // it is not sure that the expression rises or falls all the way between, or several figures are not exact.
  // Throws ConditionError if SQLite cannot compute it, or it is no number.
  Range range(const Known& known);
  // Of a condition: whether it is true; nullopt: not known. If one figure in it is not exact, it is true if
  // it is at both ends of its range and at seven places between, which is not asked of FIGURE < NUMBER.
  std::optional<bool> holds(const Known& known);

 private:
  struct Comparison;

  std::optional<double> computed(const Known& known);
  std::vector<double> values_along(const Known& known, const std::string& figure);
  Range range_along(const Known& known, const std::string& figure);
  Condition condition_;
  std::set<std::string> used_;
  std::string name_of_bank_;
  const platform::Key* key_ = nullptr;      // the expression is this key alone
  bool is_figure_ = false;                  // the expression is one figure alone
  std::unique_ptr<Comparison> comparison_;  // of one figure with a number; else null
  std::unique_ptr<Conditions> sql_;         // made when it is needed, after a fork
};

// The names in an SQL text, such as "image.width", outside its quoted texts.
std::vector<std::string> names_in(const std::string& text);
// The first of them that depends on the names of banks; empty if there is none.
std::string name_of_bank(const std::string& text);

// The accuracy of the disparities, which follows from the pixels alone.
const std::vector<std::string>& accuracy_figures();

// The figures of a board that need no simulation: area, pins, banks in use, accuracy.
const std::vector<std::string>& figures_without_simulation();
// Those of them that need no pictures.
FigureRanges figures_without_simulation(const platform::BoardConfig& board);

}  // namespace stereotlm::explore
