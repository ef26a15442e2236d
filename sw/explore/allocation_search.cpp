#include "sw/explore/allocation_search.h"

#include "platform/board_rules.h"

namespace stereotlm::explore {
namespace {

std::string key_of(const platform::BoardConfig& board) {
  std::string key;
  for (const platform::Buffer& buffer : platform::buffers(board.allocation)) key += buffer.bank + ' ';
  return key;
}

}  // namespace

AllocationSearch::AllocationSearch(const platform::BoardConfig& board, int most_banks,
                                   const std::string& calibration)
    : board_(board),
      calibration_(calibration),
      by_frames_(frames_are_independent(board)),
      turn_frames_(platform::allocation_period_frames(board)) {
  for_each_placement(board, most_banks, [this](const Placement& placement) {
    ++placements_;
    if (!fits(board_, placement)) return;
    fitting_.push_back(placement);
    for (std::uint64_t frame = 0; frame < (by_frames_ ? turn_frames_ : 1); ++frame) {
      platform::BoardConfig one =
          by_frames_ ? board_of_frame(board_, placement, frame) : placed(board_, placement);
      if (numbers_.emplace(key_of(one), boards_.size()).second) boards_.push_back(std::move(one));
    }
  });
}

Point AllocationSearch::point(std::uint64_t number) const {
  return make_point(number, boards_.at(number), {false, 0, calibration_});
}

std::uint64_t AllocationSearch::cycles_of(const Placement& placement,
                                          const std::vector<std::uint64_t>& cycles) const {
  if (!by_frames_) return cycles.at(numbers_.at(key_of(placed(board_, placement))));
  std::uint64_t sum = 0;
  for (std::uint64_t frame = 0; frame < turn_frames_; ++frame) {
    sum += cycles.at(numbers_.at(key_of(board_of_frame(board_, placement, frame))));
  }
  return sum;
}

std::vector<BestPlacement> AllocationSearch::best(const std::vector<std::uint64_t>& cycles) const {
  std::map<int, BestPlacement> found;
  for (const Placement& placement : fitting_) {
    const std::uint64_t sum = cycles_of(placement, cycles);
    BestPlacement& best = found[banks_used(placement)];
    ++best.placements;
    if (best.placements == 1 || sum < best.cycles) {
      best.banks = banks_used(placement);
      best.reached_by = 0;
      best.cycles = sum;
      best.witness = placement;
    }
    if (sum == best.cycles) ++best.reached_by;
  }
  std::vector<BestPlacement> all;
  for (auto& [banks, best] : found) {
    best.frames_per_second =
        board_.fpga.clock_mhz * 1e6 * static_cast<double>(turn_frames_) / static_cast<double>(best.cycles);
    all.push_back(best);
  }
  return all;
}

}  // namespace stereotlm::explore
