#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sw/report/chart/chart_links.h"

// What is drawn in a memory chart, with its place. Lengths are in pixels, y grows downwards.
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

enum class BlockKind { kMemory, kLogic, kBus, kComputer };

// The words of a bank, as a bar: all of them, and those of each buffer.
struct WordsBar {
  ChartBox all;
  std::vector<ChartBox> buffers;
};

// In how many of the cycles a bank is busy, as a bar. The bank has its colour.
struct BusyBar {
  ChartBox all;
  double percent = 0;
};

struct ChartBlock {
  std::string id;
  BlockKind kind = BlockKind::kLogic;
  ChartBox box;
  std::vector<ChartText> texts;
  std::string title;  // the whole name and all figures, for a tooltip
  bool limits = false;
  std::optional<WordsBar> words;
  std::optional<BusyBar> busy;  // of a run
};

// How much of its peak a link carries, and how busy a bank is, in five steps.
inline constexpr int kLoadSteps = 5;
int load_step(double load, double peak);
std::string load_text(int step);  // "below 1", "from 25": % of the peak

struct ChartEdge {
  ChartLink link;
  std::optional<double> megabytes_per_second;  // nullopt without a run
  double width = 1.5;
  std::vector<ChartPoint> way;  // from link.from to link.to; horizontal and vertical pieces
  ChartText label;              // without text where a run has moved nothing
  std::string title;
};

// The way of pixels and results inside the FPGA. It carries no words of the memories.
struct ChartFlow {
  std::string id;
  std::vector<ChartPoint> way;
};

struct LoadSwatch {
  ChartBox box;
  int step = 0;
};

struct MemoryChart {
  std::string title;
  double width = 0;
  double height = 0;
  ChartBox fpga;  // frame
  std::vector<ChartBlock> blocks;
  std::vector<ChartEdge> edges;
  std::vector<ChartFlow> flows;
  std::vector<ChartText> texts;  // heading and legend
  std::vector<LoadSwatch> swatches;
};

}  // namespace stereotlm::report
