#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "platform/config/yaml_tree.h"

namespace stereotlm::explore {

// A decimal number as an integer and a number of digits behind the point.
struct Decimal {
  std::int64_t digits = 0;
  int places = 0;
};

// A decimal number of at most kMostDigits digits (see platform::decimal_of); nullopt for anything else.
inline constexpr int kMostDigits = 15;
std::optional<Decimal> exact_decimal(const platform::YamlNode& node);

// How many digits it has if it is written with so many places.
int digits_with(const Decimal& value, int places);

// from, from + step, .. : `count` numbers with as many places each, exactly.
struct DecimalRange {
  std::int64_t from = 0;
  std::int64_t step = 1;
  std::uint64_t count = 0;
  int places = 0;

  std::int64_t digits(std::uint64_t number) const { return from + static_cast<std::int64_t>(number) * step; }
  // As a board has it, such as "39.9".
  std::string text(std::uint64_t number) const;
};

}  // namespace stereotlm::explore
