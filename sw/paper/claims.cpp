#include "sw/paper/claims.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace stereotlm::paper {
namespace {

constexpr const char* kSmallBoard = "fpl2003-qvga";
constexpr const char* kNoFilter = "matcher.filter=none";

std::string window_key(int window) { return fmt::format("matcher.window={}", window); }
std::string disparities_key(int disparities) { return fmt::format("matcher.disparities={}", disparities); }
std::string square(int n) { return fmt::format("{0}x{0}", n); }

// Window n of n x n and frames per second at 640x480 with 80 disparities; 40 MHz stands in Table 2.
std::vector<Case> table_1() {
  constexpr std::pair<int, double> kRows[] = {{15, 8.7}, {13, 10.0}, {11, 11.8},
                                              {9, 14.5}, {7, 18.9},  {5, 26.0}};
  std::vector<Case> cases;
  for (const auto& [window, rate] : kRows) {
    cases.push_back(
        {square(window), rate, {{kBoard, {window_key(window), kNoFilter}}, {kBoard, {window_key(window)}}}});
  }
  return cases;
}

// Disparities and percent of the slices at 640x480 with 7x7. The area model is fitted to these sizes.
constexpr std::pair<int, double> kTable2[] = {{80, 21}, {160, 43}, {200, 54}};
constexpr double kTable2Rate = 18.9;  // frames per second of all three rows

std::vector<Case> table_2_sizes() {
  std::vector<Case> cases;
  for (const auto& [disparities, percent] : kTable2) {
    cases.push_back(
        {fmt::format("{} disparities", disparities), percent, {{kBoard, {disparities_key(disparities)}}}});
  }
  return cases;
}

std::vector<Case> table_2_rates() {
  std::vector<Case> cases = table_2_sizes();
  for (Case& one : cases) {
    one.printed = kTable2Rate;
    one.runs.front().sets.emplace_back(kNoFilter);
  }
  return cases;
}

// One case with the runs of all rows of Table 2.
std::vector<Case> table_2_together() {
  Case rows = {"80, 160 and 200 disparities", 0, {}};
  for (const Case& row : table_2_rates()) rows.runs.push_back(row.runs.front());
  return {rows};
}

// One case per window, for the core alone and for the whole computer.
std::vector<Case> of_windows(double printed, const std::vector<int>& windows, const std::string& preset,
                             const std::vector<std::string>& more = {}) {
  std::vector<Case> cases;
  for (const bool camera : {false, true}) {
    for (const int window : windows) {
      std::vector<std::string> sets = {window_key(window)};
      sets.insert(sets.end(), more.begin(), more.end());
      cases.push_back({square(window) + (camera ? ", the whole computer" : ", the core alone"),
                       printed,
                       {{preset, sets, camera}}});
    }
  }
  return cases;
}

// The small board, and the large one with the same window.
std::vector<Case> small_and_large(double speed_up) {
  std::vector<Case> cases = of_windows(speed_up, {7, 9}, kSmallBoard);
  for (Case& one : cases) {
    one.runs.push_back(one.runs.front());
    one.runs.back().preset = kBoard;
  }
  return cases;
}

std::vector<Case> every_allocation(double banks, const char* preset) {
  return {{"the core alone, every allocation", banks, {{preset, {}}}}};
}

// The whole computer with chosen allocations: for each number of banks the best one that `allocate` finds.
// Buffers that are not named keep the board's banks.
std::vector<Case> chosen_allocations(double banks) {
  const std::vector<std::vector<std::string>> placed = {
      {},
      {"disparity=[bank4, bank4]", "left_lut=bank5", "right_lut=bank6"},
      {"disparity=[bank1, bank3]", "left_lut=bank4", "right_lut=bank5"},
      {"left_image=[bank0, bank0]", "right_image=[bank1, bank1]", "disparity=[bank2, bank2]",
       "left_lut=bank3", "right_lut=bank4"}};
  Case some = {"the whole computer, some allocations", banks, {}};
  for (std::vector<std::string> sets : placed) {
    for (std::string& set : sets) set = "allocation." + set;
    some.runs.push_back({kBoard, sets, true});
  }
  return {some};
}

// One case for each judged cost on each scene. Census, which the paper does not name, is shown beside.
std::vector<Case> costs(const std::optional<GivenPair>& given) {
  std::vector<Case> cases;
  const auto add = [&cases](const Scene& scene, const std::vector<std::string>& sets) {
    const auto run_of = [&](const std::string& cost) {
      BoardRun run = {kBoard, sets, false, scene};
      run.sets.push_back("matcher.cost=" + cost);
      return run;
    };
    for (const char* const cost : {"ssd", "zncc"})
      cases.push_back({fmt::format("{}, {}", cost, scene.name), 0, {run_of("sad"), run_of(cost)}});
    cases.back().runs.push_back(run_of("{census: 5}"));
  };
  for (const std::uint64_t seed : {1U, 2U, 3U})
    add({fmt::format("synthetic {}", seed), {"--synthetic", std::to_string(seed)}, seed}, {});
  if (given) {
    add({"the given pair",
         {"--left", given->left, "--right", given->right, "--truth", given->truth, "--truth-scale",
          fmt::format("{}", given->truth_scale)},
         std::nullopt},
        {disparities_key(given->disparities)});
  }
  return cases;
}

// A row of claims(), in the order of the fields.
Claim claim(const char* name, const char* place, const char* says, Quantity quantity, const Rule& rule,
            double half_digit, std::vector<Case> cases) {
  return {name, place, says, quantity, rule, half_digit, std::move(cases)};
}

}  // namespace

std::vector<Claim> claims(const std::optional<GivenPair>& given) {
  using Q = Quantity;
  // All rows of Table 1 but one keep this tolerance. A printed row has two or three digits, and is rounded by
  // up to 0.57 %.
  const Rule rate = {Relation::kWithinPercent, 0.35, ""};
  const Rule least = {Relation::kAtLeast, 0.5, "frames/s"};
  const Rule more = {Relation::kMore, 0, ""};
  const Rule banks = {Relation::kAtLeast, 0, ""};
  // Section 2.1 gives no number for "almost same". The rule is ours.
  const Rule point = {Relation::kWithin, 1, "percentage point"};
  const std::vector<int> all = {5, 7, 9};
  // Where the paper gives no window, all of them are compared: the abstract and sections 1 and 5.
  return {claim("table1", "Table 1", "frames per second against the window, 80 disparities", Q::kRate, rate,
                0.05, table_1()),
          claim("table2_size", "Table 2", "circuit size against the disparities, 7x7", Q::kSlices, point, 0.5,
                table_2_sizes()),
          claim("table2_rate", "Table 2", "frames per second against the disparities, 7x7", Q::kRate, rate,
                0.05, table_2_rates()),
          claim("table2_constant", "sec. 4", "frames per second do not change with the disparities",
                Q::kSpread, {Relation::kWithin, 0.05, "frames/s"}, 0, table_2_together()),
          claim("practice", "sec. 4", "20 frames per second in practice, at 7x7 and 9x9", Q::kRate, least,
                0.5, of_windows(20, {7, 9}, kBoard)),
          claim("any_window", "abstract, sec. 5", "20 frames per second", Q::kRate, least, 0.5,
                of_windows(20, all, kBoard)),
          claim("more_any_window", "sec. 1", "more than 20 frames per second, with disparities up to 200",
                Q::kRate, more, 0.5, of_windows(20, all, kBoard, {disparities_key(200)})),
          claim("small", "abstract", "80 frames per second at 320x240", Q::kRate, least, 0.5,
                of_windows(80, all, kSmallBoard)),
          claim("more_small", "sec. 1", "more than 80 frames per second at 320x240", Q::kRate, more, 0.5,
                of_windows(80, all, kSmallBoard)),
          claim("small_speed_up", "sec. 4", "four times as fast at 320x240, at 7x7 and 9x9", Q::kSpeedUp,
                rate, 0, small_and_large(4)),
          claim("banks", "sec. 3.1, 5", "at least eight memory banks, the core alone", Q::kBanksProved, banks,
                0, every_allocation(8, kBoard)),
          claim("banks_of_matching", "sec. 3.1", "six memory banks for matching itself", Q::kBanksProved,
                banks, 0, every_allocation(6, "fpl2003-no-calibration")),
          claim("banks_of_computer", "sec. 3.1, 5", "at least eight memory banks, the whole computer",
                Q::kBanksFound, banks, 0, chosen_allocations(8)),
          claim("costs", "sec. 2.1", "almost the same results with SAD as with SSD and NCC",
                Q::kAccuracyChange, point, 0, costs(given))};
}

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

std::string text_of(Verdict verdict) {
  constexpr const char* kTexts[] = {"confirmed", "not confirmed", "in part", "open"};
  return kTexts[static_cast<std::size_t>(verdict)];
}

std::string text_of(const Rule& rule) {
  const std::string unit = rule.unit.empty() ? "" : ' ' + rule.unit;
  if (rule.relation == Relation::kWithinPercent) return fmt::format("within {:g} %", rule.tolerance);
  if (rule.relation == Relation::kWithin) return fmt::format("within {:g}{}", rule.tolerance, unit);
  if (rule.relation == Relation::kMore) return "more than the printed value";
  if (rule.tolerance == 0) return "at least the printed value";
  return fmt::format("at least the printed value less {:g}{}", rule.tolerance, unit);
}

Verdict verdict_of(const Claim& claim, double printed, double modelled) {
  const Rule& rule = claim.rule;
  const double most =
      rule.relation == Relation::kWithinPercent ? rule.tolerance * std::abs(printed) / 100 : rule.tolerance;
  const double below = printed - modelled;
  const bool holds = rule.relation == Relation::kMore      ? below < 0
                     : rule.relation == Relation::kAtLeast ? below <= most
                                                           : std::abs(below) <= most;
  if (!holds) return Verdict::kNotConfirmed;
  return claim.quantity == Quantity::kBanksFound ? Verdict::kOpen : Verdict::kConfirmed;
}

Verdict verdict_of_all(const std::vector<Verdict>& cases) {
  if (cases.empty()) return Verdict::kOpen;
  const auto has = [&cases](Verdict one) {
    return std::find(cases.begin(), cases.end(), one) != cases.end();
  };
  if (std::equal(cases.begin() + 1, cases.end(), cases.begin())) return cases.front();
  return has(Verdict::kConfirmed) || has(Verdict::kInPart) ? Verdict::kInPart : Verdict::kNotConfirmed;
}

}  // namespace stereotlm::paper
