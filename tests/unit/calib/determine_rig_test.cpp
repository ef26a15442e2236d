#include "calib/determine_rig.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

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
using Values = Eigen::Matrix<double, kRigParameters, 1>;

constexpr double kNoises[] = {0.02, 0.05, 0.1, 0.2, 0.3};  // pixels

std::uint64_t rigs(std::uint64_t without_it) {
  const char* const asked = std::getenv("STEREOTLM_RANDOM_RIGS");
  return asked != nullptr ? std::stoull(asked) : without_it;
}

struct Answer {
  std::string text;  // the verdict, or why the rig is refused
  std::optional<DeterminedRig> found;
};

Answer answer_to(const FaultyRig& faulty) try {
  GridViews views{faulty.grid, faulty.width, faulty.height, faulty.pairs.size(), {}, {}, faulty.pairs};
  for (std::size_t i = 0; i < faulty.pairs.size(); ++i) {
    views.numbers.push_back(i);
    views.names.push_back(std::to_string(i));
  }
  const DeterminedRig found = determine_rig(views);
  Calibration made;
  made.rig = found.fit.rig;
  made.certainty = found.certainty;
  made.quality.found_again.corners = 1;
  for (const std::vector<bool>& used : found.fit.used)
    made.sources.push_back({"", "", static_cast<std::size_t>(std::count(used.begin(), used.end(), true))});
  return {verdict_of(made), found};
} catch (const std::invalid_argument& refusal) {
  return {refusal.what(), std::nullopt};
}

// What each value of the rig is wrong by, in its sigmas.
Values errors_in_sigmas(const DeterminedRig& determined, const Rig& truth) {
  const Rig& found = determined.fit.rig;
  Values errors;
  Eigen::Index at = 0;
  for (const auto side : {&Rig::left, &Rig::right}) {
    const Eigen::Matrix3d wrong = (found.*side).matrix - (truth.*side).matrix;
    for (const double value : {wrong(0, 0), wrong(1, 1), wrong(0, 2), wrong(1, 2)}) errors[at++] = value;
    for (std::size_t i = 0; i < 5; ++i)
      errors[at++] = (found.*side).distortion[i] - (truth.*side).distortion[i];
  }
  const Eigen::AngleAxisd turn(found.rotation * truth.rotation.transpose());
  errors.tail<6>() << turn.angle() * turn.axis(), found.translation - truth.translation;
  return errors.cwiseAbs().cwiseQuotient(determined.covariance.diagonal().cwiseSqrt());
}

struct Mistake {
  const char* name;
  Fault fault;
  std::uint64_t rigs;  // of each kind, without STEREOTLM_RANDOM_RIGS
  const char* answer;  // how it begins, a regular expression
};

constexpr const char* kTurned =
    "refused: the pictures of one camera are upside down against those of the other";

const Mistake kMistakes[] = {
    {"None", Fault::kNone, 2, "good: "},
    {"Moved", Fault::kMoved, 1, "(refused: the two pictures of a pair do not show|usable: the rig fits)"},
    {"MovedLittle", Fault::kMovedLittle, 2, "(refused|usable): "},
    {"SomeMoved", Fault::kSomeMoved, 2, "usable: .* pairs do not fit"},
    {"Late", Fault::kLate, 2, "refused: the pictures are paired wrongly"},
    {"Reversed", Fault::kReversed, 1, "refused: the pictures of one camera are in reverse order"},
    {"OneLostInEach", Fault::kOneLostInEach, 2, "usable: .* pairs do not fit"},
    {"OneMiscounted", Fault::kOneMiscounted, 2, "usable: 1 of .* pairs do not fit"},
    {"UpsideDown", Fault::kUpsideDown, 1, kTurned},
    {"OppositeQuarters", Fault::kOppositeQuarters, 1, kTurned},
    {"Mirrored", Fault::kMirrored, 1, "refused: the pictures of one camera are mirrored"},
    {"Exchanged", Fault::kExchanged, 1, "refused: the cameras are swapped"},
    {"Rolled", Fault::kRolled, 1, "refused: one camera is turned by (8.|9.) degrees"},
    {"Vertical", Fault::kVertical, 1, "refused: the right camera is .* mm (above|below) the left one"},
    {"TurnedFar", Fault::kTurnedFar, 1, "(good|usable|refused: the lenses)"},  // refused for its disparities
    {"Frontal", Fault::kFrontal, 1, "refused: the grid is tilted by [0-2]\\.. degrees at most"},
    {"HardlyTilted", Fault::kHardlyTilted, 2, "(refused|usable): "},
};

// Whether the answer is the expected one; whether exactly the bad pairs are left out, and the others tell the
// focal length to 4 sigma; whether the cure names the shift; and whether the turn is found.
bool is_right(const Mistake& mistake, const FaultyRig& faulty, const Answer& answer) {
  if (!std::regex_search(answer.text, std::regex(fmt::format("^{}", mistake.answer)))) return false;
  if (faulty.shift != 0) {
    const std::string cure =
        fmt::format("leave out {} {} picture", std::abs(faulty.shift), faulty.shift < 0 ? "right" : "left");
    return answer.text.find(cure) != std::string::npos;
  }
  if (!answer.found) return true;
  const Rig& found = answer.found->fit.rig;
  if (mistake.fault == Fault::kTurnedFar) return found.rotation.isApprox(faulty.rig.rotation, 0.01);
  if (faulty.bad_pairs.empty()) return true;
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < faulty.pairs.size(); ++i) {
    const std::vector<bool>& used = answer.found->fit.used[i];
    if (std::find(used.begin(), used.end(), true) == used.end()) out.push_back(i);
  }
  return out == faulty.bad_pairs && errors_in_sigmas(*answer.found, faulty.rig)[0] <= 4;
}

// A shift that leaves too few pairs, and a movement of the grid that drowns in the noise, cannot be found.
bool can_be_found(const FaultyRig& faulty, double noise) {
  const auto shift = static_cast<std::size_t>(std::abs(faulty.shift));
  return faulty.pairs.size() >= shift + kFewestPairs &&
         (faulty.moved_px == 0 || faulty.moved_px >= 5 * noise);
}

class MistakeTest : public testing::TestWithParam<Mistake> {};

INSTANTIATE_TEST_SUITE_P(Of, MistakeTest, testing::ValuesIn(kMistakes),
                         [](const auto& mistake) { return mistake.param.name; });

TEST_P(MistakeTest, IsNamed) {
  const std::uint64_t count = rigs(GetParam().rigs);
  std::uint64_t wrong = 0;
  for (std::uint64_t seed = 0; seed < count; ++seed) {
    const FaultyRig made = test::made_rig(seed, GetParam().fault);
    const Answer answer = answer_to(made);
    EXPECT_TRUE(is_right(GetParam(), made, answer)) << "made rig " << seed << ": " << answer.text;
    const double noise = kNoises[seed % 5];
    const FaultyRig random = test::faulty_rig(seed, noise, GetParam().fault);
    if (!can_be_found(random, noise)) continue;
    const Answer to_random = answer_to(random);
    if (is_right(GetParam(), random, to_random)) continue;
    ++wrong;
    EXPECT_TRUE(wrong <= count / 20 && to_random.text.find("good") != 0)
        << "random rig " << seed << ": " << to_random.text;
  }
}

TEST(DetermineRig, FindsTheValuesOfRandomRigsWithinThreeSigma) {
  const std::uint64_t count = rigs(10);
  std::uint64_t refused = 0;
  Values outside = Values::Zero();
  for (std::uint64_t seed = 0; seed < count; ++seed) {
    const FaultyRig random = test::faulty_rig(seed, kNoises[seed % 5], Fault::kNone);
    const Answer answer = answer_to(random);
    if (answer.found)
      outside += (errors_in_sigmas(*answer.found, random.rig).array() > 3).matrix().cast<double>();
    else
      EXPECT_LE(++refused, count / 100) << "seed " << seed << ": " << answer.text;
  }
  const double most = 0.025 * static_cast<double>(count);
  EXPECT_LE(outside.maxCoeff(), most + 3 * std::sqrt(0.975 * most)) << outside.transpose();
}

TEST(DetermineRig, FindsTheTruthWithoutNoise) {
  for (const std::uint64_t seed : {1U, 2U}) {
    const FaultyRig random = test::faulty_rig(seed, 0, Fault::kNone);
    const Rig found = answer_to(random).found.value().fit.rig;
    for (const auto side : {&Rig::left, &Rig::right}) {
      for (const int axis : {0, 1})
        EXPECT_NEAR((found.*side).matrix(axis, axis) / (random.rig.*side).matrix(axis, axis), 1, 1e-4);
    }
    EXPECT_NEAR(found.translation.norm() / random.rig.translation.norm(), 1, 1e-4);
  }
}

// The grid moves by 4 mm and 0.8 degrees between the exposures: the joint fit would change the focal length
// by a tenth.
TEST(FitRig, DoesNotBendTheLensesOfABadRig) {
  const FaultyRig made = test::made_rig(1, Fault::kMoved);
  const RigFit fit = fit_rig(made.grid, made.width, made.height, made.pairs);
  EXPECT_TRUE(fit.evidence.has_fixed_intrinsics);
  for (const CameraModel& camera : {fit.rig.left, fit.rig.right})
    EXPECT_NEAR(camera.matrix(0, 0) / 520, 1, 0.005);
}

// From the disparity, as the board does.
double depth_by(const Rig& rig, const SeenPoint& seen) {
  const Rectification rectification = rectify(rig);
  const GridPair flat = rectified(rig, rectification, {{seen.left}, {seen.right}});
  return -rectification.p2(0, 3) / (flat.left[0].x() - flat.right[0].x());
}

TEST(DepthError, IsTheScatterOfRigsFittedToOtherNoise) {
  constexpr double kDepth = 700;
  constexpr int kFits = 80;
  const FaultyRig made = test::made_rig(3, Fault::kNone);
  const Rectification rectification = rectify(made.rig);
  const Eigen::Vector3d middle((made.width - 1) / 2.0, (made.height - 1) / 2.0, 1);
  const Eigen::Vector3d ray = rectification.p1.leftCols<3>().inverse() * middle;
  const SeenPoint seen = seen_by(made.rig, rectification.r1.transpose() * (kDepth * ray));
  const RigFit fit = fit_rig(made.grid, made.width, made.height, made.pairs);
  std::mt19937 generator(1);
  std::normal_distribution<double> noise(0, 0.05);
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
  const RigCovariance covariances = covariance(fit, made.grid, made.pairs);
  const DepthError error = depth_error(fit.rig, rectify(fit.rig), covariances, 0, kDepth);
  EXPECT_NEAR(error.calibration_mm / std::sqrt(squares / kFits), 1, 0.25);
}

}  // namespace
}  // namespace stereotlm::calib
