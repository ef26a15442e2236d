#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace stereotlm::files {

// The text of a JSON document in the form of the result files: keys in insertion order, two spaces of indent,
// a container without containers on one line, numbers as the shortest decimals that read back equal, a
// newline at the end. Throws std::invalid_argument for a number that is not finite, and, unless `handler`
// says otherwise, for a string that is not UTF-8.
std::string json_text(
    const nlohmann::ordered_json& document,
    nlohmann::ordered_json::error_handler_t handler = nlohmann::ordered_json::error_handler_t::strict);

}  // namespace stereotlm::files
