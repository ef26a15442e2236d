#include "sw/cli/json_option.h"

#include "sw/cli/add_command.h"
#include "sw/files/json_text.h"
#include "sw/process/streams.h"

namespace stereotlm::cli {

void JsonOption::add_to(CLI::App& command) {
  add_flag(command, "--json", is_given, "Print one JSON document instead of text");
}

void print_json(const nlohmann::ordered_json& document) {
  process::print(files::json_text(document, nlohmann::ordered_json::error_handler_t::replace));
}

}  // namespace stereotlm::cli
