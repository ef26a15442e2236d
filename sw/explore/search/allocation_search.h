#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "sw/explore/plan/points.h"
#include "sw/explore/search/allocations.h"

namespace stereotlm::explore {

// What the run of a board has given.
struct AllocationOutcome {
  std::uint64_t cycles = 0;      // frame_cycles of all frames of the run
  double frames_per_second = 0;  // of the core alone, or delivered by time 0 .. last delivery
  std::optional<double> steady;  // of a computer, between the first and the last delivery
  bool loses_pixels = false;     // of a computer: a capture has dropped some
  std::string failure;           // what a run has ended with that could not be simulated; the rest is empty
};

// The best of the placements that use so many banks.
struct BestPlacement {
  int banks = 0;
  std::uint64_t placements = 0;  // that use so many banks and fit
  std::uint64_t known = 0;       // of them, those whose frame rate has been simulated
  std::uint64_t given_up = 0;    // of the others, those whose run was given up
  std::uint64_t losing = 0;      // of those known, those that lose pixels ..
  std::uint64_t failed = 0;      // .. and those whose run has failed: they are out of the competition
  std::uint64_t reached_by = 0;  // how many reach the best; 0: all are out, and what follows is empty
  double frames_per_second = 0;
  AllocationOutcome outcome;  // of its run; where frames are simulated one by one only the cycles, of a turn
  Placement witness;          // the first that reaches it
};

// All placements of a board's buffers, and the boards that have to be simulated to know the best of them for
// each number of banks.
//
// Of the core alone, where a frame leaves nothing behind (frames_are_independent()), these are one frame for
// each way in which the buffers of a frame share banks: all are simulated, and every frame rate is known.
// Else each placement is a run of its own; then those whose bound is below the best known for as many banks
// are left out, and a run may be given up as soon as it cannot reach that any more.
class AllocationSearch {
 public:
  // Frames per second that a run of the board cannot exceed without losing pixels.
  using BoundOf = std::function<double(const platform::BoardConfig& board)>;

  // Of more different placements, fitting or not, there is no search.
  static constexpr std::uint64_t kMostPlacements = 5'000'000;

  // most_banks: 1..banks of the board. run: of every point; its frames are 0 (see frames_of()). Throws
  // std::length_error if there are too many placements.
  AllocationSearch(const platform::BoardConfig& board, int most_banks, const PointRun& run,
                   const BoundOf& bound);

  std::uint64_t placements() const { return placements_; }
  std::uint64_t fitting() const { return fitting_.size(); }
  bool by_frames() const { return by_frames_; }
  const PointRun& run() const { return run_; }

  // The boards to simulate next, by numbers below size(), after what has been recorded; none at the end. They
  // depend on nothing else.
  std::vector<std::size_t> next() const;
  // Throws std::logic_error if a run is faster than its bound.
  void record(std::size_t number, const AllocationOutcome& outcome);
  // Its run could not reach rate_to_reach() any more.
  void record_given_up(std::size_t number) { given_up_.at(number) = true; }
  // What a board has to reach to be the best for its number of banks, as far as is known; 0 where that does
  // not matter.
  double rate_to_reach(std::size_t number) const;
  // Boards that may have to be simulated at most: all, but those that were recorded and those left out so
  // far.
  std::uint64_t most_left() const;

  std::size_t size() const { return outcomes_.size(); }
  Point point(std::size_t number) const;

  // For each number of banks that some placement fits into, the fewest first. Once next() has come to its
  // end.
  std::vector<BestPlacement> best() const;
  // The first board whose run has failed, if any: "ALLOCATION: what it has ended with".
  std::string first_failure() const;

 private:
  AllocationOutcome outcome_of(std::size_t placement) const;  // known
  bool is_known(std::size_t placement) const { return by_frames_ || outcomes_[placement].has_value(); }
  bool is_done(std::size_t placement) const {
    return outcomes_[placement].has_value() || given_up_[placement];
  }
  std::map<int, double> best_rates() const;
  bool can_win(std::size_t placement, const std::map<int, double>& best) const;

  platform::BoardConfig board_;
  PointRun run_;
  bool by_frames_;
  std::uint64_t turn_frames_;
  std::uint64_t placements_ = 0;
  std::vector<Placement> fitting_;
  std::vector<std::size_t> by_bound_;  // places in fitting_, the highest bound first
  std::vector<double> bounds_;         // of fitting_
  std::vector<platform::BoardConfig> frame_boards_;
  std::map<std::string, std::size_t> frame_numbers_;        // of frame boards, by what tells them apart
  std::vector<bool> given_up_;                              // of fitting_
  std::vector<std::optional<AllocationOutcome>> outcomes_;  // of frame boards, or of fitting_
};

// Some boards of a search.
class AllocationPoints : public Points {
 public:
  // `search` outlives it.
  AllocationPoints(const AllocationSearch& search, std::vector<std::size_t> numbers)
      : search_(search), numbers_(std::move(numbers)) {}
  std::uint64_t size() const override { return numbers_.size(); }
  Point point(std::uint64_t number) const override { return search_.point(numbers_.at(number)); }
  const std::vector<Condition>& conditions() const override { return none_; }

 private:
  const AllocationSearch& search_;
  std::vector<std::size_t> numbers_;
  std::vector<Condition> none_;
};

}  // namespace stereotlm::explore
