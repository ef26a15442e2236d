#pragma once

#include <string>

#include "sw/report/chart/chart_links.h"

namespace stereotlm::report {

// How every memory chart begins. No other drawing begins so.
inline constexpr const char* kChartMark =
    "<svg xmlns=\"http://www.w3.org/2000/svg\" data-generator=\"stereotlm diagram\"";

// The memory chart as an SVG document: the board as it is configured, each link with its peak MB/s. `extent`:
// the board alone, or in its computer. Names are shown as text, whatever characters they have. The chart can
// be a file, or part of an HTML page. sw/report/README.md lists its ids, classes and colours.
std::string memory_chart_svg(const platform::BoardConfig& board, ChartExtent extent);

// The memory chart of a run: each link with its MB/s.
std::string memory_chart_svg(const platform::BoardConfig& board, const ChartTraffic& traffic);

}  // namespace stereotlm::report
