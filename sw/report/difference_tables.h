#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "platform/config/board_yaml.h"
#include "platform/statistics.h"
#include "sw/report/pixel_comparison.h"
#include "sw/report/row_comparison.h"

namespace stereotlm::report {

// What `diff` prints of two runs, A and B: tables of what is not the same, ASCII but for names and values, a
// newline after each line. A table without lines is empty, without a head too. Differences are B - A.

// Values by their paths; one that is missing on one side is "-" there.
using Values = std::vector<platform::BoardValue>;

// What the runs were told: at most kMostSettings. Values that are too long for a column stand in full in
// lines of their own.
inline constexpr std::size_t kMostSettings = 30;
std::string settings_table(const std::string& head, const Values& a, const Values& b);

// Figures, numbers with their differences.
std::string figures_table(const std::string& head, const Values& a, const Values& b);

// Of frames with the same number in both runs, those with the same cycles in one line: at most kMostLines,
// those that cost or gain most, and what the others do.
inline constexpr std::size_t kMostLines = 10;
std::string frames_table(const std::vector<std::uint64_t>& cycles_a,
                         const std::vector<std::uint64_t>& cycles_b);

// Where they part, in cycles or else in stalls, and what it costs or gains in which rows:
// RowComparison::ranges(), at most kMostLines.
std::string rows_table(const RowComparison& rows);

// Sorted by what they differ, most first.
std::string blame_table(const std::vector<platform::BlameRow>& a, const std::vector<platform::BlameRow>& b);

// One line, also if no frame was compared.
std::string pixels_line(const PixelComparison& pixels);

}  // namespace stereotlm::report
