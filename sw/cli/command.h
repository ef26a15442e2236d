#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "sw/cli/options.h"
#include "sw/files/output_file.h"
#include "sw/process/command.h"
#include "sw/process/streams.h"

namespace stereotlm::cli {

// Exit status of the program (contract section 5).
inline constexpr int kDone = 0;
inline constexpr int kFailed = 1;   // the command failed while it worked
inline constexpr int kRefused = 2;  // the command was refused before it began
inline constexpr int kInterrupted = 130;

// Executes the command that was parsed and returns the exit status. Throws Refused if the command cannot be
// done; it has then had no effect.
using Action = std::function<int()>;

// Executes a command line and returns the exit status. Says on standard error why it is refused or has
// failed.
int execute(int argc, const char* const* argv);

// Parses the arguments and returns the action that execute() runs. For --help and --version, the action
// prints the text. Throws Refused if the arguments are wrong.
Action parse_command_line(int argc, const char* const* argv);

// The commands while they are added to the program.
struct Commands {
  CLI::App& program;
  std::string called;  // the command of the command line
  Action action;       // what executes it; set by parsing
};

// Adds a command to the program. `footer`: the end of its help. when_parsed() sets what the parser calls if
// the command line has the command.
CLI::App& add_command(CLI::App& program, const std::string& name, const std::string& description,
                      const std::string& footer);
void when_parsed(CLI::App& command, const std::function<void()>& parsed);

// Adds a command with options. Parsing checks them, and sets the action to `run` with them. Only the command
// that is called gets its options: making those of all takes half a millisecond.
template <typename CommandOptions>
void add_command(Commands& commands, const std::string& name, const std::string& description,
                 int (*run)(const CommandOptions&), const std::string& footer = "") {
  CLI::App& command = add_command(commands.program, name, description, footer);
  if (name != commands.called) return;
  const auto options = std::make_shared<CommandOptions>(command);
  when_parsed(command, [options, run, &commands] {
    options->check_usage();
    commands.action = [options, run] { return run(*options); };
  });
}

// Each function adds one command. Parsing throws Refused if its options are wrong.
void add_run(Commands& commands);
void add_check(Commands& commands);
void add_boards(Commands& commands);
void add_keys(Commands& commands);
void add_bounds(Commands& commands);
void add_explain(Commands& commands);
void add_calibrate(Commands& commands);
void add_allocate(Commands& commands);
void add_optimise(Commands& commands);
void add_sweep(Commands& commands);
void add_merge(Commands& commands);
void add_plot(Commands& commands);
void add_conflicts(Commands& commands);
void add_diagram(Commands& commands);
void add_diff(Commands& commands);
void add_report(Commands& commands);
void add_rtl(Commands& commands);
void add_serve(Commands& commands);
void add_worker(Commands& commands);

inline constexpr std::size_t kTextColumns = 100;

// Wraps `text` to lines of at most kTextColumns columns; a longer word has a line of its own. The first line
// begins with `head`, padded to `indent`; the others are indented by `indent`. Each line ends with a newline.
std::string paragraph(const std::string& head, std::size_t indent, const std::string& text);

// The text with these words in colour, from the byte `from` on, if standard output is a terminal.
std::string with_coloured_words(std::string text, std::size_t from,
                                const std::vector<std::pair<std::string, process::Colour>>& words);

// The document as the text of --json. What is not UTF-8 is replaced.
std::string json_text(const nlohmann::ordered_json& document);

// The parts of a problem of a board: place, key, value and rule, as in `check --json`.
nlohmann::ordered_json problem_document(const platform::Diagnostic& problem);

// Prints a note that the command was interrupted, and returns kInterrupted. `what`: what that means.
int interrupted(const std::string& what);

// Writes the file of --out. Returns false, and writes nothing, if interrupted. Refuses the command if the
// file cannot be written.
bool write_out(const std::string& path, const files::FileKind& kind, const std::string& bytes);

// Runs the script that draws figures, and shows how long that takes.
process::CommandEnd draw(const std::string& script, const std::vector<std::string>& arguments);

// Reports now if no folder for temporary files can be made, which the command will need.
void check_temporary_folder(process::Problems& problems);

}  // namespace stereotlm::cli
