#pragma once

#include <string>
#include <vector>

#include "models/fpga/core_ports.h"
#include "platform/config/board_config.h"
#include "platform/figures/statistics.h"

namespace stereotlm::report {

// What a memory chart shows: a board, alone as with `--source preloaded` or in its computer, and a run of it.
struct ChartView {
  const platform::BoardConfig& board;
  bool in_computer = false;                   // as the run was
  const platform::Statistics* run = nullptr;  // nullptr: the board as it is configured
};

// A link between two blocks of the memory chart, over which words or pixels move. Blocks have the ids
// "bank-NAME", "port-NAME", "stage-NAME" (inside the FPGA) and "part-NAME" (around the board).
struct ChartLink {
  std::string from;
  std::string to;
  bool there = false;  // data moves from `from` to `to`
  bool back = false;   // data moves from `to` to `from`
  double peak = 0;     // MB/s: 10^6 bytes per second, both directions together
  double rate = 0;     // MB/s of the run

  std::string id() const;  // "edge-left_lut-bank6"
};

// "bank0" for "bank-bank0".
std::string name_of_block(const std::string& id);

// Every link of the board: first those around the board, then those from each port group to the banks of its
// buffers, in the order of fpga::kPortGroups and of the board's banks. The ports of all lanes are one block.
// The ids differ: only the links of ports begin with the name of a port group.
//
// The rates of bank links count the accesses in the counted cycles of all frames, over their time. A port of
// the core makes equally many accesses in each frame, so the grants of a port are divided among its banks by
// the frames that use each bank. The host made the accesses that no port of the core made. The rates around
// the board count words since power-up: a camera the pixels that its capture board has written, the CPU its
// register accesses, the bridge the words written into it (edge-pci-bridge) and moved by its DMA over PCI.
std::vector<ChartLink> chart_links(const ChartView& view);

}  // namespace stereotlm::report
