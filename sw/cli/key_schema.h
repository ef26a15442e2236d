#pragma once

#include <nlohmann/json_fwd.hpp>

namespace stereotlm::cli {

// JSON Schemas (draft 2020-12) of board files and of plans, made from the keys. An editor that knows them
// completes keys and marks values that break the rule of their key. Rules between keys are beyond them.
nlohmann::ordered_json board_schema();
nlohmann::ordered_json plan_schema();

}  // namespace stereotlm::cli
