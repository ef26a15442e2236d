#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "platform/yaml/yaml_tree.h"
#include "sw/explore/plan/plan_findings.h"

namespace stereotlm::explore {

// A range of `count` exact decimal numbers: from, from + step, and so on. All have the same number of places.
struct DecimalRange {
  std::int64_t from = 0;  // digits without the decimal point
  std::int64_t step = 1;
  std::uint64_t count = 0;
  int places = 0;  // digits behind the decimal point

  std::int64_t digits(std::uint64_t number) const { return from + static_cast<std::int64_t>(number) * step; }
  // The number as a board file has it, such as "39.9".
  std::string text(std::uint64_t number) const;
};

// Reads a range such as {from: 16, to: 128, step: 16}. If the value is no range, reports the problems and
// returns nullopt. `name` is the name of the range in messages.
std::optional<DecimalRange> read_range(const std::string& name, const platform::YamlNode& node,
                                       PlanFindings& findings);

// The values that a plan gives one key: a list, or a range, whose values are made one by one.
class PlanValues {
 public:
  explicit PlanValues(std::vector<platform::YamlNode> list) : list_(std::move(list)) {}
  PlanValues(const DecimalRange& range, const platform::Place& place) : range_(range), place_(place) {}

  std::uint64_t size() const { return range_ ? range_->count : list_.size(); }
  platform::YamlNode at(std::uint64_t number) const;

 private:
  std::vector<platform::YamlNode> list_;
  std::optional<DecimalRange> range_;
  platform::Place place_;  // of the range
};

}  // namespace stereotlm::explore
