#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "platform/config/board_keys.h"
#include "platform/config/yaml_tree.h"
#include "sw/explore/plan/decimal_range.h"

namespace stereotlm::explore {

// The values that a plan gives one key: a list, or a range, whose values are made one by one by at().
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

// How many numbers of a range break a rule.
struct RefusedOfRange {
  std::uint64_t count = 0;
  std::uint64_t first = 0;  // the place of the first in the range
};
RefusedOfRange refused_of(const DecimalRange& range, const platform::IntegerRule& rule);
RefusedOfRange refused_of(const DecimalRange& range, const platform::DecimalKey& rule);

}  // namespace stereotlm::explore
