#pragma once

#include <nlohmann/json_fwd.hpp>

namespace CLI {
class App;
}

namespace stereotlm::cli {

// The option --json: the command prints one JSON document instead of its text. Its keys have the style of
// stats.json; its schema is sw/cli/schemas/COMMAND.schema.json.
struct JsonOption {
  bool is_given = false;

  void add_to(CLI::App& command);
};

// Prints the document to standard output.
void print_json(const nlohmann::ordered_json& document);

}  // namespace stereotlm::cli
