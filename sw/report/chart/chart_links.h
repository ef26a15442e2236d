#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "models/fpga/core_ports.h"
#include "platform/config/board_config.h"
#include "platform/statistics.h"

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

// The banks that a port accesses: an entry for each of its buffers, in the order in which the frames use
// them. Empty for the host's port and for a port that does not exist.
std::vector<std::string> banks_of(const platform::BoardConfig& board, const fpga::CorePort& port);

// What the memory chart shows of a run.
struct ChartTraffic {
  ChartExtent extent = ChartExtent::kBoard;            // of the run
  std::map<std::string, double> megabytes_per_second;  // by the id of the link; of every link
  std::map<std::string, double> busy_percent;          // by the id of the block: banks and buses
  std::map<std::string, double> waits_percent;         // by the id of the block: ports
  std::set<std::string> limiting;                      // ids of the blocks that set the bounds of the rate
  std::vector<std::string> summary;                    // lines about the run
};

// The traffic of a run of this board.
//
// Links of banks have the accesses of the counted cycles of all frames, and their time. A port of the core
// makes equally many accesses in each frame, so its grants divide by the frames. The host has the accesses of
// a bank that no other port made. Links around the board have the words since power-up, and that time: a
// camera the pixels that its capture board has written, the CPU its register accesses, the bridge the words
// written into it (edge-pci-bridge) and those that its DMA moved over PCI (edge-bridge-pci).
ChartTraffic chart_traffic(const platform::BoardConfig& board, const platform::Statistics& statistics);

}  // namespace stereotlm::report
