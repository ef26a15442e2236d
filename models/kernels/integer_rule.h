#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace stereotlm::kernels {

// The allowed values of an integer field: min, min + step, .. up to max; or only powers of two among them.
struct IntegerRule {
  std::int64_t min;              // the least value
  std::int64_t max;              // the greatest value
  std::int64_t step = 1;         // between allowed values
  bool is_power_of_two = false;  // only 1, 2, 4, .. are allowed

  constexpr bool allows(std::int64_t value) const {  // whether the value keeps the rule
    const bool is_power = value > 0 && (value & (value - 1)) == 0;
    return value >= min && value <= max && (value - min) % step == 0 && (is_power || !is_power_of_two);
  }

  // Such as "4..2048, a multiple of 4".
  std::string text() const {
    std::string out = std::to_string(min) + ".." + std::to_string(max);
    if (step == 2 && min % 2 != 0) out += ", odd";
    if (step > 1 && min % step == 0) out += ", a multiple of " + std::to_string(step);
    if (is_power_of_two) out += ", a power of two";
    return out;
  }

  // Such as "window = 4: must be 3..31, odd".
  std::string problem(const std::string& field, std::int64_t value) const {
    return field + " = " + std::to_string(value) + ": must be " + text();
  }
  // Adds the problem, if there is one.
  void check(const std::string& field, std::int64_t value, std::vector<std::string>& problems) const {
    if (!allows(value)) problems.push_back(problem(field, value));
  }
  // Throws std::invalid_argument if the value is not allowed; else returns it.
  template <class Integer>
  Integer required(const std::string& field, Integer value) const {
    const auto number = static_cast<std::int64_t>(value);
    if (!allows(number)) throw std::invalid_argument(problem(field, number));
    return value;
  }
};

}  // namespace stereotlm::kernels
