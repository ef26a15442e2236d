#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sw/report/chart/chart_links.h"

namespace stereotlm::report {

inline constexpr double kLetterHeight = 1.18;  // of a line of text, in font sizes

// The width of a UTF-8 text of this size. It is that of DejaVu Sans, which is wider than the other fonts of
// the chart, so that no viewer needs more.
double text_width(std::string_view text, double size, bool bold);

// The text if it fits, else its beginning and its end around an ellipsis. Names often differ in their ends.
std::string fitted(const std::string& text, double size, bool bold, double width);

// The UTF-8 text without control characters, as all names of a board are, for XML: in an element or an
// attribute. U+FFFE and U+FFFF, which XML cannot have, become U+FFFD.
std::string xml_text(std::string_view text);

// A figure of the configuration. At most two decimals, without trailing zeros: "160", "133.33", "5.7";
// "<0.01" for less.
std::string short_number(double value);

// A measured figure. One decimal: "144.4", "5.0"; "<0.1" for less, and "0" for nothing.
std::string measured(double value);

// A rate in frames/s: two decimals below 100, else one.
std::string rate_text(double frames_per_second);

// A count, with commas from 10,000 on.
std::string grouped(std::uint64_t count);

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
