#include "platform/config/yaml_values.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <limits>
#include <system_error>

namespace stereotlm::platform {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool is_integer(std::string_view text) {
  if (!text.empty() && text.front() == '-') text.remove_prefix(1);
  return !text.empty() && std::all_of(text.begin(), text.end(), is_digit);
}

bool is_decimal(std::string_view text) {
  const std::size_t point = text.find('.');
  if (point == std::string_view::npos) return is_integer(text);
  const std::string_view fraction = text.substr(point + 1);
  return is_integer(text.substr(0, point)) && !fraction.empty() &&
         std::all_of(fraction.begin(), fraction.end(), is_digit);
}

std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

template <std::size_t kSize>
bool is_one_of(const std::string& text, const std::array<std::string_view, kSize>& words) {
  return std::find(words.begin(), words.end(), text) != words.end();
}

// Whether YAML 1.1 or 1.2 reads the text as a number: 7, +7, 0x1F, 0o17, 1_000, 1., .5, 1e3, .inf, .nan.
bool looks_like_number(const std::string& text) {
  const std::string lower_text = lower(text);
  std::string_view rest = lower_text;
  if (!rest.empty() && (rest.front() == '-' || rest.front() == '+')) rest.remove_prefix(1);
  if (rest == ".inf" || rest == ".nan") return true;
  const std::string_view prefix = rest.substr(0, 2);
  if (prefix == "0x" || prefix == "0o" || prefix == "0b") {
    return rest.size() > 2 && rest.find_first_not_of("0123456789abcdef_", 2) == std::string_view::npos;
  }
  const std::size_t exponent = rest.find('e');
  if (exponent != std::string_view::npos) {
    std::string_view power = rest.substr(exponent + 1);
    if (!power.empty() && (power.front() == '-' || power.front() == '+')) power.remove_prefix(1);
    if (power.empty() || !std::all_of(power.begin(), power.end(), is_digit)) return false;
    rest = rest.substr(0, exponent);
  }
  const bool has_digit = std::any_of(rest.begin(), rest.end(), is_digit);
  return has_digit && rest.front() != '_' && std::count(rest.begin(), rest.end(), '.') <= 1 &&
         rest.find_first_not_of("0123456789_.") == std::string_view::npos;
}

}  // namespace

std::optional<std::int64_t> integer_of(const YamlNode& node) {
  if (!node.is_scalar() || node.quoted || !is_integer(node.text)) return std::nullopt;
  std::int64_t value = 0;
  const auto result = std::from_chars(node.text.data(), node.text.data() + node.text.size(), value);
  if (result.ec == std::errc::result_out_of_range) {
    using Limits = std::numeric_limits<std::int64_t>;
    return node.text.front() == '-' ? Limits::min() : Limits::max();
  }
  return value;
}

std::optional<double> decimal_of(const YamlNode& node) {
  if (!node.is_scalar() || node.quoted || !is_decimal(node.text)) return std::nullopt;
  double value = 0;
  const auto result = std::from_chars(node.text.data(), node.text.data() + node.text.size(), value);
  // The number is too large for double, or so small that it rounds to 0.
  if (result.ec == std::errc::result_out_of_range) {
    const bool is_large = node.text.find_first_not_of("-0") < node.text.find('.');
    return is_large ? std::numeric_limits<double>::infinity() : 0.0;
  }
  return value;
}

std::string decimal_text(double value) {
  std::array<char, 400> text{};  // the longest number has about 330 characters
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
  return {text.data(), result.ptr};
}

bool is_text(const YamlNode& node) {
  constexpr std::array<std::string_view, 2> kTruth = {"true", "false"};
  return node.is_scalar() &&
         (node.quoted || (!looks_like_number(node.text) && !is_one_of(lower(node.text), kTruth)));
}

std::string scalar_text(const std::string& text) {
  constexpr std::array<std::string_view, 10> kReserved = {"y",  "n",   "yes",  "no",   "true",
                                                          "on", "off", "null", "none", "false"};
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  const bool is_plain =
      !text.empty() && is_letter(text[0]) && std::all_of(text.begin(), text.end(), [&](char c) {
        return is_letter(c) || is_digit(c) || c == '_' || c == '-';
      });
  return is_plain && !is_one_of(lower(text), kReserved) ? text : quoted_text(text);
}

}  // namespace stereotlm::platform
