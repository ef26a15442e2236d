#pragma once

#include <systemc>

#include "models/binder.h"
#include "models/fpga/stereo_core.h"
#include "models/memory/ssram_bank.h"
#include "platform/config/board_config.h"

namespace stereotlm::platform {

// The ADM-XRC-II board: the FPGA and its SSRAM banks, bound together. The board is connected by the sockets
// of its core: `core.registers`, `core.local_bus` and `core.done`.
class Board : public sc_core::sc_module {
 public:
  // Throws std::invalid_argument if the board has problems.
  Board(const sc_core::sc_module_name& name, const BoardConfig& config, Binder& binder,
        fpga::Fidelity fidelity = fpga::Fidelity::kCycle);

  fpga::StereoCore core;
  sc_core::sc_vector<memory::SsramBank> banks;  // in the order of the configuration
};

}  // namespace stereotlm::platform
