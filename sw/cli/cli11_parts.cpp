#include <CLI/CLI.hpp>

#include "sw/cli/add_command.h"
#include "sw/cli/typed_option.h"
#include "sw/process/streams.h"

// Implements add_command.h and typed_option.h. The commands include these instead of CLI11, which takes long
// to compile.
namespace stereotlm::cli {

template <typename Text>
void TypedOption<Text>::add_to(CLI::App& command, const std::string& name, const std::string& value,
                               const std::string& meaning) {
  option_ = command.add_option(name, text, meaning)->option_text(value);
  option_->each([this](const std::string& /*word*/) { is_given_ = true; });
}

template <typename Text>
void TypedOption<Text>::takes(int least, int most) {
  option_->expected(least, most);
}

template <typename Text>
void TypedOption<Text>::takes_one_at_a_time() {
  option_->allow_extra_args(false);
}

template struct TypedOption<std::string>;
template struct TypedOption<std::vector<std::string>>;

void add_flag(CLI::App& command, const std::string& name, bool& is_given, const std::string& meaning) {
  command.add_flag(name, is_given, meaning);
}

void set_footer(CLI::App& command, const std::string& text) { command.footer(text); }

CLI::App& add_command(CLI::App& program, const std::string& name, const std::string& description,
                      const std::function<void()>& parsed, const std::string& footer) {
  CLI::App* command = program.add_subcommand(name, description);
  command->callback(parsed);
  command->footer(footer);
  command->add_flag_callback("--quiet", process::leave_out_notes, "Leave out notes and progress");
  return *command;
}

}  // namespace stereotlm::cli
