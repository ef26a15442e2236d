#include "platform/board.h"

#include <stdexcept>

#include "platform/config/buffer_layout.h"

namespace stereotlm::platform {
namespace {

const BoardConfig& checked(const BoardConfig& config) {
  if (const auto found = problems(config); !found.empty()) throw std::invalid_argument(found.front());
  return config;
}

fpga::StereoCoreConfig stereo_core_config(const BoardConfig& board, fpga::Fidelity fidelity) {
  fpga::StereoCoreConfig config{core_config(board),
                                {board.fpga.arbiter, {}},
                                {board.bridge.local_clock_mhz, buffer_ranges(board)},
                                fidelity};
  for (const BankConfig& bank : board.banks) config.memory.banks.push_back(ssram_config(board, bank));
  return config;
}

}  // namespace

Board::Board(const sc_core::sc_module_name& name, const BoardConfig& config, Binder& binder,
             fpga::Fidelity fidelity)
    : sc_module(name), core("core", stereo_core_config(checked(config), fidelity), binder) {
  banks.init(config.banks.size(), [&config](const char* /*numbered*/, std::size_t bank) {
    return new memory::SsramBank(("ssram_" + config.banks[bank].name).c_str(),
                                 ssram_config(config, config.banks[bank]));
  });
  for (std::size_t bank = 0; bank < banks.size(); ++bank) {
    binder.bind(core.banks[bank], banks[bank].port, "crossbar_to_" + config.banks[bank].name);
  }
}

}  // namespace stereotlm::platform
