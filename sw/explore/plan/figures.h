#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "platform/config/board_yaml.h"
#include "sw/explore/store/store.h"

namespace stereotlm::explore {

// The contents of stats.json as one row of a database.
struct Figures {
  // Each value has the dotted path of its key. The path of an element of a list has the element's member
  // `name`, as in "banks.bank0.reads". A list of numbers is one text, "[1,2]".
  std::vector<platform::BoardValue> values;
  std::vector<StoredBlame> blame;
};

// `document`: as stats::stats_document() returns it.
Figures figures_of(const nlohmann::ordered_json& document);

}  // namespace stereotlm::explore
