#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "platform/board_config.h"
#include "sw/explore/allocations.h"
#include "sw/explore/points.h"

namespace stereotlm::explore {

// The best of the placements that use so many banks.
struct BestPlacement {
  int banks = 0;
  std::uint64_t placements = 0;  // that use so many banks and fit
  std::uint64_t reached_by = 0;  // how many of them reach the best
  std::uint64_t cycles = 0;      // of a turn of the allocation's lists
  double frames_per_second = 0;  // of the core
  Placement witness;             // the first that reaches it
};

// All placements of a board's buffers for the core alone, and the boards that have to be simulated to know
// the frame rate of each: one frame with each way in which the buffers of a frame share banks, or, where a
// frame leaves something behind, a whole turn of the lists with each placement.
class AllocationSearch : public Points {
 public:
  // most_banks: 1..banks of the board. `calibration`: as in PointRun.
  AllocationSearch(const platform::BoardConfig& board, int most_banks, const std::string& calibration = "");

  std::uint64_t placements() const { return placements_; }
  std::uint64_t fitting() const { return fitting_.size(); }
  bool by_frames() const { return by_frames_; }
  std::uint64_t turn_frames() const { return turn_frames_; }

  std::uint64_t size() const override { return boards_.size(); }
  Point point(std::uint64_t number) const override;
  const std::vector<std::string>& conditions() const override { return none_; }

  // For each number of banks that some placement fits into, the fewest first. cycles: [number of the point],
  // of its run.
  std::vector<BestPlacement> best(const std::vector<std::uint64_t>& cycles) const;
  std::uint64_t cycles_of(const Placement& placement, const std::vector<std::uint64_t>& cycles) const;

 private:
  platform::BoardConfig board_;
  std::string calibration_;
  bool by_frames_;
  std::uint64_t turn_frames_;
  std::uint64_t placements_ = 0;
  std::vector<Placement> fitting_;
  std::vector<platform::BoardConfig> boards_;
  std::map<std::string, std::size_t> numbers_;  // of boards, by what tells them apart
  std::vector<std::string> none_;
};

}  // namespace stereotlm::explore
