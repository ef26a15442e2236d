#include "platform/assembly/board.h"

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
  for (std::size_t bank = 0; bank < banks.size(); ++bank)
    binder.bind(core.banks[bank], banks[bank].port, "crossbar_to_" + config.banks[bank].name);
}

BoardCounters counters_of(const Board& board, std::uint64_t now_ps) {
  const fpga::StereoCore& core = board.core;
  const fpga::CoreDatapath& datapath = core.datapath();
  BoardCounters counters = counters_of(core.frames(), core.crossbar().arbitration(), &core.host_port(),
                                       core.clock().edge_at_or_after(now_ps));
  for (std::size_t bank = 0; bank < board.banks.size(); ++bank) {
    const memory::SsramBank::Stats& stats = board.banks[bank].stats();
    counters.banks[bank].accesses +=
        stats.reads + stats.writes + stats.errors + core.crossbar().direct_accesses(bank);
  }
  for (const fpga::Side side : fpga::kSides)
    counters.issued[fpga::index_of(side)] += datapath.sequencer().slots(side);
  counters.packed_words += datapath.result_packer().words();
  counters.written_words += datapath.result_writer().writes();
  return counters;
}

Statistics collect_statistics(const BoardConfig& config, const Tables& tables, const Board& board,
                              const BoardCounters& counters) {
  const bool is_cycle = fpga::steps_cycles(board.core.fidelity());
  return collect_statistics(config, frame_accesses(config, tables), is_cycle ? "cycle" : "fast",
                            board.core.frames().frame_cycles(), counters);
}

Statistics collect_statistics(const BoardConfig& config, const Tables& tables, const Board& board) {
  return collect_statistics(config, tables, board, counters_of(board));
}

}  // namespace stereotlm::platform
