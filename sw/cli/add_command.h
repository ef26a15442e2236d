#pragma once

#include <functional>
#include <string>

namespace CLI {
class App;
}

namespace stereotlm::cli {

// Puts a command into the program. `parsed` is called when the command line holds it, while that is parsed.
CLI::App& add_command(CLI::App& program, const std::string& name, const std::string& description,
                      const std::function<void()>& parsed, const std::string& footer = "");

void add_flag(CLI::App& command, const std::string& name, bool& is_given, const std::string& meaning);
void set_footer(CLI::App& command, const std::string& text);

}  // namespace stereotlm::cli
