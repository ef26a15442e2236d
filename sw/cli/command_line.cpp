#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <set>
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
  if (first == "paper") process::refuse("'paper': is a study now: results/paper/run of the sources");
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

// Throws Refused for options that the command does not have, for those that are given twice, and for those
// without a value: the parser would take the next option for it. `words`: those behind the command.
void check_options(const CLI::App& command, std::vector<std::string> words) {
  std::vector<std::string> known;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  }
  process::Problems problems;
  std::set<const CLI::Option*> given;
  words.emplace_back();  // behind the last one
  for (std::size_t i = 0; i + 1 < words.size() && words[i] != "--"; ++i) {
    if (!is_option(words[i])) continue;
    const std::string& next = words[i + 1];
    const std::string name = words[i].substr(0, words[i].find('='));
    const bool has_equals = name != words[i];
    const CLI::Option* const option = command.get_option_no_throw(name);
    const bool is_flag = option != nullptr && option->get_items_expected_min() == 0;
    std::string problem;
    if (option == nullptr) {
      problem = "unknown option" + platform::nearest_text(name, known);
    } else if (has_equals ? words[i].size() == name.size() + 1
                          : !is_flag && (next.empty() || is_option(next))) {
      problem = "a value is missing: must be " + name;
      if (!is_flag) problem += ' ' + option->get_option_text();
      if (!has_equals && !next.empty())
        problem += fmt::format(", or {0}={1} if {1} is the value", name, next);
    } else if (!is_flag && option->get_items_expected_max() == 1 && !given.insert(option).second) {
      problem = "given twice: must be given once";
    } else if (!has_equals && !is_flag) {
      ++i;  // behind the value
    }
    if (!problem.empty())
      problems.add(fmt::format("{}: {} (see stereotlm {} --help)", option == nullptr ? name : words[i],
                               problem, command.get_name()));
  }
  problems.check();
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
                         add_sweep, add_optimise, add_merge, add_allocate, add_plot, add_conflicts, add_diff,
                         add_diagram, add_report, add_rtl, add_serve, add_worker})
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
