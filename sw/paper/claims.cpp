#include "sw/paper/claims.h"

#include <fmt/format.h>

#include <cstdint>
#include <utility>

#include "sw/paper/area_fit.h"

namespace stereotlm::paper {
namespace {

// Table 1: window n of n x n, frames per second. 640x480, 80 disparities; 40 MHz stands in Table 2.
constexpr std::pair<int, double> kTable1[] = {{15, 8.7}, {13, 10.0}, {11, 11.8},
                                              {9, 14.5}, {7, 18.9},  {5, 26.0}};
constexpr double kTable1HalfDigit = 0.05;
// The tolerance for rates of tables; all rows of Table 1 but one keep it. A printed row has two or three
// digits, and is rounded by up to 0.57 %.
constexpr double kRatePercent = 0.35;
// Table 2: frames per second at 80, 160 and 200 disparities, 640x480, 7x7, 40 MHz.
constexpr double kTable2Rate = 18.9;
constexpr double kSizeHalfDigit = 0.5;
constexpr double kSizePoints = 1;
// Section 4 gives the rate in practice for windows of 7x7 and 9x9. The abstract and section 5 give it without
// a window. Section 1 says "more than" this rate.
constexpr double kPracticeRate = 20;
// The rate at 320x240, in the abstract. Section 1 says "more than" this rate. Section 4 says four times the
// rate at 640x480.
constexpr double kSmallRate = 80;
constexpr double kSmallSpeedUp = 4;
constexpr double kHalfOfLastDigit = 0.5;
// The number of banks that is needed: with calibration (sections 3.1 and 5), and for matching itself (section
// 3.1).
constexpr double kBanks = 8;
constexpr double kBanksOfMatching = 6;

// Section 2.1 gives no number for "almost same". The rule is ours.
constexpr double kCostPoints = 1;
constexpr const char* kJudgedCosts[] = {"ssd", "zncc"};
constexpr const char* kCostBeside = "{census: 5}";
constexpr std::uint64_t kSyntheticScenes = 3;

constexpr const char* kSources[] = {"the core alone", "the whole computer"};

std::string window_key(int window) { return fmt::format("matcher.window={}", window); }
std::string square(int n) { return fmt::format("{}x{}", n, n); }

// One case per window, for the core alone and for the whole computer.
std::vector<Case> of_windows(double printed, const std::vector<int>& windows, const std::string& preset,
                             const std::vector<std::string>& more) {
  std::vector<Case> cases;
  for (const bool camera : {false, true}) {
    for (const int window : windows) {
      std::vector<std::string> sets = {window_key(window)};
      sets.insert(sets.end(), more.begin(), more.end());
      cases.push_back({square(window) + ", " + kSources[camera ? 1 : 0], printed, {{preset, sets, camera}}});
    }
  }
  return cases;
}

Claim table1() {
  Claim claim = {"table1",
                 "Table 1",
                 "frames per second against the window, 80 disparities",
                 Quantity::kRate,
                 {Relation::kWithinPercent, kRatePercent, ""},
                 kTable1HalfDigit,
                 {}};
  for (const auto& [window, rate] : kTable1) {
    claim.cases.push_back({square(window),
                           rate,
                           {{kBoard, {window_key(window), "matcher.filter=none"}, false},
                            {kBoard, {window_key(window)}, false}}});
  }
  return claim;
}

std::string disparities_key(int disparities) { return fmt::format("matcher.disparities={}", disparities); }

Claim table2_size() {
  Claim claim = {"table2_size",
                 "Table 2",
                 "circuit size against the disparities, 7x7",
                 Quantity::kSlices,
                 {Relation::kWithin, kSizePoints, "percentage point"},
                 kSizeHalfDigit,
                 {}};
  for (const PrintedArea& row : table_2()) {
    claim.cases.push_back({fmt::format("{} disparities", row.core.disparities),
                           row.slices_percent,
                           {{kBoard, {disparities_key(row.core.disparities)}, false}}});
  }
  return claim;
}

Claim table2_rate() {
  Claim claim = {"table2_rate",
                 "Table 2",
                 "frames per second against the disparities, 7x7",
                 Quantity::kRate,
                 {Relation::kWithinPercent, kRatePercent, ""},
                 kTable1HalfDigit,
                 {}};
  for (const PrintedArea& row : table_2()) {
    claim.cases.push_back(
        {fmt::format("{} disparities", row.core.disparities),
         kTable2Rate,
         {{kBoard, {disparities_key(row.core.disparities), "matcher.filter=none"}, false}}});
  }
  return claim;
}

Claim table2_constant() {
  Claim claim = {"table2_constant",
                 "sec. 4",
                 "frames per second do not change with the disparities",
                 Quantity::kSpread,
                 {Relation::kWithin, kTable1HalfDigit, "frames/s"},
                 0,
                 {}};
  Case rows = {"80, 160 and 200 disparities", 0, {}};
  for (const Case& row : table2_rate().cases) rows.runs.push_back(row.runs.front());
  claim.cases.push_back(rows);
  return claim;
}

Claim practice() {
  return {"practice",
          "sec. 4",
          "20 frames per second in practice, at 7x7 and 9x9",
          Quantity::kRate,
          {Relation::kAtLeast, kHalfOfLastDigit, "frames/s"},
          kHalfOfLastDigit,
          of_windows(kPracticeRate, {7, 9}, kBoard, {})};
}

Claim any_window() {
  return {"any_window",
          "abstract, sec. 5",
          "20 frames per second",
          Quantity::kRate,
          {Relation::kAtLeast, kHalfOfLastDigit, "frames/s"},
          kHalfOfLastDigit,
          of_windows(kPracticeRate, {5, 7, 9}, kBoard, {})};
}

Claim more_than_any_window() {
  return {"more_any_window",
          "sec. 1",
          "more than 20 frames per second, with disparities up to 200",
          Quantity::kRate,
          {Relation::kMore, 0, ""},
          kHalfOfLastDigit,
          of_windows(kPracticeRate, {5, 7, 9}, kBoard, {disparities_key(200)})};
}

Claim small() {
  return {"small",
          "abstract",
          "80 frames per second at 320x240",
          Quantity::kRate,
          {Relation::kAtLeast, kHalfOfLastDigit, "frames/s"},
          kHalfOfLastDigit,
          of_windows(kSmallRate, {5, 7, 9}, "fpl2003-qvga", {})};
}

Claim more_than_small() {
  return {"more_small",
          "sec. 1",
          "more than 80 frames per second at 320x240",
          Quantity::kRate,
          {Relation::kMore, 0, ""},
          kHalfOfLastDigit,
          of_windows(kSmallRate, {5, 7, 9}, "fpl2003-qvga", {})};
}

Claim small_speed_up() {
  Claim claim = {"small_speed_up",
                 "sec. 4",
                 "four times as fast at 320x240, at 7x7 and 9x9",
                 Quantity::kSpeedUp,
                 {Relation::kWithinPercent, kRatePercent, ""},
                 0,
                 of_windows(kSmallSpeedUp, {7, 9}, "fpl2003-qvga", {})};
  for (Case& one : claim.cases) {
    BoardRun large = one.runs.front();
    large.preset = kBoard;
    one.runs.push_back(large);
  }
  return claim;
}

Claim banks() {
  return {"banks",
          "sec. 3.1, 5",
          "at least eight memory banks, the core alone",
          Quantity::kBanksProved,
          {Relation::kAtLeast, 0, ""},
          0,
          {{"the core alone, every allocation", kBanks, {{kBoard, {}, false}}}}};
}

Claim banks_of_matching() {
  return {"banks_of_matching",
          "sec. 3.1",
          "six memory banks for matching itself",
          Quantity::kBanksProved,
          {Relation::kAtLeast, 0, ""},
          0,
          {{"the core alone, every allocation", kBanksOfMatching, {{"fpl2003-no-calibration", {}, false}}}}};
}

std::string key(const std::string& buffer, const std::string& bank) {
  return fmt::format("allocation.{}={}", buffer, bank);
}
std::string key(const std::string& buffer, const std::string& first, const std::string& second) {
  return key(buffer, fmt::format("[{}, {}]", first, second));
}

// The whole computer with chosen allocations: for each number of banks the best one that `allocate` finds.
// Buffers that are not named keep the board's banks.
Claim banks_of_computer() {
  const std::vector<std::vector<std::string>> placed = {
      {},
      {key("disparity", "bank4", "bank4"), key("left_lut", "bank5"), key("right_lut", "bank6")},
      {key("disparity", "bank1", "bank3"), key("left_lut", "bank4"), key("right_lut", "bank5")},
      {key("left_image", "bank0", "bank0"), key("right_image", "bank1", "bank1"),
       key("disparity", "bank2", "bank2"), key("left_lut", "bank3"), key("right_lut", "bank4")}};
  Case some = {"the whole computer, some allocations", kBanks, {}};
  for (const auto& sets : placed) some.runs.push_back({kBoard, sets, true});
  return {"banks_of_computer",
          "sec. 3.1, 5",
          "at least eight memory banks, the whole computer",
          Quantity::kBanksFound,
          {Relation::kAtLeast, 0, ""},
          0,
          {some}};
}

Scene synthetic_scene(std::uint64_t seed) {
  return {fmt::format("synthetic {}", seed), {"--synthetic", std::to_string(seed)}, seed};
}

Scene scene_of(const GivenPair& pair) {
  return {"the given pair",
          {"--left", pair.left, "--right", pair.right, "--truth", pair.truth, "--truth-scale",
           fmt::format("{}", pair.truth_scale)},
          std::nullopt};
}

// One case for each judged cost on the scene. `sets`: what the board of the scene changes.
std::vector<Case> of_costs(const Scene& scene, const std::vector<std::string>& sets) {
  const auto run_of = [&](const std::string& cost) {
    BoardRun run = {kBoard, sets, false, scene};
    run.sets.push_back("matcher.cost=" + cost);
    return run;
  };
  std::vector<Case> cases;
  for (const char* const cost : kJudgedCosts)
    cases.push_back({fmt::format("{}, {}", cost, scene.name), 0, {run_of("sad"), run_of(cost)}});
  cases.back().runs.push_back(run_of(kCostBeside));
  return cases;
}

Claim costs(const std::optional<GivenPair>& given) {
  Claim claim = {"costs",
                 "sec. 2.1",
                 "almost the same results with SAD as with SSD and NCC",
                 Quantity::kAccuracyChange,
                 {Relation::kWithin, kCostPoints, "percentage point"},
                 0,
                 {}};
  const auto add = [&claim](const std::vector<Case>& cases) {
    claim.cases.insert(claim.cases.end(), cases.begin(), cases.end());
  };
  for (std::uint64_t seed = 1; seed <= kSyntheticScenes; ++seed) add(of_costs(synthetic_scene(seed), {}));
  if (given) add(of_costs(scene_of(*given), {disparities_key(given->disparities)}));
  return claim;
}

}  // namespace

std::string unit_of(Quantity quantity) {
  switch (quantity) {
    case Quantity::kRate:
    case Quantity::kSpread:
      return "frames/s";
    case Quantity::kSlices:
      return "% of the slices";
    case Quantity::kSpeedUp:
      return "times";
    case Quantity::kAccuracyChange:
      return "percentage points";
    case Quantity::kBanksProved:
    case Quantity::kBanksFound:
      break;
  }
  return "banks";
}

std::vector<Claim> claims(const std::optional<GivenPair>& given) {
  return {table1(),
          table2_size(),
          table2_rate(),
          table2_constant(),
          practice(),
          any_window(),
          more_than_any_window(),
          small(),
          more_than_small(),
          small_speed_up(),
          banks(),
          banks_of_matching(),
          banks_of_computer(),
          costs(given)};
}

}  // namespace stereotlm::paper
