#pragma once

#include <functional>
#include <string>

namespace CLI {
class App;
}

namespace stereotlm::cli {

// Adds a command to the program. The parser calls `parsed` if the command line has this command. `footer`:
// the end of its help.
CLI::App& add_command(CLI::App& program, const std::string& name, const std::string& description,
                      const std::function<void()>& parsed, const std::string& footer = "");

// Adds an option without a value. Parsing sets `is_given` if the command line has it.
void add_flag(CLI::App& command, const std::string& name, bool& is_given, const std::string& meaning);
// Replaces the end of the command's help.
void set_footer(CLI::App& command, const std::string& text);

}  // namespace stereotlm::cli
