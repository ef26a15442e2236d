#include "sw/cli/typed_option.h"

#include <CLI/CLI.hpp>

namespace stereotlm::cli {

template <typename Text>
void TypedOption<Text>::add_to(CLI::App& command, const std::string& name, const std::string& value,
                               const std::string& meaning) {
  option_ = command.add_option(name, text, meaning)->option_text(value);
}

template <typename Text>
void TypedOption<Text>::takes(int least, int most) {
  option_->expected(least, most);
}

template <typename Text>
bool TypedOption<Text>::is_given() const {
  return option_->count() > 0;
}

template struct TypedOption<std::string>;
template struct TypedOption<std::vector<std::string>>;

}  // namespace stereotlm::cli
