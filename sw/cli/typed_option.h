#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "platform/config/board_keys.h"
#include "sw/process/problems.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace stereotlm::cli {

// An option as it was typed. Between add_to() and the end of parsing, which writes to it, it stays where it
// is.
template <typename Text>
struct TypedOption {
  Text text;

  // Adds it to the command, before that is parsed. A name without dashes is that of an argument.
  void add_to(CLI::App& command, const std::string& name, const std::string& value,
              const std::string& meaning);
  // Of a list: how many values; -1: any number.
  void takes(int least, int most);
  // Of a list: one value each time that it is given, any number of times.
  void takes_one_at_a_time();

  bool is_given() const { return is_given_; }

 private:
  CLI::Option* option_ = nullptr;  // while the command is set up: its CLI::App goes when it is parsed
  bool is_given_ = false;
};
using Typed = TypedOption<std::string>;
using TypedList = TypedOption<std::vector<std::string>>;

// The whole text as a number.
template <typename Number>
std::optional<Number> number_of(std::string_view text) {
  Number number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

// False, and reported, if the text is none of the values.
inline bool is_one_of(const std::vector<std::string>& values, const std::string& name,
                      const std::string& text, process::Problems& problems) {
  if (std::find(values.begin(), values.end(), text) != values.end()) return true;
  problems.add(fmt::format("{} = {}: must be {}", name, text, platform::listed(values)));
  return false;
}

}  // namespace stereotlm::cli
