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

// What the parts of a board have counted over the frames that it has finished. To be taken between two
// frames: the counters of a frame under way would be mixed in. Its cost does not grow with the frames.
struct BoardCounters {
  struct Bank {
    memory::ArbiterStats arbiter;
    std::uint64_t uncounted_grants = 0;  // outside the counted cycles
    std::uint64_t accesses = 0;          // that reached the bank, refused ones too
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

// The figures of the frames that `counters` cover, with their bound, and the identities of contract section 6
// checked: those that do not hold are listed in `failed`. `counters` are of this board, now or earlier.
Statistics collect_statistics(const BoardConfig& config, const Tables& tables, const Board& board,
                              const BoardCounters& counters);

// The same of a core that was run without a board: `frame_cycles` of its frames, at this fidelity.
Statistics collect_statistics(const BoardConfig& config, const Tables& tables, const std::string& fidelity,
                              const std::vector<std::uint64_t>& frame_cycles, const BoardCounters& counters);

// Of all frames that the board has finished. To be called between two frames.
inline Statistics collect_statistics(const BoardConfig& config, const Tables& tables, const Board& board) {
  return collect_statistics(config, tables, board, counters_of(board));
}

}  // namespace stereotlm::platform
