#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sw/report/chart/chart_links.h"

namespace stereotlm::report {

// The lines of text in a block; the first one is its name.
using ChartLines = std::vector<std::string>;

struct BankLines {
  std::string bandwidth;               // beside the name: "160 MB/s"; of a run "159.0 of 160 MB/s"
  std::string size;                    // "76,800 of 512K words"
  std::string kind;                    // "zbt_pipelined", "sync_burst, 2 lost"
  std::optional<double> busy_percent;  // of a run
  struct Held {
    std::string label;  // "left_image[0]"
    std::string port;   // that accesses it
    std::uint64_t words = 0;
  };
  std::vector<Held> buffers;  // those of one port follow each other
  std::uint64_t words = 0;    // of the bank
};
BankLines bank_lines(const platform::BoardConfig& board, const platform::BankConfig& bank,
                     const ChartTraffic* traffic);

// The ports of the core that exist, and the host's unless the board is alone, from top to bottom: the tables
// beside the pixel ports that they serve.
std::vector<std::string> ports_from_top(const platform::BoardConfig& board, ChartExtent extent);

// The lines of every block but the banks, by the id of the block.
std::map<std::string, ChartLines> block_lines(const platform::BoardConfig& board, ChartExtent extent,
                                              const ChartTraffic* traffic);

std::string fpga_line(const platform::BoardConfig& board);
ChartLines arbitration_lines(const platform::BoardConfig& board);
// Below the name of the board.
ChartLines subtitle_lines(const platform::BoardConfig& board, ChartExtent extent,
                          const ChartTraffic* traffic);
// What the numbers mean.
ChartLines legend_lines(ChartExtent extent, const ChartTraffic* traffic);

}  // namespace stereotlm::report
