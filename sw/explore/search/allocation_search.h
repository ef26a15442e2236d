#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "sw/explore/plan/points.h"
#include "sw/explore/sweep/sweep.h"

namespace stereotlm::explore {

// The bank of each buffer, as an index of BoardConfig::banks, in the order of platform::buffers().
using Placement = std::vector<int>;

// The number of different banks that a placement uses.
int banks_used(const Placement& placement);

// Whether each bank is deep enough for its buffers.
bool fits(const platform::BoardConfig& board, const Placement& placement);

// Visits every placement of the board's buffers, none of which is striped, in at most `most_banks` of its
// banks. Among placements that differ only by an exchange of equal banks (same depth, kind and timing), it
// visits only the one that uses the equal banks in the board's order. Placements come in the order of the
// first buffer's bank, then of the second buffer's bank, and so on. Those that do not fit are visited too.
void for_each_placement(const platform::BoardConfig& board, int most_banks,
                        const std::function<void(const Placement&)>& visit);

// The board with its buffers in the banks of the placement.
platform::BoardConfig placed(const platform::BoardConfig& board, const Placement& placement);

// Whether a frame of the core alone leaves no state behind that the next frame could observe. That holds if
// the arbitration policy forgets, and no bank has turnaround or is SDRAM. (Round robin keeps the place of its
// search; a bank with turnaround keeps the direction of its last access, and SDRAM its open rows.)
bool frames_are_independent(const platform::BoardConfig& board);

// A board that computes only frame number `frame` of the placement: it has only the buffers of that frame.
// Its name is "one frame of NAME", for those who read it in a database. Each bank of the placement is
// replaced by the first equal bank that has not yet replaced another one. If frames_are_independent(), frames
// with the same such board take the same number of cycles, also in different placements.
platform::BoardConfig board_of_frame(const platform::BoardConfig& board, const Placement& placement,
                                     std::uint64_t frame);

// "left_image bank0 bank1, .., right_lut bank0"
std::string allocation_text(const platform::BoardConfig& board);

// The result of the run of a board.
struct AllocationOutcome {
  std::uint64_t cycles = 0;      // sum of frame_cycles of all frames
  double frames_per_second = 0;  // of the core alone; or the steady rate of a computer
  double uncertainty = 0;        // of the steady rate, see platform::SteadyRate
  bool loses_pixels = false;     // a capture of a computer has dropped pixels
  std::string failure;  // the reason if the board could not be simulated; the other members are empty
};

// The best of the placements that use a given number of banks. Placements that lose pixels or have failed do
// not count. Placements tie if none of them is known to be slower than another, see AllocationSearch.
struct BestPlacement {
  int banks = 0;
  std::uint64_t placements = 0;  // placements that use so many banks and fit
  std::uint64_t known = 0;       // placements whose frame rate was simulated
  std::uint64_t given_up = 0;    // placements whose run was given up
  std::uint64_t losing = 0;      // known placements that lose pixels
  std::uint64_t failed = 0;      // known placements whose run has failed
  std::uint64_t tied = 0;        // placements that tie for the best; 0: none counts, and the rest is empty
  AllocationOutcome outcome;     // of the witness
  Placement witness;             // of those that tie, the first with the highest rate
};

// The placements that tie for the best of all.
struct BestOfAll {
  std::uint64_t tied = 0;
  AllocationOutcome highest;              // the highest rate of a placement that ties
  double possible_frames_per_second = 0;  // no placement whose rate is known can have more
  int banks = 0;                          // the fewest banks of a placement that ties
  AllocationOutcome outcome;              // of the witness
  Placement witness;                      // of those with so few banks, the first with the highest rate
};

// Finds the best placement of a board's buffers for each number of banks. It selects the boards to simulate,
// and the caller records their results.
//
// A run with rate r and uncertainty u, and the bound b of its placement, give the rate of a long run: at
// least r - u, at most min(r + u, b). A placement is known to be slower than another if its highest possible
// rate is below the lowest possible rate of the other. All others tie.
//
// If frames_are_independent() and the core runs alone, the search is by frames. It needs a simulation of one
// frame for each way in which the buffers of a frame share banks, and computes the rate of every placement
// from these. Otherwise each placement is a run. A placement is left out if its bound shows that it is slower
// than another with as many banks. A run may be given up once its rate shows the same.
class AllocationSearch {
 public:
  // Called while placements are compared, with how many of them were. May throw, which ends the constructor.
  using Watch = std::function<void(std::uint64_t done, std::uint64_t of)>;
  // An upper bound of the frames per second of a board that loses no pixels.
  using BoundOf = std::function<double(const platform::BoardConfig& board)>;

  // Limit of different placements, whether they fit or not.
  static constexpr std::uint64_t kMostPlacements = 5'000'000;

  // most_banks: 1..banks of the board. run: the run of every placement, of whole turns of the lists. Throws
  // std::length_error if there are more than kMostPlacements placements.
  AllocationSearch(
      const platform::BoardConfig& board, int most_banks, const PointRun& run, const BoundOf& bound,
      const Watch& watch = [](std::uint64_t /*done*/, std::uint64_t /*of*/) {});

  std::uint64_t placements() const { return placements_; }
  std::uint64_t fitting() const { return fitting_.size(); }
  bool by_frames() const { return by_frames_; }
  const PointRun& run() const { return run_; }

  // The numbers, below size(), of the boards to simulate next; none at the end of the search. They depend
  // only on the results recorded so far.
  std::vector<std::size_t> next() const;
  // Throws std::logic_error if a run is faster than its bound by more than its uncertainty.
  void record(std::size_t number, const AllocationOutcome& outcome);
  // Records that the run was given up, because its rate plus its uncertainty was below rate_to_reach().
  void record_given_up(std::size_t number) { given_up_.at(number) = true; }
  // The frames per second that a board must reach to tie for the best of its number of banks, among the
  // results so far. 0: the board is simulated in any case.
  double rate_to_reach(std::size_t number) const;
  // The largest number of boards that may still have to be simulated: all boards except those that were
  // recorded, given up or left out so far.
  std::uint64_t most_left() const { return left().size(); }

  std::size_t size() const { return outcomes_.size(); }
  Point point(std::size_t number) const;

  // The best placement for each number of banks that can hold the buffers, the fewest banks first, among the
  // results so far. Final once next() returns no boards.
  std::vector<BestPlacement> best() const;
  // nullopt if no placement counts so far.
  std::optional<BestOfAll> best_of_all() const;
  // For each number of banks: the largest bound of the placements whose rate is unknown because they were not
  // simulated yet, or have failed. Placements that were left out or given up do not count. A number of banks
  // without such placements is absent. `bound`: that of the constructor.
  std::map<int, double> open_bounds(const BoundOf& bound) const;
  // "ALLOCATION: REASON" of the first board whose run has failed; empty if no run has failed.
  std::string first_failure() const;

 private:
  // nullopt until all boards of the placement are simulated.
  std::optional<AllocationOutcome> outcome_of(std::size_t placement) const;
  // The numbers of the boards that may still have to be simulated, in the order of their simulation.
  std::vector<std::size_t> left() const;
  // A placement that counts.
  struct Rated {
    std::size_t place;  // index of fitting_
    int banks;
    AllocationOutcome outcome;
    double least;  // frames per second of a long run
    double most;
  };
  std::vector<Rated> rated() const;
  // The frames per second that a placement must reach to tie, for each number of banks.
  static std::map<int, double> rates_to_reach(const std::vector<Rated>& rated);
  bool may_tie(std::size_t placement, const std::map<int, double>& rates_to_reach) const;

  platform::BoardConfig board_;
  PointRun run_;
  bool by_frames_;
  std::uint64_t turn_frames_;  // frames in one turn of the allocation's lists
  std::uint64_t placements_ = 0;
  std::vector<Placement> fitting_;
  std::vector<double> bounds_;  // [index of fitting_]: frames per second
  std::vector<platform::BoardConfig> frame_boards_;
  std::vector<std::size_t> frame_numbers_;  // [index of fitting_ * turn_frames_ + frame]: of frame_boards_
  // By the number of a board, which is an index of frame_boards_ if by_frames_, else of fitting_.
  std::vector<bool> given_up_;                              // whether the run was given up
  std::vector<std::optional<AllocationOutcome>> outcomes_;  // the result, once it is known
  std::vector<std::size_t> order_;  // all numbers; of placements the highest bound first
};

// The progress of simulate().
struct SearchProgress {
  std::uint64_t done = 0;       // boards with a result
  std::uint64_t simulated = 0;  // those of `done` that the store did not have before
  std::uint64_t most_left = 0;  // upper limit for the boards that are left
  // Whether most_left excludes the boards that the first results leave out, which are most boards.
  bool is_narrowed = false;
};

// Simulates the boards that a search selects, until it selects no more, and records the results in the
// search. The results are stored in `sweep.store`. `keep_going` is called several times a second. The search
// ends early if it returns false, and simulate() then returns false; results until then are recorded. A board
// that could not be simulated is recorded as failed. Throws as sweep() does.
bool simulate(AllocationSearch& search, const Evaluate& evaluate, const SweepOptions& sweep,
              const std::function<bool(const SearchProgress& progress)>& keep_going);

}  // namespace stereotlm::explore
