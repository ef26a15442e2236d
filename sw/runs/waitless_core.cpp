#include "sw/runs/waitless_core.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "platform/config/buffer_layout.h"
#include "platform/core_run.h"

namespace stereotlm::runs {
namespace {

using platform::BankConfig;
using platform::BoardConfig;

BoardConfig with_a_bank_for_each_buffer(const BoardConfig& board) {
  BoardConfig changed = board;
  changed.banks.clear();
  for (const platform::PlacedBuffer& buffer : platform::buffers(board)) {
    BankConfig bank = *std::find_if(board.banks.begin(), board.banks.end(),
                                    [&](const BankConfig& each) { return each.name == buffer.bank; });
    bank.name = "own" + std::to_string(changed.banks.size());
    platform::move_buffer(changed, buffer, bank.name);
    changed.banks.push_back(std::move(bank));
  }
  return changed;
}

}  // namespace

double waitless_frames_per_second(const platform::BoardConfig& board, const platform::Tables& tables,
                                  std::uint64_t frames) {
  const std::uint64_t turn = std::min(platform::allocation_period_frames(board), frames);
  const std::vector<std::uint64_t> frame_cycles =
      platform::run_core(with_a_bank_for_each_buffer(board), tables, turn).frame_cycles;
  std::uint64_t cycles = 0;
  for (std::uint64_t frame = 0; frame < turn; ++frame)
    cycles += frame_cycles[frame] * ((frames - frame + turn - 1) / turn);
  return board.fpga.clock_mhz * 1e6 * static_cast<double>(frames) / static_cast<double>(cycles);
}

}  // namespace stereotlm::runs
