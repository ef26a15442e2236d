#include "sw/explore/plan/plan_values.h"

#include "platform/config/yaml_values.h"

namespace stereotlm::explore {
namespace {

platform::YamlNode scalar(const std::string& text, const platform::Place& place) {
  platform::YamlNode node;
  node.kind = platform::YamlNode::Kind::kScalar;
  node.place = place;
  node.text = text;
  return node;
}

template <typename Allows>
RefusedOfRange count_refused(const DecimalRange& range, const Allows& allows) {
  RefusedOfRange refused;
  for (std::uint64_t i = 0; i < range.count; ++i) {
    if (!allows(i) && refused.count++ == 0) refused.first = i;
  }
  return refused;
}

}  // namespace

platform::YamlNode PlanValues::at(std::uint64_t number) const {
  return range_ ? scalar(range_->text(number), place_) : list_.at(number);
}

RefusedOfRange refused_of(const DecimalRange& range, const platform::IntegerRule& rule) {
  if (range.places > 0) return {range.count, 0};  // "7.0" is no integer
  return count_refused(range, [&](std::uint64_t number) { return rule.allows(range.digits(number)); });
}

// With both ends it takes all between them.
RefusedOfRange refused_of(const DecimalRange& range, const platform::DecimalKey& rule) {
  const auto allows = [&](std::uint64_t number) {
    return rule.allows(platform::decimal_of(scalar(range.text(number), {})).value());
  };
  if (allows(0) && allows(range.count - 1)) return {};
  return count_refused(range, allows);
}

}  // namespace stereotlm::explore
