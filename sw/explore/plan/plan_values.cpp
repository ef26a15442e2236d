#include "sw/explore/plan/plan_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>

#include "platform/yaml/yaml_tree.h"

namespace stereotlm::explore {
namespace {

constexpr std::int64_t kMostValues = 1'000'000;  // of one range
constexpr int kMostDigits = 15;                  // of a number as the plan has it
constexpr int kMostRangeDigits = 18;  // of a number that is written with as many places as its range has

// A decimal number: an integer, and the number of its digits behind the decimal point.
struct Decimal {
  std::int64_t digits = 0;
  int places = 0;
};

// The exact value of a node; nullopt if it is not a decimal number (see platform::decimal_of()) of at most
// kMostDigits digits.
std::optional<Decimal> exact_decimal(const platform::YamlNode& node) {
  if (!platform::decimal_of(node)) return std::nullopt;
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

// The number of digits of a value that is written with `places` places.
int digits_with(const Decimal& value, int places) {
  return static_cast<int>(std::to_string(std::abs(value.digits)).size()) + places - value.places;
}

}  // namespace

std::string DecimalRange::text(std::uint64_t number) const {
  const std::int64_t value = digits(number);
  std::string text = std::to_string(std::abs(value));
  const auto behind = static_cast<std::size_t>(places);
  if (text.size() <= behind) text.insert(0, behind + 1 - text.size(), '0');
  if (behind > 0) text.insert(text.size() - behind, ".");
  return (value < 0 ? "-" : "") + text;
}

std::optional<DecimalRange> read_range(const std::string& name, const platform::YamlNode& node,
                                       PlanFindings& findings) {
  constexpr std::array kKeys = {"from", "to", "step"};
  if (findings.read_map(name, node, {kKeys.begin(), kKeys.end()}, "a range") == nullptr) return std::nullopt;
  const std::string rule = fmt::format("a decimal number of at most {} digits", kMostDigits);
  std::array<Decimal, kKeys.size()> numbers;
  int places = 0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const platform::YamlNode::Entry* const entry = node.find(kKeys[i]);
    if (entry == nullptr) {
      findings.report(node.place, fmt::format("{}.{}: missing: {}", name, kKeys[i], rule));
      return std::nullopt;
    }
    const auto number = exact_decimal(entry->value);
    if (!number) {
      findings.report(fmt::format("{}.{}", name, kKeys[i]), entry->value, rule);
      return std::nullopt;
    }
    numbers[i] = *number;
    places = std::max(places, number->places);
  }
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (digits_with(numbers[i], places) > kMostRangeDigits) {
      findings.report(fmt::format("{}.{}", name, kKeys[i]), node.find(kKeys[i])->value,
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
    findings.report(name, node,
                    fmt::format("to must be from plus a number of steps, at most {} values", kMostValues));
    return std::nullopt;
  }
  return DecimalRange{from.digits, step.digits, static_cast<std::uint64_t>(distance / step.digits) + 1,
                      places};
}

platform::YamlNode PlanValues::at(std::uint64_t number) const {
  return range_ ? platform::YamlNode::plain(range_->text(number), place_) : list_.at(number);
}

}  // namespace stereotlm::explore
