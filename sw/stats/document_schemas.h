#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace stereotlm::stats {

// The commands whose --json has a JSON Schema (draft 2020-12), and the schema of one of them.
std::vector<std::string> document_names();
nlohmann::ordered_json document_schema(const std::string& command);

}  // namespace stereotlm::stats
