#pragma once

#include <functional>
#include <string>

namespace CLI {
class App;
}

namespace stereotlm::cli {

// Adds a command to the program. The parser calls `parsed` if the command line has this command.
CLI::App& add_command(CLI::App& program, const std::string& name, const std::string& description,
                      const std::function<void()>& parsed, const std::string& footer = "");

void add_flag(CLI::App& command, const std::string& name, bool& is_given, const std::string& meaning);
void set_footer(CLI::App& command, const std::string& text);

}  // namespace stereotlm::cli
