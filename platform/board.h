#pragma once

#include <systemc>

#include "models/binder.h"
#include "models/fpga/stereo_core.h"
#include "models/memory/ssram_bank.h"
#include "platform/config/board_config.h"
#include "platform/config/buffer_layout.h"

namespace stereotlm::platform {

// The ADM-XRC-II board: the FPGA and its SSRAM banks, bound together. The board is connected by the sockets
// of its core: `core.registers`, `core.local_bus` and `core.done`.
class Board : public sc_core::sc_module {
 public:
  // Throws std::invalid_argument if the board has problems.
  Board(const sc_core::sc_module_name& name, const BoardConfig& config, Binder& binder,
        fpga::Fidelity fidelity = fpga::Fidelity::kCycle)
      : sc_module(name), core("core", stereo_core_config(require_valid(config), fidelity), binder) {
    banks.init(config.banks.size(), [&config](const char* /*numbered*/, std::size_t bank) {
      return new memory::SsramBank(("ssram_" + config.banks[bank].name).c_str(), ssram_configs(config)[bank]);
    });
    for (std::size_t bank = 0; bank < banks.size(); ++bank)
      binder.bind(core.banks[bank], banks[bank].port, "crossbar_to_" + config.banks[bank].name);
  }

  fpga::StereoCore core;                        // with the sockets of the board
  sc_core::sc_vector<memory::SsramBank> banks;  // in the order of the configuration

 private:
  static fpga::StereoCoreConfig stereo_core_config(const BoardConfig& board, fpga::Fidelity fidelity) {
    return {core_config(board),
            {board.fpga.arbiter, ssram_configs(board)},
            {board.bridge.local_clock_mhz, buffer_ranges(board)},
            fidelity};
  }
};

}  // namespace stereotlm::platform
