#pragma once

#include <optional>
#include <string>

#include "platform/statistics.h"
#include "sw/report/accuracy.h"

namespace stereotlm::report {

// The text of stats.json (contract section 6), its keys in that order. `failed` appears only if an identity
// failed, `accuracy` only if given; a percentage of nothing is null.
std::string stats_json(const platform::Statistics& statistics, const std::optional<Accuracy>& accuracy);

}  // namespace stereotlm::report
