#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "sw/stats/run_comparison.h"

namespace stereotlm::report {

// A run as the verdict needs it: its stats.json, and the clock of its core.
struct JudgedRun {
  const nlohmann::ordered_json& stats;
  double clock_mhz;
};

// The comparison of two runs in one sentence: which is faster, by how much, where the difference arises, and
// whether the disparities are the same. The rates are the steady ones if both runs have them, else those
// from power-up, else those of the core. What lies within the uncertainty of both is no difference. `pixels`:
// null if the disparities are not compared.
std::string diff_verdict(const JudgedRun& a, const JudgedRun& b, const stats::PixelComparison* pixels);

// The sum of `frame_cycles`.
std::uint64_t cycles_of_frames(const nlohmann::ordered_json& stats);

}  // namespace stereotlm::report
