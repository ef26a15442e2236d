#include "sw/files/json_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace stereotlm::files {
namespace {

using Json = nlohmann::ordered_json;

std::string scalar_text(const Json& value, Json::error_handler_t handler) {
  if (value.is_number_float()) {
    const double number = value.get<double>();
    if (!std::isfinite(number))
      throw std::invalid_argument(fmt::format("{}: JSON numbers are finite", number));
    return fmt::format("{}", number);
  }
  try {
    return value.dump(-1, ' ', false, handler);
  } catch (const Json::type_error&) {
    throw std::invalid_argument(fmt::format("'{}': JSON strings are UTF-8", value.get<std::string>()));
  }
}

void append(std::string& text, const Json& value, std::size_t depth, Json::error_handler_t handler) {
  if (!value.is_structured()) {
    text += scalar_text(value, handler);
    return;
  }
  const bool one_line =
      value.empty() || (depth > 0 && std::none_of(value.begin(), value.end(),
                                                  [](const Json& member) { return member.is_structured(); }));
  const std::string indent = one_line ? "" : "\n" + std::string(2 * (depth + 1), ' ');
  const char* separator = "";
  text += value.is_object() ? '{' : '[';
  for (const auto& [key, member] : value.items()) {
    text += separator + indent;
    if (value.is_object()) text += scalar_text(key, handler) + ": ";
    append(text, member, depth + 1, handler);
    separator = one_line ? ", " : ",";
  }
  if (!one_line) text += "\n" + std::string(2 * depth, ' ');
  text += value.is_object() ? '}' : ']';
}

}  // namespace

std::string json_text(const Json& document, Json::error_handler_t handler) {
  std::string text;
  append(text, document, 0, handler);
  return text + "\n";
}

}  // namespace stereotlm::files
