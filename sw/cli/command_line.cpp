#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <sstream>
#include <string_view>
#include <systemc>

#include "platform/config/board_keys.h"
#include "sw/cli/command.h"
#include "sw/process/client.h"
#include "sw/process/command.h"
#include "sw/process/problems.h"
#include "sw/process/streams.h"

namespace stereotlm::cli {
namespace {

// CLI11's formatter with descriptions wrapped to kTextColumns columns.
class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() { label("SUBCOMMAND", "COMMAND"); }

  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    return paragraph("  " + make_option_name(option, is_positional) + make_option_opts(option), kIndent,
                     make_option_desc(option));
  }
  std::string make_subcommand(const CLI::App* command) const override {
    return paragraph("  " + command->get_name(), kIndent, command->get_description());
  }
  // All positional arguments, such as BOARD, are required: no brackets around their names.
  std::string make_option_usage(const CLI::Option* option) const override { return option->get_name(); }

 private:
  static constexpr std::size_t kIndent = 30;
};

// Checks that the first argument is a command, or requests help or the version.
void check_first_argument(const CLI::App& program, int argc, const char* const* argv) {
  const std::string first = argc > 1 ? argv[1] : "";
  std::vector<std::string> commands;
  bool is_known = program.get_option_no_throw(first) != nullptr;
  for (const CLI::App* command : program.get_subcommands({})) {
    is_known = is_known || command->get_name() == first;
    commands.push_back(command->get_name());
  }
  const std::string all = platform::listed(commands);
  if (is_known) return;
  if (first.empty()) process::refuse("a command is missing: one of " + all);
  if (first[0] == '-') process::refuse(fmt::format("'{}': a command comes first: one of {}", first, all));
  process::refuse(fmt::format("'{}': unknown command{}; commands: {}", first,
                              platform::nearest_text(first, commands), all));
}

std::string help_of(const CLI::App& program) {
  const auto commands = program.get_subcommands();
  return "stereotlm " + (commands.empty() ? "" : commands.front()->get_name() + " ") + "--help";
}

// Whether the word looks like an option: "-" and a number do not.
bool is_option(const std::string& word) {
  constexpr std::string_view kOfNumber = "0123456789.";
  return word.size() > 1 && word[0] == '-' && kOfNumber.find(word[1]) == std::string_view::npos;
}

// What the option lacks: a value; empty if it has one, or is a flag. `word`: the option as typed. `next`: the
// word behind it, which the parser would take for the value even if it is another option.
std::string value_problem(const CLI::Option& option, const std::string& word, const std::string& next) {
  const std::string name = word.substr(0, word.find('='));
  const bool has_equals = name != word;
  const bool is_flag = option.get_items_expected_min() == 0;
  const bool is_before_option = !has_equals && is_option(next);
  const bool has_value = has_equals ? name.size() + 1 < word.size() : !next.empty() && !is_before_option;
  if (has_value || (is_flag && !has_equals)) return "";
  return fmt::format("{}: a value is missing: must be {}{}{}", word, name,
                     is_flag ? "" : ' ' + option.get_option_text(),
                     is_before_option ? fmt::format(", or {0}={1} if {1} is the value", name, next) : "");
}

// Throws Refused for options without a value, and for options that the command does not have, unless these
// are beside --help. `words`: those behind the command.
void check_options(const CLI::App& command, std::vector<std::string> words) {
  std::vector<std::string> known;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  }
  process::Problems problems;
  bool lacks_value = false;
  bool has_help = false;
  const auto add = [&](const std::string& problem) {
    problems.add(fmt::format("{} (see stereotlm {} --help)", problem, command.get_name()));
  };
  words.emplace_back();  // behind the last one
  for (std::size_t i = 0; i + 1 < words.size() && words[i] != "--"; ++i) {
    if (!is_option(words[i])) continue;
    const std::string name = words[i].substr(0, words[i].find('='));
    const CLI::Option* const option = command.get_option_no_throw(name);
    if (option == nullptr) {
      add(fmt::format("{}: unknown option{}", name, platform::nearest_text(name, known)));
      continue;
    }
    has_help = has_help || option == command.get_help_ptr();
    if (const std::string problem = value_problem(*option, words[i], words[i + 1]); !problem.empty()) {
      lacks_value = true;
      add(problem);
    } else if (name == words[i] && option->get_items_expected_min() > 0) {
      ++i;  // behind the value
    }
  }
  if (lacks_value || !has_help) problems.check();
}

}  // namespace

int execute(int argc, const char* const* argv) {
  try {
    const Action action = parse_command_line(argc, argv);
    if (process::client != nullptr) process::client->check_given();
    return action();
  } catch (const process::Refused& refused) {
    for (const std::string& line : refused.lines()) process::say_line(line);
    if (process::client != nullptr) process::client->refuse(refused.problems());
    return kRefused;
  } catch (const sc_core::sc_report& report) {
    process::say("error", fmt::format("the model stopped: {}: {}", report.get_msg_type(), report.get_msg()));
  } catch (const std::exception& error) {
    process::say("error", process::text_of(error));
  }
  return kFailed;
}

Action parse_command_line(int argc, const char* const* argv) {
  CLI::App program(
      "A SystemC/TLM-2.0 model of the stereo vision board of Miyajima and Maruyama (FPL 2003): runs stereo\n"
      "pairs through it and accounts for every cycle of its memory banks.",
      "stereotlm");
  program.formatter(std::make_shared<HelpFormatter>());
  program.set_help_flag("-h,--help", "Print this help; after a command, the command's");
  program.set_version_flag("--version", std::string("stereotlm ") + process::kVersion, "Print the version");
  program.require_subcommand(1);
  program.footer(
      "Exit status: 0 done; 1 failed after the first simulated cycle; 2 refused before it; 130\n"
      "interrupted.");
  Commands commands = {program, argc > 1 ? argv[1] : "", {}};
  for (const auto add : {add_run, add_check, add_boards, add_keys, add_bounds, add_explain, add_calibrate,
                         add_sweep, add_merge, add_allocate, add_plot, add_conflicts, add_diff, add_diagram,
                         add_report, add_paper, add_worker})
    add(commands);
  for (CLI::App* command : program.get_subcommands({})) command->group("Commands");
  check_first_argument(program, argc, argv);
  if (commands.called[0] != '-')
    check_options(*program.get_subcommand(commands.called), {argv + 2, argv + argc});
  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& request) {
    std::ostringstream text;
    program.exit(request, text, text);
    return [text = text.str()] {
      process::print(text);
      return kDone;
    };
  } catch (const CLI::ParseError& error) {
    process::refuse(fmt::format("{} (see {})", error.what(), help_of(program)));
  }
  return commands.action;
}

}  // namespace stereotlm::cli
