#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sw/cli/options.h"
#include "sw/files/output_file.h"
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

// Parses the arguments and returns the action that main() runs. For --help and --version, the action prints
// the text. Throws Refused if the arguments are wrong.
Action parse_command_line(int argc, const char* const* argv);

// Adds a command to the program. `footer`: the end of its help. when_parsed() sets what the parser calls if
// the command line has the command.
CLI::App& add_command(CLI::App& program, const std::string& name, const std::string& description,
                      const std::string& footer);
void when_parsed(CLI::App& command, const std::function<void()>& parsed);

// Adds a command with options. Parsing checks them, and sets `action` to `run` with them, if the command line
// has the command.
template <typename CommandOptions>
void add_command(CLI::App& program, Action& action, const std::string& name, const std::string& description,
                 int (*run)(const CommandOptions&), const std::string& footer = "") {
  CLI::App& command = add_command(program, name, description, footer);
  const auto options = std::make_shared<CommandOptions>(command);
  when_parsed(command, [options, run, &action] {
    options->check_usage();
    action = [options, run] { return run(*options); };
  });
}

// Each function adds one command to the program. Parsing sets `action` if the command line has that command,
// and throws Refused if its options are wrong.
void add_run(CLI::App& program, Action& action);
void add_check(CLI::App& program, Action& action);
void add_boards(CLI::App& program, Action& action);
void add_keys(CLI::App& program, Action& action);
void add_bounds(CLI::App& program, Action& action);
void add_explain(CLI::App& program, Action& action);
void add_calibrate(CLI::App& program, Action& action);
void add_allocate(CLI::App& program, Action& action);
void add_sweep(CLI::App& program, Action& action);
void add_merge(CLI::App& program, Action& action);
void add_plot(CLI::App& program, Action& action);
void add_conflicts(CLI::App& program, Action& action);
void add_diagram(CLI::App& program, Action& action);
void add_diff(CLI::App& program, Action& action);
void add_report(CLI::App& program, Action& action);
void add_paper(CLI::App& program, Action& action);

inline constexpr std::size_t kTextColumns = 100;

// Wraps `text` to lines of at most kTextColumns columns; a longer word has a line of its own. The first line
// begins with `head`, padded to `indent`; the others are indented by `indent`. Each line ends with a newline.
std::string paragraph(const std::string& head, std::size_t indent, const std::string& text);

// The text with these words in colour, from the byte `from` on, if standard output is a terminal.
std::string with_coloured_words(std::string text, std::size_t from,
                                const std::vector<std::pair<std::string, process::Colour>>& words);

// The document as the text of --json. What is not UTF-8 is replaced.
std::string json_text(const nlohmann::ordered_json& document);

// Prints a note that the command was interrupted, and returns kInterrupted. `what`: what that means.
int interrupted(const std::string& what);

// Writes the file of --out. Returns false, and writes nothing, if interrupted. Refuses the command if the
// file cannot be written.
bool write_out(const std::string& path, const files::FileKind& kind, const std::string& bytes);

// Runs a script that draws figures from these files, by name, in a folder, and returns the files that it has
// added there. Returns nullopt if interrupted. Throws std::runtime_error if the script fails.
using NamedBytes = std::map<std::string, std::string>;
std::optional<NamedBytes> drawn(const std::string& script, const NamedBytes& files,
                                std::vector<std::string> options = {});

// Reports now if no folder for temporary files can be made, which the command will need.
void check_temporary_folder(process::Problems& problems);

}  // namespace stereotlm::cli
