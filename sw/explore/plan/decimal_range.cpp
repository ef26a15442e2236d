#include "sw/explore/plan/decimal_range.h"

#include <cstdlib>

#include "platform/config/yaml_values.h"

namespace stereotlm::explore {

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

int digits_with(const Decimal& value, int places) {
  return static_cast<int>(std::to_string(std::abs(value.digits)).size()) + places - value.places;
}

std::string DecimalRange::text(std::uint64_t number) const {
  const std::int64_t value = digits(number);
  std::string text = std::to_string(std::abs(value));
  const auto behind = static_cast<std::size_t>(places);
  if (text.size() <= behind) text.insert(0, behind + 1 - text.size(), '0');
  if (behind > 0) text.insert(text.size() - behind, ".");
  return (value < 0 ? "-" : "") + text;
}

}  // namespace stereotlm::explore
