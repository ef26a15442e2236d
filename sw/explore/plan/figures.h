#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "platform/config/board_yaml.h"
#include "sw/explore/store/store.h"

namespace stereotlm::explore {

// What stats.json says, as a row of numbers.
struct Figures {
  // By the dotted path of their keys; an element of a list goes by its name: "banks.bank0.reads". A list of
  // numbers is one text, "[1, 2]".
  std::vector<platform::BoardValue> values;
  std::vector<StoredBlame> blame;
};

// `document`: of report::stats_document().
Figures figures_of(const nlohmann::ordered_json& document);

}  // namespace stereotlm::explore
