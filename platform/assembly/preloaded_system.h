#pragma once

#include <cstdint>
#include <functional>
#include <systemc>
#include <vector>

#include "models/binder.h"
#include "models/fpga/access_pattern.h"
#include "models/host/ideal_host.h"
#include "platform/assembly/board.h"
#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "platform/figures/statistics.h"

namespace stereotlm::platform {

// The board with an ideal host that writes its inputs and reads its results (`--source preloaded`).
class PreloadedSystem : public sc_core::sc_module {
 public:
  // `source` and `sink` outlive the system. Throws std::invalid_argument if the board has problems or the
  // tables do not fit the board.
  PreloadedSystem(const sc_core::sc_module_name& name, const BoardConfig& config, const Tables& tables,
                  std::uint64_t frames, host::FrameSource& source, host::FrameSink& sink, Binder& binder,
                  fpga::Fidelity fidelity = fpga::Fidelity::kCycle);

  Board board;           // core and banks
  host::IdealHost host;  // writes inputs, reads results

 private:
  sc_core::sc_signal<bool> done_{"done"};
};

using KeepGoing = std::function<bool(std::uint64_t frames, std::uint64_t cycles)>;  // see run_core()

// Computes the figures of a board with an ideal host (`--source preloaded`) by a loop over the core's control
// and the arbiters, without pixels and without SystemC. The figures equal those of PreloadedSystem at
// Fidelity::kTiming, and take a tenth of the time. A process may call the function any number of times;
// sweeps do. `keep_going`: called after each frame with the frames and the cycles so far; false ends the run
// with these frames.
//
// Throws std::invalid_argument if the tables do not fit the board, or `frames` is 0.
// Throws std::runtime_error if for stall_timeout_cycles the matcher works in no cycle and no result is
// written, because the frame would never end.
Statistics run_core(const BoardConfig& board, const Tables& tables, std::uint64_t frames,
                    const KeepGoing& keep_going = {},
                    std::uint64_t stall_timeout_cycles = std::uint64_t{1} << 26U);
// The lengths of the frames of run_core() alone, of tables with these access_patterns().
std::vector<std::uint64_t> core_frame_cycles(const BoardConfig& board, const fpga::AccessPatterns& patterns,
                                             std::uint64_t frames);
// The same if each request of a port were granted in its cycle.
std::vector<std::uint64_t> waitless_frame_cycles(const BoardConfig& board,
                                                 const fpga::AccessPatterns& patterns, std::uint64_t frames);
// The same. Throws std::invalid_argument if the tables do not fit the board.
std::vector<std::uint64_t> waitless_frame_cycles(const BoardConfig& board, const Tables& tables,
                                                 std::uint64_t frames);

}  // namespace stereotlm::platform
