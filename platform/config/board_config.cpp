#include "platform/config/board_config.h"

#include <numeric>

#include "platform/config/buffer_layout.h"

namespace stereotlm::platform {

memory::BankEnergy energy_of(const BankConfig& bank) {
  const memory::BankEnergy& typical = memory::kBankEnergies[static_cast<std::size_t>(bank.kind)];
  return {bank.standby_mw.value_or(typical.standby_mw), bank.access_pj.value_or(typical.access_pj),
          bank.row_pj.value_or(typical.row_pj), bank.refresh_pj.value_or(typical.refresh_pj)};
}

std::vector<memory::SsramBankConfig> ssram_configs(const BoardConfig& board) {
  std::vector<memory::SsramBankConfig> banks;
  for (const BankConfig& bank : board.banks) {
    banks.push_back({static_cast<std::uint32_t>(bank.words), bank.kind, bank.turnaround_cycles,
                     board.fpga.clock_mhz, bank.sdram});
  }
  return banks;
}

fpga::CoreConfig core_config(const BoardConfig& board) {
  fpga::CoreConfig core;
  core.width = board.image.width;
  core.height = board.image.height;
  core.window = board.matcher.window;
  core.disparities = board.matcher.disparities;
  core.filter = board.matcher.filter;
  core.fetch = board.matcher.fetch;
  core.units = board.matcher.units;
  core.rows = board.matcher.rows;
  core.cost = board.matcher.cost;
  core.lr_tolerance = board.matcher.lr_tolerance;
  core.left_table = board.allocation.left_lut.has_value();
  core.right_table = board.allocation.right_lut.has_value();
  core.joint_tables = board.fpga.joint_tables;
  core.pixel_cache = board.fpga.pixel_cache;
  core.lanes = board.fpga.lanes;
  core.stripes = stripes_of(board);
  core.clock_mhz = board.fpga.clock_mhz;
  core.lane_fifo_slots = board.fpga.lane_fifo_slots;
  core.result_fifo_words = board.fpga.result_fifo_words;
  core.result_delay_cycles = board.fpga.result_delay_cycles;
  core.pipeline_latency_cycles = board.fpga.pipeline_latency_cycles;
  return core;
}

std::uint64_t allocation_period_frames(const BoardConfig& board) {
  const AllocationConfig& allocation = board.allocation;
  return std::lcm(std::lcm(allocation.left_image.size(), allocation.right_image.size()),
                  allocation.disparity.size());
}

}  // namespace stereotlm::platform
