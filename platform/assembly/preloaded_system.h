#pragma once

#include <cstdint>
#include <systemc>

#include "models/binder.h"
#include "models/host/ideal_host.h"
#include "platform/assembly/board.h"
#include "platform/config/board_config.h"
#include "platform/config/tables.h"

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

}  // namespace stereotlm::platform
