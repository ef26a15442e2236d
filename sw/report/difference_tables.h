#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "platform/config/board_yaml.h"
#include "platform/figures/statistics.h"
#include "sw/stats/run_comparison.h"

namespace stereotlm::report {

// A run as the verdict needs it: its stats.json, and the clock of its core.
struct JudgedRun {
  const nlohmann::ordered_json& stats;
  double clock_mhz;
};

// What stands behind rates of two runs, by stats.json: ", with 7 lost pixels in A and 0 in B".
// Empty if none are lost.
std::string loss_text(const nlohmann::ordered_json& a, const nlohmann::ordered_json& b);

// The comparison of two runs in one sentence: which is faster, by how much, where the difference arises, and
// whether the disparities are the same. The rates are the steady ones if both runs have them, else those from
// power-up, else those of the core, with the pixels that captures lose. Rates that differ by at most the sum
// of their uncertainties count as equal. `pixels`: null if the disparities are not compared.
std::string diff_verdict(const JudgedRun& a, const JudgedRun& b, const stats::PixelComparison* pixels);

// The sum of `frame_cycles`.
std::uint64_t cycles_of_frames(const nlohmann::ordered_json& stats);

// The tables that `diff` prints for two runs, A and B. A table shows only what differs; without differences
// it is an empty string. Differences are B - A. Text is ASCII except names and values.

using Values = std::vector<platform::BoardValue>;

// The values that differ, in the order of A; values that only B has follow: a list of `path`, `a` and `b`.
// What a run does not have is left out.
nlohmann::ordered_json differing_values(const Values& a, const Values& b);

// differing_values() for people: one row, `path` and `banks` (names), has the banks that only one run has.
nlohmann::ordered_json shown_values(const nlohmann::ordered_json& rows);

// The waits that differ, the largest difference first: a list of `port`, `bank`, `by`, and cycles `a`, `b`.
nlohmann::ordered_json differing_waits(const std::vector<platform::BlameRow>& a,
                                       const std::vector<platform::BlameRow>& b);

// The table of settings, from shown_values(): "-" for what a run does not have. It shows at most
// kMostSettings. A value too long for its column has lines of its own.
inline constexpr std::size_t kMostSettings = 30;
std::string settings_table(const std::string& head, const nlohmann::ordered_json& rows);

// The table of figures, from shown_values(). Beside two numbers it shows their difference. Two real numbers
// that are the same with six digits, such as quotients that are rounded differently, are left out.
std::string figures_table(const std::string& head, const nlohmann::ordered_json& rows);

// The table of cycles of frames with the same number in both runs. Frames with the same cycles share a line.
// It shows the kMostLines largest differences, and the sum of the others.
inline constexpr std::size_t kMostLines = 10;
std::string frames_table(const std::vector<std::uint64_t>& cycles_a,
                         const std::vector<std::uint64_t>& cycles_b);

// The first row that differs in cycles, or else in stalls, and the differences by ranges of rows
// (RowComparison::ranges(), at most kMostLines).
std::string rows_table(const stats::RowComparison& rows);

// The table of differing_waits().
std::string blame_table(const nlohmann::ordered_json& waits);

// The pixels that differ, in one line, which is not empty even if no frame was compared.
std::string pixels_line(const stats::PixelComparison& pixels);

}  // namespace stereotlm::report
