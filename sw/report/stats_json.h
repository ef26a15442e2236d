#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "models/area/area.h"
#include "platform/statistics.h"
#include "sw/report/accuracy.h"

namespace stereotlm::report {

// The content of stats.json (contract section 6) and its text. Keys have the order of the contract; a
// camera's counts of dropped frames by reason follow its other keys. A key is absent if it does not apply:
// `failed` if all identities hold, `accuracy` if it is not given, a percentage if its denominator is 0.
nlohmann::ordered_json stats_document(const platform::Statistics& statistics,
                                      const std::optional<Accuracy>& accuracy);
std::string stats_json(const platform::Statistics& statistics, const std::optional<Accuracy>& accuracy);

// What `run --json` prints: stats.json, and what only the table shows: `waitless_frames_per_second` and
// `disparities_percent` where they are given, and an accuracy against a made scene.
struct TableExtras;
nlohmann::ordered_json run_document(const platform::Statistics& statistics, const TableExtras& extras);

// The part `area` of stats.json.
nlohmann::ordered_json area_json(const area::Area& area);

}  // namespace stereotlm::report
