#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sw/report/chart/chart_links.h"

// What is drawn in a memory chart, with its place. Lengths are in pixels, y grows downwards. Colours are
// names: memory_chart.cpp has their values.
namespace stereotlm::report {

struct ChartPoint {
  double x = 0;
  double y = 0;
};

struct ChartBox {
  double x = 0;
  double y = 0;
  double width = 0;
  double height = 0;

  double right() const { return x + width; }
  double bottom() const { return y + height; }
  double middle_x() const { return x + width / 2; }
  double middle_y() const { return y + height / 2; }
};

enum class ChartAnchor { kStart, kMiddle, kEnd };

// One line of text. The box is as wide as the text in the widest font.
struct ChartText {
  std::string text;
  ChartBox box;
  double size = 11;
  ChartAnchor anchor = ChartAnchor::kStart;
  bool bold = false;
  bool faint = false;
};

struct ChartRect {
  ChartBox box;
  double radius = 0;
  std::string fill = {};
  std::string stroke = {};  // empty: none
  double stroke_width = 0;
  double opacity = 1;
};

struct ChartBlock {
  std::string id;
  std::string title;  // the whole name and all figures, for a tooltip
  ChartBox box;
  bool limits = false;           // sets the bound of the frame rate
  std::vector<ChartRect> rects;  // the block, and its bars: one lies on those before it
  std::vector<ChartText> texts;
};

struct ChartEdge {
  ChartLink link;
  std::optional<double> megabytes_per_second;  // nullopt without a run
  double width = 1.5;
  std::string colour = "line";
  std::vector<ChartPoint> way;  // from link.from to link.to; horizontal and vertical pieces
  ChartText label;              // without text where a run has moved nothing
  std::string title;
};

// The way of pixels and results inside the FPGA. It carries no words of the memories.
struct ChartFlow {
  std::string id;
  std::vector<ChartPoint> way;
};

struct MemoryChart {
  std::string title;
  double width = 0;
  double height = 0;
  ChartBox fpga;  // frame
  std::vector<ChartBlock> blocks;
  std::vector<ChartEdge> edges;
  std::vector<ChartFlow> flows;
  std::vector<ChartRect> swatches;  // of the legend
  std::vector<ChartText> texts;     // heading and legend
};

// The colour of a link that carries so much of its peak, or of a bank that is so busy: load0 to load4.
std::string load_colour(double load, double peak);

// Places the memory chart of a board. The banks are in a column on the left, in the order of the board. The
// ports stand across a channel, in the FPGA, with the stages behind them; the computer is above the FPGA.
// Without a run the links have their peaks.
MemoryChart layout_memory_chart(const platform::BoardConfig& board, ChartExtent extent);
// `traffic`: of a run of this board.
MemoryChart layout_memory_chart(const platform::BoardConfig& board, const ChartTraffic& traffic);

}  // namespace stereotlm::report
