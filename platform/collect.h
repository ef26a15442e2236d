#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "models/fpga/frame_run.h"
#include "models/fpga/port_cycles.h"
#include "models/memory/bank_arbiter.h"
#include "models/memory/memory_config.h"
#include "platform/board.h"
#include "platform/bounds.h"
#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "platform/statistics.h"

namespace stereotlm::platform {

// Counters of a board's modules, summed over the finished frames. They must be taken between two frames,
// because the modules count during a frame. The cost of taking them does not depend on the number of frames.
struct BoardCounters {
  struct Bank {
    memory::ArbiterStats arbiter;
    std::uint64_t uncounted_grants = 0;  // grants outside the counted cycles
    std::uint64_t accesses = 0;          // accesses that reached the bank, including those that it refused
  };
  struct Lane {
    std::uint64_t issued = 0;    // slots that the sequencer has issued
    std::uint64_t consumed = 0;  // slots that the matcher has consumed
  };

  std::size_t frames = 0;
  std::array<fpga::PortCycles, fpga::kPortCount> ports{};  // [port]
  std::vector<Bank> banks;                                 // in the order of the configuration
  Lane left;
  Lane right;
  std::uint64_t packed_words = 0;
  std::uint64_t written_words = 0;
};

BoardCounters counters_of(const Board& board);
// The counters of a core without stages and without a host: all its frames work directly on memory.
BoardCounters counters_of(const fpga::FrameRun& frames, const std::vector<memory::BankArbiter>& arbiters);

// Returns the figures of the frames that `counters` cover, and the bound for these frames. Checks the
// identities of contract section 6; Statistics::failed lists those that do not hold. `counters` were taken
// from this board, now or earlier.
Statistics collect_statistics(const BoardConfig& config, const Tables& tables, const Board& board,
                              const BoardCounters& counters);

// The same for a core that ran without a board. `frame_cycles`: the length of each frame.
Statistics collect_statistics(const BoardConfig& config, const FrameAccesses& accesses,
                              const std::string& fidelity, const std::vector<std::uint64_t>& frame_cycles,
                              const BoardCounters& counters);

// The figures of all finished frames. To be called between two frames.
inline Statistics collect_statistics(const BoardConfig& config, const Tables& tables, const Board& board) {
  return collect_statistics(config, tables, board, counters_of(board));
}

}  // namespace stereotlm::platform
