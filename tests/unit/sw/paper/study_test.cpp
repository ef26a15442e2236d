#include "sw/paper/study.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <stdexcept>
#include <thread>
#include <vector>

#include "platform/config/buffer_layout.h"

namespace stereotlm::paper {
namespace {

using platform::BoardConfig;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

// Made up: 420 / window frames a second, a tenth less in a computer, and half of it if a table and results
// share a bank.
double made_up_rate(const BoardConfig& board, bool camera) {
  const double rate = 420.0 / board.matcher.window * (camera ? 0.9 : 1);
  return board.allocation.left_lut == board.allocation.disparity[0] ? rate / 2 : rate;
}

explore::Figures made_up(const explore::Point& point) {
  const double rate = made_up_rate(*point.board, point.run.camera);
  explore::Figures figures;
  figures.values = {{"frames_per_second.core", rate},
                    {"bound.core", rate + 1},
                    {"bound.core_limited_by", std::string("matcher")},
                    {"area.slices_percent", point.board->matcher.disparities / 4.0}};
  if (point.run.camera) {
    figures.values.push_back({"frames_per_second.steady", rate});
    figures.values.push_back({"frames_per_second.system", rate - 1});
    figures.values.push_back({"bound.system", rate + 2});
    figures.values.push_back({"bound.system_limited_by", std::string("camera")});
    const std::int64_t lost = point.board->matcher.window == 9 ? 1 : 0;
    figures.values.push_back({"cameras.left.dropped_pixels", lost});
    figures.values.push_back({"cameras.right.dropped_pixels", std::int64_t{0}});
  }
  return figures;
}

Means means() {
  Means means;
  means.evaluate = made_up;
  means.keep_going = [](std::uint64_t, std::uint64_t) { return true; };
  return means;
}

BoardRun run_of(const std::string& set, bool camera = false) { return {"fpl2003", {set}, camera}; }

Claim claim_of(Quantity quantity, double printed, const std::vector<BoardRun>& runs) {
  const bool is_of_banks = quantity == Quantity::kBanksFound || quantity == Quantity::kBanksProved;
  const Rule rule = is_of_banks ? Rule{Relation::kAtLeast, 0, ""} : Rule{Relation::kWithin, 1, ""};
  return {"one", "here", "so", quantity, rule, 0.5, {{"only", printed, runs}}};
}

CaseFinding only(const Claim& claim) { return study({claim}, means()).value().of("one").cases.at(0); }

TEST(Study, TakesTheRateOfTheFirstRunWithItsBound) {
  const CaseFinding found =
      only(claim_of(Quantity::kRate, 61, {run_of("matcher.window=7"), run_of("matcher.window=5")}));
  EXPECT_EQ(found.modelled, 60);
  EXPECT_EQ(found.verdict, Verdict::kConfirmed);
  EXPECT_EQ(found.runs.at(0).bound, 61);
  EXPECT_EQ(found.runs.at(0).limited_by, "matcher");
  EXPECT_EQ(found.runs.at(1).rate, 84);
  // The rate of a computer is the one between deliveries.
  const CaseFinding computer = only(claim_of(Quantity::kRate, 56, {run_of("matcher.window=7", true)}));
  EXPECT_EQ(computer.modelled, 54);
  EXPECT_EQ(computer.verdict, Verdict::kNotConfirmed);
  EXPECT_EQ(computer.runs.at(0).delivered, 53);
  EXPECT_EQ(computer.runs.at(0).bound, 56);
  EXPECT_EQ(computer.runs.at(0).limited_by, "camera");
}

TEST(Study, ComparesRatesAndAreas) {
  const std::vector<BoardRun> two = {run_of("matcher.window=5"), run_of("matcher.window=7")};
  EXPECT_EQ(only(claim_of(Quantity::kSpeedUp, 1, two)).modelled, 84.0 / 60);
  EXPECT_EQ(only(claim_of(Quantity::kSpread, 0, two)).modelled, 24);
  EXPECT_EQ(only(claim_of(Quantity::kSlices, 21, {run_of("matcher.disparities=80")})).modelled, 20);
}

TEST(Study, FindsTheFewestBanksThatReachTheFirstRun) {
  const BoardRun all = {"fpl2003", {}, true};
  const BoardRun seven = {"fpl2003", {"allocation.disparity=[bank4, bank4]"}, true};
  const BoardRun slow = {"fpl2003", {"allocation.left_lut=bank4", "allocation.right_lut=bank5"}, true};
  const CaseFinding open = only(claim_of(Quantity::kBanksFound, 8, {all, slow}));
  EXPECT_EQ(open.modelled, 8);
  EXPECT_EQ(open.verdict, Verdict::kOpen);
  const Findings found = study({claim_of(Quantity::kBanksFound, 8, {all, seven, slow})}, means()).value();
  EXPECT_EQ(found.of("one").cases.at(0).modelled, 7);
  EXPECT_EQ(found.of("one").cases.at(0).verdict, Verdict::kNotConfirmed);
  // A row for each allocation.
  ASSERT_EQ(found.banks.size(), 3U);
  const auto row = std::find_if(found.banks.begin(), found.banks.end(),
                                [](const BankRow& bank_row) { return bank_row.banks == 7; });
  ASSERT_NE(row, found.banks.end());
  EXPECT_EQ(row->allocations, std::nullopt);
  EXPECT_EQ(row->command,
            "stereotlm run fpl2003 --set 'allocation.disparity=[bank4, bank4]' --timing-only --frames 14");
  EXPECT_THAT(row->allocation, HasSubstr("disparity bank4 bank4, left_lut bank6"));
  EXPECT_EQ(found.banks.back().banks, 8);
}

// The core of a board whose frames are independent: a cycle for each buffer beside another one in its bank.
explore::Figures made_up_frame(const explore::Point& point) {
  std::map<std::string, int> buffers;
  for (const platform::PlacedBuffer& buffer : platform::buffers(*point.board)) ++buffers[buffer.bank];
  std::int64_t cycles = 1'000'000;
  for (const auto& [bank, count] : buffers) cycles += 1'000 * (count - 1);
  explore::Figures figures;
  figures.values = {{"cycles", cycles}, {"frames_per_second.core", 40e6 / static_cast<double>(cycles)}};
  return figures;
}

Means proving_means() {
  Means proving = means();
  proving.evaluate = made_up_frame;
  proving.bound = [](const BoardConfig&) {
    platform::Bound bound;
    bound.core = 40;
    bound.core_limited_by = "matcher";
    return bound;
  };
  return proving;
}

TEST(Study, ProvesHowFewBanksReachTheBestRate) {
  const Means proving = proving_means();
  const BoardRun run = {"fpl2003-no-calibration", {}, false};
  const Findings found = study({claim_of(Quantity::kBanksProved, 6, {run})}, proving).value();
  // Two pictures and a result in banks of their own.
  EXPECT_EQ(found.of("one").cases.at(0).modelled, 3);
  EXPECT_EQ(found.of("one").verdict, Verdict::kNotConfirmed);
  EXPECT_THROW(found.of("nothing"), std::out_of_range);
  ASSERT_EQ(found.banks.size(), 6U);
  EXPECT_EQ(found.banks[2].banks, 3);
  EXPECT_EQ(found.banks[2].allocations, 90U);
  EXPECT_EQ(found.banks[2].measured.bound, 40);
  EXPECT_LT(found.banks[1].measured.rate, found.banks[2].measured.rate);
  EXPECT_EQ(found.banks[2].measured.rate, found.banks[5].measured.rate);
}

// Made up: wrong and answered shares by cost, which are less on the second synthetic scene.
Quality made_up_quality(const BoardConfig& board, const Scene& scene) {
  const double less = scene.synthetic == 2 ? 1 : 0;
  switch (board.matcher.cost.kind) {
    case kernels::CostKind::kSad:
      return {2 - less, 80};
    case kernels::CostKind::kSsd:
      return {3, 79.5};
    case kernels::CostKind::kZncc:
      return {1.5, 81.25};
    case kernels::CostKind::kCensus:
      break;
  }
  return {9, 9};
}

Means seeing_means() {
  Means seeing = means();
  seeing.quality = made_up_quality;
  return seeing;
}

BoardRun cost_run(const std::string& cost, std::uint64_t scene) {
  const std::string name = std::to_string(scene);
  return {"fpl2003", {"matcher.cost=" + cost}, false, Scene{"scene " + name, {"--synthetic", name}, scene}};
}

Claim cost_claim() {
  Claim claim = claim_of(Quantity::kAccuracyChange, 0, {cost_run("sad", 1), cost_run("ssd", 1)});
  claim.cases.push_back({"", 0, {cost_run("sad", 1), cost_run("zncc", 1), cost_run("{census: 5}", 1)}});
  claim.cases.push_back({"", 0, {cost_run("sad", 2), cost_run("ssd", 2)}});
  return claim;
}

TEST(Study, TakesTheLargerChangeOfTheAccuracyOfTheSecondRun) {
  const ClaimFinding found = study({cost_claim()}, seeing_means()).value().of("one");
  EXPECT_EQ(found.cases.at(0).modelled, 1);
  EXPECT_EQ(found.cases.at(0).verdict, Verdict::kConfirmed);
  // Zncc answers more, which counts as a change too.
  EXPECT_EQ(found.cases.at(1).modelled, 1.25);
  EXPECT_EQ(found.cases.at(1).verdict, Verdict::kNotConfirmed);
  EXPECT_EQ(found.cases.at(2).modelled, 2);
  EXPECT_EQ(found.verdict, Verdict::kInPart);
  // The boards are simulated without pixels too.
  EXPECT_EQ(found.cases.at(0).runs.at(0).slices_percent, 20);
}

TEST(Study, LeavesOpenWhatASceneOfWrongAnswersWouldJudge) {
  struct Limit {
    double wrong;
    Verdict verdict;
    bool judges;
  };
  for (const Limit& limit : {Limit{50, Verdict::kConfirmed, true}, Limit{50.01, Verdict::kOpen, false}}) {
    Means seeing = means();
    seeing.quality = [&limit](const BoardConfig& board, const Scene& scene) {
      return scene.synthetic == 2 ? Quality{limit.wrong, 80} : made_up_quality(board, scene);
    };
    const ClaimFinding found = study({cost_claim()}, seeing).value().of("one");
    EXPECT_EQ(found.cases.at(0).verdict, Verdict::kConfirmed);
    EXPECT_EQ(found.cases.at(2).verdict, limit.verdict);
    const std::vector<SceneFinding> scenes = scenes_of(found);
    ASSERT_EQ(scenes.size(), 2U);
    EXPECT_TRUE(scenes[0].judges);
    EXPECT_EQ(scenes[1].scene.name, "scene 2");
    EXPECT_EQ(scenes[1].wrong_percent, limit.wrong);
    EXPECT_EQ(scenes[1].judges, limit.judges);
  }
}

TEST(Study, ListsEachRunOfAScene) {
  const ClaimFinding found = study({cost_claim()}, seeing_means()).value().of("one");
  std::vector<std::string> rows;
  for (const CostRow& row : cost_rows(found)) {
    rows.push_back(fmt::format("{} {}: {} {}, change {} {}, {}", row.scene, row.cost,
                               row.quality.wrong_percent, row.quality.answered_percent,
                               row.change.wrong_percent, row.change.answered_percent,
                               row.verdict ? text_of(*row.verdict) : "-"));
  }
  EXPECT_THAT(rows,
              ElementsAre("scene 1 sad: 2 80, change 0 0, -", "scene 1 ssd: 3 79.5, change 1 -0.5, confirmed",
                          "scene 1 zncc: 1.5 81.25, change -0.5 1.25, not confirmed",
                          "scene 1 census 5: 9 9, change 7 -71, -", "scene 2 sad: 1 80, change 0 0, -",
                          "scene 2 ssd: 3 79.5, change 2 -0.5, not confirmed"));
  EXPECT_EQ(cost_rows(found)[3].command,
            "stereotlm run fpl2003 --set 'matcher.cost={census: 5}' --source preloaded --synthetic 1");
}

TEST(Study, SimulatesEachRunOfASceneOnceAndCountsIt) {
  Means counting = seeing_means();
  int frames = 0;
  counting.quality = [&frames](const BoardConfig& board, const Scene& scene) {
    ++frames;
    return made_up_quality(board, scene);
  };
  std::vector<std::uint64_t> totals;
  counting.keep_going = [&totals](std::uint64_t done, std::uint64_t most_left) {
    totals.push_back(done + most_left);
    return true;
  };
  ASSERT_TRUE(study({cost_claim()}, counting).has_value());
  EXPECT_EQ(frames, 6);
  // Four boards without pixels, and the frames.
  for (const std::uint64_t total : totals) EXPECT_EQ(total, 10U);
}

TEST(Study, EndsBetweenTheFramesOfScenesWhenStopped) {
  Means ending = seeing_means();
  ending.keep_going = [](std::uint64_t done, std::uint64_t) { return done < 6; };
  int frames = 0;
  ending.quality = [&frames](const BoardConfig& board, const Scene& scene) {
    ++frames;
    return made_up_quality(board, scene);
  };
  EXPECT_FALSE(study({cost_claim()}, ending).has_value());
  EXPECT_EQ(frames, 2);
}

TEST(Study, SimulatesABoardOfTwoClaimsOnce) {
  Means counting = means();
  std::uint64_t total = 0;
  counting.keep_going = [&total](std::uint64_t done, std::uint64_t most_left) {
    total = done + most_left;
    return true;
  };
  Claim other = claim_of(Quantity::kSlices, 20, {run_of("matcher.window=5")});
  other.name = "other";
  study({claim_of(Quantity::kRate, 61, {run_of("matcher.window=5"), run_of("matcher.window=7")}), other},
        counting);
  EXPECT_EQ(total, 2U);
}

TEST(Study, CountsTheBoardsOfAllSearchesAndRuns) {
  const BoardRun run = {"fpl2003-no-calibration", {}, false};
  Claim first = claim_of(Quantity::kBanksProved, 6, {run});
  Claim second = first;
  second.name = "two";
  Claim rate = claim_of(Quantity::kRate, 61, {run_of("matcher.window=5"), run_of("matcher.window=7", true)});
  rate.name = "rate";
  Means counting = proving_means();
  counting.evaluate = [](const explore::Point& point) {
    return point.board->allocation.left_lut ? made_up(point) : made_up_frame(point);
  };
  struct Progress {
    std::uint64_t done, most_left;
  };
  std::vector<Progress> all;
  counting.keep_going = [&all](std::uint64_t done, std::uint64_t most_left) {
    all.push_back({done, most_left});
    return true;
  };
  ASSERT_TRUE(study({first, rate, second}, counting).has_value());
  EXPECT_EQ(all.back().most_left, 0U);
  EXPECT_GT(all.back().done, 2U);
  EXPECT_EQ(all.back().done % 2, 0U) << "two searches that are the same, and two runs";
  // Where frames are simulated one by one the boards are known from the start.
  for (const Progress& progress : all) EXPECT_EQ(progress.done + progress.most_left, all.back().done);
  std::vector<std::uint64_t> left;
  for (const Progress& progress : all) {
    if (left.empty() || progress.most_left != left.back()) left.push_back(progress.most_left);
  }
  EXPECT_TRUE(std::is_sorted(left.rbegin(), left.rend()));
}

TEST(Study, EndsWithoutFindingsWhenStoppedAndReportsABoardThatFails) {
  const std::vector<Claim> rate = {claim_of(Quantity::kRate, 61, {run_of("matcher.window=5")})};
  // More points, each longer than the time between two calls of keep_going, than processes.
  std::vector<Claim> rates;
  for (int window = 3; window <= 31; window += 2)
    rates.push_back(claim_of(Quantity::kRate, 61, {run_of(fmt::format("matcher.window={}", window))}));
  Means ending = means();
  ending.evaluate = [](const explore::Point& point) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    return made_up(point);
  };
  ending.keep_going = [](std::uint64_t, std::uint64_t) { return false; };
  EXPECT_FALSE(study(rates, ending).has_value());
  Means failing = means();
  failing.evaluate = [](const explore::Point&) -> explore::Figures { throw std::runtime_error("burnt"); };
  EXPECT_THAT([&] { study(rate, failing); }, ThrowsMessage<std::runtime_error>(HasSubstr("burnt")));
  // A rate does not count if captures lose pixels.
  EXPECT_THAT([] { only(claim_of(Quantity::kRate, 61, {run_of("matcher.window=9", true)})); },
              ThrowsMessage<std::runtime_error>(HasSubstr("--set matcher.window=9")));
}

TEST(Study, CommandsGiveTheFiguresOfANumber) {
  const std::vector<BoardRun> two = {run_of("matcher.window=5"), run_of("matcher.window=7", true)};
  const auto commands = [&](Quantity quantity) {
    const Claim claim = claim_of(quantity, 1, two);
    return commands_of(claim, claim.cases[0]);
  };
  const std::string core =
      "stereotlm run fpl2003 --set matcher.window=5 --source preloaded --timing-only --frames 2";
  EXPECT_THAT(commands(Quantity::kRate), ElementsAre(core));
  EXPECT_THAT(commands(Quantity::kSpeedUp),
              ElementsAre(core, "stereotlm run fpl2003 --set matcher.window=7 --timing-only --frames 14"));
  // A cost that is shown beside has no command in the row of another.
  const Claim costs = cost_claim();
  EXPECT_THAT(commands_of(costs, costs.cases[1]),
              ElementsAre(command_of(cost_run("sad", 1)), command_of(cost_run("zncc", 1))));
  EXPECT_THAT(commands(Quantity::kSlices), ElementsAre("stereotlm bounds fpl2003 --set matcher.window=5"));
  EXPECT_THAT(commands(Quantity::kBanksProved),
              ElementsAre("stereotlm allocate fpl2003 --set matcher.window=5 --source preloaded --banks 8 "
                          "--out banks.db"));
}

TEST(Study, FindsTheClocksThatGiveThePrintedRate) {
  Claim claim = claim_of(Quantity::kRate, 61, {run_of("matcher.window=7")});
  const auto clock = clock_for(claim, only(claim));
  ASSERT_TRUE(clock.has_value());
  EXPECT_DOUBLE_EQ(clock->least_mhz, 40 * 60.5 / 60);
  EXPECT_DOUBLE_EQ(clock->most_mhz, 40 * 61.5 / 60);
  claim.cases[0].runs[0].camera = true;
  EXPECT_FALSE(clock_for(claim, {claim.cases[0], 60, {}, {}}).has_value());
  claim.quantity = Quantity::kSpeedUp;
  claim.cases[0].runs[0].camera = false;
  EXPECT_FALSE(clock_for(claim, {claim.cases[0], 60, {}, {}}).has_value());
}

TEST(Study, DeviationIsThatOfTheModelFromThePaper) {
  Claim claim = claim_of(Quantity::kRate, 80, {run_of("matcher.window=7")});
  EXPECT_DOUBLE_EQ(*deviation_percent(claim, only(claim)), -25);
  claim.cases[0].printed = 0;
  EXPECT_FALSE(deviation_percent(claim, only(claim)).has_value());
}

}  // namespace
}  // namespace stereotlm::paper
