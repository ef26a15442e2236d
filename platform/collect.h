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
#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "platform/statistics.h"

namespace stereotlm::platform {

// Counters of a board's modules over its finished frames. Valid between two frames only: a running frame has
// counted in part. Taking them costs the same after any number of frames.
struct BoardCounters {
  struct Bank {
    memory::ArbiterStats arbiter;
    std::uint64_t uncounted_grants = 0;  // grants outside the counted cycles
    std::uint64_t accesses = 0;          // accesses that reached the bank, also refused ones
  };
  struct Lane {
    std::uint64_t issued = 0;    // slots
    std::uint64_t consumed = 0;  // slots
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
// What control and arbiters alone have counted. The rest is 0: accesses, slots issued, words packed and written.
BoardCounters counters_of(const fpga::FrameRun& frames, const std::vector<memory::BankArbiter>& arbiters);

// The figures of the frames that `counters` cover, and their bound. Checks the identities of contract section
// 6; `failed` lists those that do not hold. `counters` are of this board, now or earlier.
Statistics collect_statistics(const BoardConfig& config, const Tables& tables, const Board& board,
                              const BoardCounters& counters);

// The same for a core that ran without a board. `frame_cycles`: one entry per frame.
Statistics collect_statistics(const BoardConfig& config, const Tables& tables, const std::string& fidelity,
                              const std::vector<std::uint64_t>& frame_cycles, const BoardCounters& counters);

// The figures of all finished frames. To be called between two frames.
inline Statistics collect_statistics(const BoardConfig& config, const Tables& tables, const Board& board) {
  return collect_statistics(config, tables, board, counters_of(board));
}

}  // namespace stereotlm::platform
