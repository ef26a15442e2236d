#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "platform/statistics.h"
#include "sw/report/chart/chart_links.h"

namespace stereotlm::report {

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
// makes equally many accesses in each frame, so its grants divide by the frames. The host has the accesses of a
// bank that no other port made. Links around the board have the words since power-up, and that time: a camera
// the pixels that its capture board has written, the CPU its register accesses, the bridge the words written
// into it (edge-pci-bridge) and those that its DMA moved over PCI (edge-bridge-pci).
ChartTraffic chart_traffic(const platform::BoardConfig& board, const platform::Statistics& statistics);

}  // namespace stereotlm::report
