#include "platform/board.h"

#include "platform/config/buffer_layout.h"

namespace stereotlm::platform {
namespace {

fpga::StereoCoreConfig stereo_core_config(const BoardConfig& board, fpga::Fidelity fidelity) {
  return {core_config(board),
          {board.fpga.arbiter, ssram_configs(board)},
          {board.bridge.local_clock_mhz, buffer_ranges(board)},
          fidelity};
}

}  // namespace

Board::Board(const sc_core::sc_module_name& name, const BoardConfig& config, Binder& binder,
             fpga::Fidelity fidelity)
    : sc_module(name), core("core", stereo_core_config(require_valid(config), fidelity), binder) {
  banks.init(config.banks.size(), [&config](const char* /*numbered*/, std::size_t bank) {
    return new memory::SsramBank(("ssram_" + config.banks[bank].name).c_str(), ssram_configs(config)[bank]);
  });
  for (std::size_t bank = 0; bank < banks.size(); ++bank) {
    binder.bind(core.banks[bank], banks[bank].port, "crossbar_to_" + config.banks[bank].name);
  }
}

}  // namespace stereotlm::platform
