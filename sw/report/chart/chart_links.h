#pragma once

#include <string>
#include <vector>

#include "models/fpga/core_ports.h"
#include "platform/config/board_config.h"

namespace stereotlm::report {

enum class ChartExtent {
  kBoard,     // the board alone, as with `--source preloaded`: no cameras, no PCI bus, no host port
  kComputer,  // the board in its computer
};

// A link between two blocks of the memory chart, over which words or pixels move. Blocks have the ids
// "bank-NAME", "port-NAME", "stage-NAME" (inside the FPGA) and "part-NAME" (around the board).
struct ChartLink {
  std::string from;
  std::string to;
  bool there = false;  // data moves from `from` to `to`
  bool back = false;   // data moves from `to` to `from`
  double peak = 0;     // MB/s: 10^6 bytes per second, both directions together

  std::string id() const;  // "edge-left_lut-bank6"
};

// "bank0" for "bank-bank0".
std::string name_of_block(const std::string& id);

// Every link of the board: first those around the board, then those from each port to the banks of its
// buffers, in the order of fpga::kPorts and of the board's banks. The ids differ, because only the links of
// ports begin with the name of a port.
std::vector<ChartLink> chart_links(const platform::BoardConfig& board, ChartExtent extent);

// The banks that a port accesses: an entry for each of its buffers, in the order in which the frames use them.
// Empty for the host's port and for a port that does not exist.
std::vector<std::string> banks_of(const platform::BoardConfig& board, const fpga::CorePort& port);

}  // namespace stereotlm::report
