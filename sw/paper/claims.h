#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace stereotlm::paper {

// The paper's board.
inline constexpr const char* kBoard = "fpl2003";

// A stereo pair with ground truth.
struct Scene {
  std::string name;                        // "synthetic 1"
  std::vector<std::string> options;        // the words with which `run` shows it: "--synthetic", "1"
  std::optional<std::uint64_t> synthetic;  // the seed of a synthetic scene; nullopt: the GivenPair
};

// A stereo pair with ground truth that a user gives, as large as the images of kBoard.
struct GivenPair {
  std::string left;  // files
  std::string right;
  std::string truth;
  double truth_scale = 1;  // grey levels of the truth per disparity
  int disparities = 0;     // matcher.disparities that a board needs to find all disparities of the pair
};

// A board as a command line names it. It is run without pixels for explore::frames_of() frames. With a scene,
// the core alone also runs one frame with pixels.
struct BoardRun {
  std::string preset;
  std::vector<std::string> sets;  // KEY=VALUE
  bool camera = false;            // true: the whole computer; false: the core alone
  std::optional<Scene> scene = std::nullopt;
};

enum class Verdict {
  kConfirmed,
  kNotConfirmed,
  kInPart,  // a claim of which only some cases are confirmed
  kOpen,    // the simulated boards do not decide it
};
// "confirmed", "not confirmed", "in part", "open"
std::string text_of(Verdict verdict);

// The rule by which a modelled value confirms a printed one.
enum class Relation {
  kWithinPercent,  // the values differ by at most `tolerance` percent of the printed one
  kWithin,         // the values differ by at most `tolerance`
  kAtLeast,        // the modelled value is at most `tolerance` below the printed one
  kMore,           // the modelled value is above the printed one
};
struct Rule {
  Relation relation = Relation::kWithin;
  double tolerance = 0;
  std::string unit;  // unit of the tolerance, except for percent
};
// "within 0.35 %", "within 1 point", "at least the printed value less 0.5 frames/s", "more than the printed
// value"
std::string text_of(const Rule& rule);

// The quantity that is compared.
enum class Quantity {
  // Frames per second of the first run: of the core alone, or of the computer from the first delivery to the
  // last. The rates of further runs are shown beside it, and not compared.
  kRate,
  kSlices,   // % of the FPGA's slices that the first run's board uses
  kSpread,   // highest rate of the runs minus the lowest
  kSpeedUp,  // rate of the first run divided by the rate of the second run
  // The smallest number of banks with which some allocation is as fast as the fastest allocation on the first
  // run's board. All allocations are searched, so the minimum is proved.
  kBanksProved,
  // The smallest number of banks among the runs that reach the rate of the first run; no proof of a minimum.
  kBanksFound,
  // The second run against the first on the same scene: the change of the share of wrong answers, or the
  // change of the share of answered pixels, whichever is larger. Further runs are shown beside it, and not
  // compared. The paper prints no number, so `printed` is 0: no change.
  kAccuracyChange,
};

// "frames/s", "% of the slices", "times", "banks", "percentage points"
std::string unit_of(Quantity quantity);

// One printed number of a claim, and the boards that are simulated for it.
struct Case {
  std::string name;  // "7x7, the core alone"
  double printed = 0;
  std::vector<BoardRun> runs;
};

// A statement of the paper with numbers.
struct Claim {
  std::string name;   // "table1": one word, also used in the files
  std::string place;  // place in the paper: "Table 1"
  std::string says;   // the statement in a few words
  Quantity quantity = Quantity::kRate;
  Rule rule;
  double half_digit = 0;  // rounding of the printed value: half of its last digit
  std::vector<Case> cases;
};

// All numbers of the paper that are compared, each with its place, its boards and its rule. Costs are
// compared on synthetic scenes, and on the given pair if there is one.
std::vector<Claim> claims(const std::optional<GivenPair>& given = std::nullopt);

// Whether the modelled value of a case confirms the printed one: kConfirmed or kNotConfirmed; kOpen instead
// of kConfirmed for kBanksFound, which is no proof.
Verdict verdict_of(const Claim& claim, double printed, double modelled);

// The verdict on a claim, from the verdicts on its cases. If all cases have the same verdict, the claim has
// it too. Otherwise the verdict is kInPart if some case is confirmed, at least in part, else kNotConfirmed.
// Without cases it is kOpen.
Verdict verdict_of_all(const std::vector<Verdict>& cases);

}  // namespace stereotlm::paper
