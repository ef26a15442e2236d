#include "calib/determine_rig.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <random>
#include <regex>
#include <stdexcept>
#include <string>
#include <vector>

#include "calib/verdict.h"
#include "tests/support/random_rig.h"

namespace stereotlm::calib {
namespace {

using test::Fault;
using test::FaultyRig;

constexpr double kNoises[] = {0.02, 0.05, 0.1, 0.2, 0.3};  // pixels

std::uint64_t rigs(std::uint64_t without_it) {
  const char* const asked = std::getenv("STEREOTLM_RANDOM_RIGS");
  return asked != nullptr ? std::stoull(asked) : without_it;
}

struct Answer {
  std::string text;  // the verdict, or why the rig is refused
  std::optional<DeterminedRig> determined;
};

Answer answer_to(const FaultyRig& faulty) {
  GridViews views{faulty.grid, faulty.width, faulty.height, faulty.pairs.size(), {}, {}, faulty.pairs};
  for (std::size_t i = 0; i < faulty.pairs.size(); ++i) {
    views.numbers.push_back(i);
    views.names.push_back(std::to_string(i));
  }
  Answer answer;
  try {
    answer.determined = determine_rig(views);
  } catch (const std::invalid_argument& refusal) {
    answer.text = refusal.what();
    return answer;
  }
  Calibration made;
  made.rig = answer.determined->fit.rig;
  made.certainty = answer.determined->certainty;
  for (const std::vector<bool>& used : answer.determined->fit.used) {
    made.sources.push_back({});
    made.sources.back().corners_used = static_cast<std::size_t>(std::count(used.begin(), used.end(), true));
  }
  answer.text = verdict_of(made);
  return answer;
}

using Values = Eigen::Matrix<double, kRigParameters, 1>;

// What each value of the rig is wrong by, in the order of RigCovariance.
Values errors_of(const Rig& found, const Rig& truth) {
  Values errors;
  Eigen::Index at = 0;
  for (const auto side : {&Rig::left, &Rig::right}) {
    const Eigen::Matrix3d matrix = (found.*side).matrix - (truth.*side).matrix;
    for (const double value : {matrix(0, 0), matrix(1, 1), matrix(0, 2), matrix(1, 2)}) errors[at++] = value;
    for (std::size_t i = 0; i < 5; ++i)
      errors[at++] = (found.*side).distortion[i] - (truth.*side).distortion[i];
  }
  const Eigen::AngleAxisd turn(found.rotation * truth.rotation.transpose());
  errors.tail<6>() << turn.angle() * turn.axis(), found.translation - truth.translation;
  return errors;
}

Values sigmas_of(const DeterminedRig& determined) { return determined.covariance.diagonal().cwiseSqrt(); }

// Whether exactly the bad pairs are left out, and the others tell the focal length to 4 sigma.
bool is_without_bad_pairs(const FaultyRig& faulty, const DeterminedRig& found) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < found.fit.used.size(); ++i) {
    const std::vector<bool>& used = found.fit.used[i];
    if (std::find(used.begin(), used.end(), true) == used.end()) out.push_back(i);
  }
  return out == faulty.bad_pairs &&
         std::abs(errors_of(found.fit.rig, faulty.rig)[0]) <= 4 * sigmas_of(found)[0];
}

// Whether the cameras are turned so far that no board can hold the disparities of the grid.
bool is_too_wide(const FaultyRig& faulty, const Rig& rig) {
  const Rectification rectification = rectify(rig);
  DisparityRange range{1e9, -1e9};
  for (const GridPair& pair : faulty.pairs) {
    const GridPair flat = rectified(rig, rectification, pair);
    for (std::size_t i = 0; i < flat.left.size(); ++i) {
      range.min = std::min(range.min, flat.left[i].x() - flat.right[i].x());
      range.max = std::max(range.max, flat.left[i].x() - flat.right[i].x());
    }
  }
  return range.needed() > 254;
}

struct Mistake {
  const char* name;
  Fault fault;
  std::uint64_t rigs;                      // without STEREOTLM_RANDOM_RIGS
  const char* answer;                      // how it begins, a regular expression
  const char* answer_to_random = nullptr;  // if that is another
};

const char* const kMoving = "refused: the two pictures of a pair do not show the grid at the same place";
const char* const kTurned = "refused: the pictures of one camera are upside down against those of the other";
const char* const kUntilted = "refused: the grid is tilted by [0-2]\\.. degrees at most";

const Mistake kMistakes[] = {
    {"None", Fault::kNone, 4, "good: "},
    {"Moved", Fault::kMoved, 2, kMoving, "(refused: the two pictures|usable: the rig fits)"},
    {"MovedLittle", Fault::kMovedLittle, 2, "(refused|usable): "},
    {"SomeMoved", Fault::kSomeMoved, 2, "usable: .* pairs do not fit"},
    {"Late", Fault::kLate, 2, "refused: the pictures are paired wrongly"},
    {"Reversed", Fault::kReversed, 2, "refused: the pictures of one camera are in reverse order"},
    {"OneLostInEach", Fault::kOneLostInEach, 4, "usable: .* pairs do not fit"},
    {"OneMiscounted", Fault::kOneMiscounted, 4, "usable: 1 of .* pairs do not fit"},
    {"UpsideDown", Fault::kUpsideDown, 2, kTurned},
    {"OppositeQuarters", Fault::kOppositeQuarters, 1, kTurned},
    {"Mirrored", Fault::kMirrored, 2, "refused: the pictures of one camera are mirrored"},
    {"Exchanged", Fault::kExchanged, 4, "refused: the cameras are swapped"},
    {"Rolled", Fault::kRolled, 2, "refused: one camera is turned by (8|9). degrees"},
    {"Vertical", Fault::kVertical, 4, "refused: the right camera is .* mm (above|below) the left one"},
    {"TurnedFar", Fault::kTurnedFar, 2, ""},
    {"Frontal", Fault::kFrontal, 4, kUntilted},
    {"HardlyTilted", Fault::kHardlyTilted, 4, "(refused|usable): "},
};

bool is_right(const Mistake& mistake, const char* expected, const FaultyRig& faulty, const Answer& answer) {
  if (!std::regex_search(answer.text, std::regex(fmt::format("^({})", expected)))) return false;
  if (!faulty.bad_pairs.empty()) return is_without_bad_pairs(faulty, *answer.determined);
  if (mistake.fault == Fault::kTurnedFar)
    return !answer.determined || is_too_wide(faulty, answer.determined->fit.rig);
  const std::string cure = fmt::format("leave out the first {} of the {} pictures", std::abs(faulty.shift),
                                       faulty.shift < 0 ? "right" : "left");
  return faulty.shift == 0 || answer.text.find(cure) != std::string::npos;
}

class MistakeTest : public testing::TestWithParam<Mistake> {};

std::string name_of(const testing::TestParamInfo<Mistake>& mistake) { return mistake.param.name; }

INSTANTIATE_TEST_SUITE_P(Of, MistakeTest, testing::ValuesIn(kMistakes), name_of);

TEST_P(MistakeTest, IsNamedOfTheKnownRig) {
  const Mistake& its = GetParam();
  for (std::uint64_t seed = 0; seed < rigs(its.rigs); ++seed) {
    const FaultyRig faulty = test::made_rig(seed, its.fault);
    const Answer answer = answer_to(faulty);
    EXPECT_TRUE(is_right(its, its.answer, faulty, answer)) << "seed " << seed << ": " << answer.text;
  }
}

// A movement of the grid that drowns in the noise, and a shift that leaves too few pairs, cannot be named.
TEST_P(MistakeTest, OfARandomRigIsNamedAndNeverGood) {
  const Mistake& its = GetParam();
  const std::uint64_t count = rigs(2);
  std::string wrong;
  std::size_t wrong_ones = 0;
  for (std::uint64_t seed = 0; seed < count; ++seed) {
    const double noise = kNoises[seed % 5];
    const FaultyRig faulty = test::faulty_rig(seed, noise, its.fault);
    const auto shift = static_cast<std::size_t>(std::abs(faulty.shift));
    if (its.fault == Fault::kMovedLittle && faulty.moved_px < 5 * noise) continue;
    if (shift > 0 && faulty.pairs.size() < shift + kFewestPairs) continue;
    const Answer answer = answer_to(faulty);
    if (is_right(its, its.answer_to_random != nullptr ? its.answer_to_random : its.answer, faulty, answer))
      continue;
    EXPECT_NE(answer.text.substr(0, 4), "good") << "seed " << seed;
    wrong += fmt::format("seed {}: {}\n", seed, answer.text);
    ++wrong_ones;
  }
  EXPECT_LE(wrong_ones, count / 20) << wrong;
}

TEST(DetermineRig, FindsTheValuesOfRandomRigsWithinThreeSigma) {
  const std::uint64_t count = rigs(30);
  std::string refused;
  std::size_t refused_ones = 0;
  Values outside = Values::Zero();
  for (std::uint64_t seed = 0; seed < count; ++seed) {
    const FaultyRig random = test::faulty_rig(seed, kNoises[seed % 5], Fault::kNone);
    const Answer answer = answer_to(random);
    if (!answer.determined) {
      refused += fmt::format("seed {}: {}\n", seed, answer.text);
      ++refused_ones;
      continue;
    }
    const Values errors = errors_of(answer.determined->fit.rig, random.rig).cwiseAbs();
    outside += (errors.array() > 3 * sigmas_of(*answer.determined).array()).cast<double>().matrix();
  }
  EXPECT_LE(refused_ones, count / 100) << refused;
  const double most = 0.025 * static_cast<double>(count);
  EXPECT_LE(outside.maxCoeff(), most + 3 * std::sqrt(0.975 * most)) << outside.transpose();
}

TEST(DetermineRig, FindsTheTruthWithoutNoise) {
  for (const std::uint64_t seed : {1U, 2U}) {
    const FaultyRig random = test::faulty_rig(seed, 0, Fault::kNone);
    const Answer answer = answer_to(random);
    ASSERT_TRUE(answer.determined) << answer.text;
    const Rig& found = answer.determined->fit.rig;
    for (const auto side : {&Rig::left, &Rig::right}) {
      for (const int axis : {0, 1})
        EXPECT_NEAR((found.*side).matrix(axis, axis) / (random.rig.*side).matrix(axis, axis), 1, 1e-4);
    }
    EXPECT_NEAR(found.translation.norm() / random.rig.translation.norm(), 1, 1e-4);
  }
}

// The depth that a rig computes for two pixels, in the way of the board: from the disparity.
double depth_by(const Rig& rig, const SeenPoint& seen) {
  const Rectification rectification = rectify(rig);
  const GridPair flat = rectified(rig, rectification, {{seen.left}, {seen.right}});
  return -rectification.p2(0, 3) / (flat.left[0].x() - flat.right[0].x());
}

TEST(DepthError, IsTheScatterOfRigsFittedToOtherNoise) {
  constexpr double kNoise = 0.05;
  constexpr double kDepth = 700;
  const FaultyRig made = test::made_rig(3, Fault::kNone);
  const RigFit fit = fit_rig(made.grid, made.width, made.height, made.pairs);
  const Rectification rectification = rectify(made.rig);
  const Eigen::Vector3d middle((made.width - 1) / 2.0, (made.height - 1) / 2.0, 1);
  const Eigen::Vector3d ray = rectification.p1.leftCols<3>().inverse() * middle;
  const SeenPoint seen = seen_by(made.rig, rectification.r1.transpose() * (kDepth * ray));
  EXPECT_NEAR(depth_by(made.rig, seen), kDepth, 1e-6);

  std::mt19937 generator(1);
  std::normal_distribution<double> noise(0, kNoise);
  constexpr int kFits = 200;
  double squares = 0;
  for (int i = 0; i < kFits; ++i) {
    std::vector<GridPair> pairs(made.poses.size());
    for (std::size_t pair = 0; pair < pairs.size(); ++pair) {
      for (const Eigen::Vector3d& corner : corner_points(made.grid)) {
        const SeenPoint exact = seen_by(made.rig, made.poses[pair] * corner);
        pairs[pair].left.push_back(exact.left + Eigen::Vector2d(noise(generator), noise(generator)));
        pairs[pair].right.push_back(exact.right + Eigen::Vector2d(noise(generator), noise(generator)));
      }
    }
    const Rig refitted = solve_rig(made.grid, pairs, fit.used, made.rig, Lens::kFull);
    squares += std::pow(depth_by(refitted, seen) - kDepth, 2);
  }
  const DepthError error =
      depth_error(fit.rig, rectify(fit.rig), covariance(fit, made.grid, made.pairs), 0, kDepth);
  const double scatter = std::sqrt(squares / kFits);
  EXPECT_NEAR(error.calibration_mm / scatter, 1, 0.25);
}

}  // namespace
}  // namespace stereotlm::calib
