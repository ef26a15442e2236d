#pragma once

#include <systemc>

#include "models/binder.h"
#include "models/fpga/stereo_core.h"
#include "models/memory/ssram_bank.h"
#include "platform/config/board_config.h"
#include "platform/config/buffer_layout.h"
#include "platform/config/tables.h"
#include "platform/figures/collect.h"
#include "platform/figures/statistics.h"

namespace stereotlm::platform {

// The ADM-XRC-II board: the FPGA and its SSRAM banks, bound together. The board is connected by the sockets
// of its core: `core.registers`, `core.local_bus` and `core.done`.
class Board : public sc_core::sc_module {
 public:
  // Throws std::invalid_argument if the board has problems.
  Board(const sc_core::sc_module_name& name, const BoardConfig& config, Binder& binder,
        fpga::Fidelity fidelity = fpga::Fidelity::kCycle);

  fpga::StereoCore core;                        // with the sockets of the board
  sc_core::sc_vector<memory::SsramBank> banks;  // in the order of the configuration
};

// Of all finished frames, and of what the host has done outside frames before `now_ps`. To be called between
// two frames.
BoardCounters counters_of(const Board& board, std::uint64_t now_ps = 0);

// The figures of the frames that `counters` cover, as collect_statistics() in platform/figures/collect.h.
// `counters` were taken from this board, now or earlier.
Statistics collect_statistics(const BoardConfig& config, const Tables& tables, const Board& board,
                              const BoardCounters& counters);
// The figures of all finished frames. To be called between two frames.
Statistics collect_statistics(const BoardConfig& config, const Tables& tables, const Board& board);

}  // namespace stereotlm::platform
