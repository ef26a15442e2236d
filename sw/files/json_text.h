#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace stereotlm::files {

// JSON as the result files have it: keys in their order, two spaces of indent, a container that holds no
// other container on one line, numbers as the shortest decimals that read back equal, a newline at the end.
// Throws std::invalid_argument on a number that is not finite and on a string that is not UTF-8.
std::string json_text(const nlohmann::ordered_json& document);

}  // namespace stereotlm::files
