#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "platform/statistics.h"
#include "sw/report/accuracy.h"

namespace stereotlm::report {

// stats.json, and its text (contract section 6), its keys in that order; a camera's reasons of dropped frames
// behind its other keys. What does not apply is absent: `failed` unless an identity failed, `accuracy` unless
// it is given, a percentage of nothing.
nlohmann::ordered_json stats_document(const platform::Statistics& statistics,
                                      const std::optional<Accuracy>& accuracy);
std::string stats_json(const platform::Statistics& statistics, const std::optional<Accuracy>& accuracy);

}  // namespace stereotlm::report
