#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "platform/statistics.h"
#include "sw/explore/slurm/batch.h"
#include "sw/paper/claims.h"

namespace stereotlm::paper {

// What the simulation of a board has given.
struct Measured {
  double rate =
      0;  // frames per second: of the core alone, or of the computer between the first delivery and the last
  std::optional<double> delivered;  // of the computer, from time 0 to the last delivery
  double bound = 0;                 // of the core, or of the computer
  std::string limited_by;           // by what that is limited
  double slices_percent = 0;
  int banks = 0;  // that its allocation uses
};

// The best allocations of a number of banks, or one of some.
struct BankRow {
  std::string of;  // name of the claim
  int banks = 0;
  std::optional<std::uint64_t>
      allocations;  // all that use so many and fit, each simulated; nothing: one that was chosen
  std::optional<std::uint64_t> reached_by;  // of them those that reach the rate
  Measured measured;                        // of the best, or of that one
  std::string allocation;                   // "left_image bank0 bank1, .., right_lut bank7"
  std::string command;
};

struct CaseFinding {
  double modelled = 0;
  std::vector<Measured> runs;  // of the case, in its order; none of kBanksProved
  Verdict verdict = Verdict::kOpen;
};

struct ClaimFinding {
  Claim claim;
  std::vector<CaseFinding> cases;  // in its order
  Verdict verdict = Verdict::kOpen;
};

struct Findings {
  std::vector<ClaimFinding> claims;
  std::vector<BankRow> banks;

  const ClaimFinding& of(const std::string& claim) const;  // throws std::out_of_range
};

// How boards are simulated.
struct Means {
  explore::Evaluate evaluate;
  // Of the core alone without calibration, for so many frames: platform::core_bound().
  std::function<platform::Bound(const platform::BoardConfig& board, std::uint64_t frames)> bound;
  std::string version;
  unsigned jobs = 1;
  // Several times a second: of the boards of all searches and runs, those that are done and those that are
  // left at most.
  std::function<bool(std::uint64_t done, std::uint64_t most_left)> keep_going;
};

// Simulates what the claims are about. Nothing if `keep_going` has ended it. Throws std::runtime_error if a
// board cannot be simulated.
std::optional<Findings> study(const std::vector<Claim>& claims, const Means& means);

// The command that gives the number of a run, as typed into a shell: "stereotlm run fpl2003 --timing-only
// ..".
std::string command_of(const BoardRun& run);
// Of a case: those that give the numbers that its own is made of.
std::vector<std::string> commands_of(const Claim& claim, const Case& one);

// At which clock of the FPGA the core alone would reach a printed rate, in MHz: of the least and of the
// greatest value that is printed so. Nothing unless the case is a rate of the core alone.
struct ClockRange {
  double least_mhz = 0;
  double most_mhz = 0;
};
std::optional<ClockRange> clock_for(const Claim& claim, const Case& one, const CaseFinding& finding);

// The modelled value against the printed one, in percent of that; nothing where that would say nothing: of
// banks, and where the printed one is 0.
std::optional<double> deviation_percent(const Claim& claim, const Case& one, const CaseFinding& finding);

}  // namespace stereotlm::paper
