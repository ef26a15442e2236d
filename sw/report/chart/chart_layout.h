#pragma once

#include "sw/report/chart/chart_drawing.h"
#include "sw/report/chart/chart_traffic.h"

namespace stereotlm::report {

// Places the memory chart of a board. The banks are in a column on the left, in the order of the board. The
// ports stand across a channel, in the FPGA, with the stages behind them; the computer is above the FPGA.
// `traffic`: that of a run of this board, whose extent is then `extent`; null: the links have their peaks.
MemoryChart layout_memory_chart(const platform::BoardConfig& board, ChartExtent extent,
                                const ChartTraffic* traffic);

}  // namespace stereotlm::report
