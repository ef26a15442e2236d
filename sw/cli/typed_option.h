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

// An option of the command line whose value is kept as typed, so that the command can check it and quote it
// in messages. The parser writes to the object, so it must not be moved between add_to() and the end of
// parsing.
template <typename Text>
struct TypedOption {
  Text text;

  // Adds the option to the command, before parsing. A name without dashes is a positional argument.
  void add_to(CLI::App& command, const std::string& name, const std::string& value,
              const std::string& meaning);
  // For a list: sets the least and the most number of values. most = -1: no limit.
  void takes(int least, int most);
  // For a list: the option takes one value and may be repeated.
  void takes_one_at_a_time();

  bool is_given() const { return is_given_; }

 private:
  CLI::Option* option_ = nullptr;  // valid until parsing ends, with its CLI::App
  bool is_given_ = false;
};
using Typed = TypedOption<std::string>;
using TypedList = TypedOption<std::vector<std::string>>;

// The number that the text represents; nullopt if the text is not exactly one number of this type.
template <typename Number>
std::optional<Number> number_of(std::string_view text) {
  Number number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

// Returns whether `text`, the value of the option `name`, is one of `values`. If not, reports a problem.
inline bool is_one_of(const std::vector<std::string>& values, const std::string& name,
                      const std::string& text, process::Problems& problems) {
  if (std::find(values.begin(), values.end(), text) != values.end()) return true;
  problems.add(fmt::format("{} = {}: must be {}", name, text, platform::listed(values)));
  return false;
}

}  // namespace stereotlm::cli
