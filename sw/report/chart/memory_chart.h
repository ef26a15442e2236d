#pragma once

#include <string>

#include "sw/report/chart/chart_links.h"

namespace stereotlm::report {

// How every memory chart begins. No other drawing begins so.
inline constexpr const char* kChartMark =
    "<svg xmlns=\"http://www.w3.org/2000/svg\" data-generator=\"stereotlm diagram\"";

// The memory chart as an SVG document: each link with its MB/s of the run, or with its peak. Names are shown
// as text, whatever characters they have. The chart can be a file, or part of an HTML page.
// sw/report/README.md lists its ids, classes and colours.
std::string memory_chart_svg(const ChartView& view);

// The colour of a link that carries so much of its peak, or of a bank that is so busy: load0 to load4.
std::string load_colour(double load, double peak);

}  // namespace stereotlm::report
