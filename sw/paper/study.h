#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "platform/statistics.h"
#include "sw/explore/sweep/sweep.h"
#include "sw/paper/claims.h"

namespace stereotlm::paper {

// The accuracy of disparities, in percent. Only pixels count whose truth is known and which both cameras see.
struct Quality {
  double wrong_percent = 0;     // share of the answered pixels that are wrong by more than 1 disparity
  double answered_percent = 0;  // share of the pixels that have a valid disparity
};

// The figures of a simulated board.
struct Measured {
  // Frames per second of the core alone, or of the computer from the first delivery to the last.
  double rate = 0;
  std::optional<double> delivered;  // frames per second of the computer from time 0 to the last delivery
  double bound = 0;                 // upper bound for the rate, frames per second
  std::string limited_by;           // the resource that limits the bound
  double slices_percent = 0;
  int banks = 0;                   // number of banks that its allocation uses
  std::optional<Quality> quality;  // of a run with a scene
};

// A row of the table of banks: the best allocation for a number of banks, or a chosen allocation.
struct BankRow {
  std::string of;  // name of the claim
  int banks = 0;
  // Number of allocations that use so many banks and fit, all of which are simulated. nullopt: the allocation
  // was chosen.
  std::optional<std::uint64_t> allocations;
  std::optional<std::uint64_t> reached_by;  // how many of these allocations reach the rate
  Measured measured;                        // figures of the best allocation, or of the chosen one
  std::string allocation;                   // "left_image bank0 bank1, .., right_lut bank7"
  std::string command;
};

// The result for a case of a claim.
struct CaseFinding {
  Case of;
  double modelled = 0;
  std::vector<Measured> runs;  // runs of the case, in order; empty for kBanksProved
  Verdict verdict = Verdict::kOpen;
};

// The result for a claim.
struct ClaimFinding {
  Claim claim;
  std::vector<CaseFinding> cases;  // in the order of the claim
  Verdict verdict = Verdict::kOpen;
};

// The result of study().
struct Findings {
  std::vector<ClaimFinding> claims;
  std::vector<BankRow> banks;

  const ClaimFinding& of(const std::string& claim) const;  // throws std::out_of_range
};

// What study() needs to simulate boards.
struct Means {
  explore::Evaluate evaluate;
  // platform::core_bound() without calibration.
  std::function<platform::Bound(const platform::BoardConfig& board)> bound;
  // Simulates one frame of the core alone, without calibration, that shows the scene. Throws
  // std::runtime_error if a share has no pixels.
  std::function<Quality(const platform::BoardConfig& board, const Scene& scene)> quality;
  // Called several times a second with the number of boards that are done, and an upper limit for the number
  // of boards that are left. study() ends if it returns false.
  std::function<bool(std::uint64_t done, std::uint64_t most_left)> keep_going;
};

// Simulates the boards of the claims. Returns nullopt if `keep_going` has ended the study. Throws
// std::runtime_error if a board cannot be simulated.
std::optional<Findings> study(const std::vector<Claim>& claims, const Means& means);

// A row of the table of costs: a run of a claim about Quantity::kAccuracyChange.
struct CostRow {
  std::string scene;
  std::string cost;  // "sad", "census 5"
  Quality quality;
  Quality change;  // quality minus the quality of the first run on the scene
  double slices_percent = 0;
  std::optional<Verdict> verdict;  // nullopt: the run is not compared
  std::string command;
};
// The rows of such a claim, each run once.
std::vector<CostRow> cost_rows(const ClaimFinding& found);

// A scene of such a claim. A scene on which the first run is wrong in more than stats::kDoubtfulBad1Percent
// of its answers does not judge: its cases are open.
struct SceneFinding {
  Scene scene;
  double wrong_percent = 0;  // of the first run
  bool judges = false;
};
std::vector<SceneFinding> scenes_of(const ClaimFinding& found);

platform::BoardConfig board_of(const BoardRun& run);

// The shell command that reproduces the number of a run: "stereotlm run fpl2003 --timing-only ..".
std::string command_of(const BoardRun& run);
// The commands that reproduce the numbers of a case.
std::vector<std::string> commands_of(const Claim& claim, const Case& one);

// The FPGA clocks at which the core alone would reach a printed rate, that is, any rate that rounds to it.
struct ClockRange {
  double least_mhz = 0;
  double most_mhz = 0;
};
// The clocks for the printed rate of a case; nullopt unless the case is a rate of the core alone.
std::optional<ClockRange> clock_for(const Claim& claim, const CaseFinding& finding);

// The deviation of the modelled value from the printed one, in percent of the printed one. nullopt if the
// values are numbers of banks, or if the printed value is 0.
std::optional<double> deviation_percent(const Claim& claim, const CaseFinding& finding);

}  // namespace stereotlm::paper
