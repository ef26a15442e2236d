#pragma once

#include <charconv>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "sw/process/problems.h"

namespace CLI {
class App;
}

namespace stereotlm::cli {

class Option;

// The number that the text represents; nullopt if the text is not exactly one number of this type.
template <typename Number>
std::optional<Number> number_of(std::string_view text) {
  Number number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

// Reports a problem if the option breaks the rule.
using Rule = std::function<void(const Option& option, process::Problems& problems)>;

// The option must be given. `what`: what its value is.
Rule required(const std::string& what);
// The following rules hold for the value of an option that is given.
Rule valid(const std::string& rule, const std::function<bool(const std::string& text)>& is_valid);
Rule one_of(const std::vector<std::string>& words);
inline constexpr const char* kSeedRule = "an integer, 0..2^64-1";
Rule ends_in(const std::string& ending);
template <typename Number>
Rule number(
    const std::string& rule, const std::function<bool(Number)>& is_valid = [](Number) { return true; }) {
  return valid(rule, [is_valid](const std::string& text) {
    const auto value = number_of<Number>(text);
    return value && is_valid(*value);
  });
}
// The option needs `other`, which messages quote with `value`. `other` must be a member of the same class as
// the option.
Rule goes_with(const Option& other, const std::string& value);

// The options of a command. A command derives a class from this one. Its members of type Option are the
// options, in the order of the help. It exists from before parsing to the end of the command.
class Options {
 public:
  explicit Options(CLI::App& command) : command_(&command) {}
  virtual ~Options() = default;
  Options(const Options&) = delete;
  Options& operator=(const Options&) = delete;

  // To be called once the command line is parsed. Checks the rules of all options, and those between options.
  // Throws Refused with all problems.
  void check_usage();

 protected:
  // Reports problems of several options together.
  virtual void check_together(process::Problems& /*problems*/) {}

 private:
  friend class Option;
  CLI::App* command_;  // valid until parsing ends
  std::vector<std::pair<const Option*, std::vector<Rule>>> rules_;
};

// The number of values of an option. kList takes all the words that follow it. kRepeated takes one word,
// and the option is given again for each further one.
enum class Takes { kOne, kOneOrTwo, kList, kRepeated };

// An option of the command line. Its values are kept as typed, so that messages can quote them. A command
// line with an option whose value is missing or empty is refused.
class Option {
 public:
  // Adds the option to the command of `of`. If `of` is null, no command has the option, and it is never
  // given. `name`: its names, separated by commas; messages use the first. Names without dashes make it
  // positional. `value`: the help's word for its value; empty: the option is a flag.
  Option(Options* of, const std::string& name, const std::string& value, const std::string& meaning,
         const std::vector<Rule>& rules = {}, Takes takes = Takes::kOne);
  Option(const Option&) = delete;
  Option& operator=(const Option&) = delete;

  bool is_given() const { return is_given_; }
  const std::string& name() const { return name_; }
  // The value of an option that takes one; empty if it is not given.
  const std::string& text() const { return text_; }
  // The values of an option that takes more.
  const std::vector<std::string>& texts() const { return texts_; }
  // nullopt if the option is not given, or its value is no such number.
  template <typename Number>
  std::optional<Number> number() const {
    return number_of<Number>(text_);
  }

 private:
  std::string name_;
  std::string text_;
  std::vector<std::string> texts_;
  bool is_given_ = false;
};

// The option --json: the command prints one JSON document instead of its text. Its keys have the style of
// stats.json; `keys --schema COMMAND` prints its schema.
struct JsonOption : Option {
  explicit JsonOption(Options* of) : Option(of, "--json", "", "Print one JSON document instead of text") {}
};

// The option --source, with the values "camera" and "preloaded".
struct SourceOption : Option {
  explicit SourceOption(
      Options* of,
      const std::string& meaning = "The whole computer, the default, or the core alone, fed by an ideal host")
      : Option(of, "--source", "camera|preloaded", meaning, {one_of({"camera", "preloaded"})}) {}
  bool is_camera() const { return text() != "preloaded"; }
};

}  // namespace stereotlm::cli
