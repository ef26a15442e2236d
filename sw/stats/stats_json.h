#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "platform/figures/statistics.h"
#include "sw/stats/accuracy.h"

namespace stereotlm::stats {

// The content of stats.json and its text. sw/report/README.md lists the keys, in their order. Keys that do
// not apply are left out: `failed` when all identities hold, `accuracy` when it is not given, a percentage
// when its denominator is 0.
nlohmann::ordered_json stats_document(const platform::Statistics& statistics,
                                      const std::optional<Accuracy>& accuracy);
std::string stats_json(const platform::Statistics& statistics, const std::optional<Accuracy>& accuracy);

// What `run --json` prints: stats.json, and what only the table shows: `waitless_frames_per_second` and
// `disparities_percent` where they are given, and an accuracy against a made scene.
struct TableExtras;
nlohmann::ordered_json run_document(const platform::Statistics& statistics, const TableExtras& extras);

// Reads stats.json of a run of this board. `fidelity`, `frames` and `camera` (a whole computer) are those of
// its run.json. The text must be that of stats_json(), with known names, and with figures that agree and hold
// the identities of README.md. Throws std::runtime_error: "LINE: path = value: rule".
platform::Statistics read_stats(const std::string& text, const platform::BoardConfig& board,
                                const std::string& fidelity, std::uint64_t frames, bool camera);

// The part `area` of stats.json for the core of a board, and `fits`.
nlohmann::ordered_json area_json(const platform::BoardConfig& board);
// The same with `device`, `smallest_device` that fits, and `parts`.
nlohmann::ordered_json area_document(const platform::BoardConfig& board);

// The JSON Schemas of run_document(), area_json() and area_document().
nlohmann::ordered_json run_schema();
nlohmann::ordered_json area_schema();
nlohmann::ordered_json area_document_schema();

// The differences of two texts of stats.json, one line each: "/banks/0/reads: fast 5, cycle 6". A key that
// only one text has is "absent" in the other. Throws std::runtime_error if a text is not JSON.
std::vector<std::string> stats_differences(const std::string& first, const std::string& second,
                                           const std::string& first_name, const std::string& second_name);

}  // namespace stereotlm::stats
