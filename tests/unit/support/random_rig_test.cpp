#include "tests/support/random_rig.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace stereotlm::test {
namespace {

using calib::Corners;
using Eigen::Vector2d;

// From where the cameras see the corners of a position without faults, to where the pair has them.
Corners shifts(const RandomRig& random, std::size_t position, const calib::GridPair& pair) {
  Corners result;
  for (const Eigen::Vector3d& corner : calib::corner_points(random.grid)) {
    const calib::SeenPoint seen = calib::seen_by(random.rig, random.poses[position] * corner);
    const std::size_t number = result.size() / 2;
    result.insert(result.end(), {pair.left[number] - seen.left, pair.right[number] - seen.right});
  }
  return result;
}

TEST(RandomRig, IsOfTheKindAndTheNoiseThatArePromised) {
  const auto cosine = [](double degrees) { return std::cos(degrees * std::acos(-1) / 180); };
  double squares = 0;
  double count = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    const RandomRig random = random_rig(seed, 0.2);
    const calib::Rig& rig = random.rig;
    const Vector2d last(rig.width - 1, rig.height - 1);
    EXPECT_TRUE(rig.width >= 320 && rig.width <= 1280 && rig.height >= 240 && rig.height <= 960);
    EXPECT_TRUE(rig.translation.norm() >= 40 && rig.translation.norm() <= 400) << rig.translation;
    EXPECT_TRUE(random.pairs.size() >= 6 && random.pairs.size() <= 20) << random.pairs.size();
    EXPECT_GT(rig.left.widest(), 1.1 * rig.left.direction(last).norm());
    for (std::size_t i = 0; i < random.pairs.size(); ++i) {
      const Eigen::Matrix3d rotation = random.poses[i].linear();
      EXPECT_TRUE(rotation(2, 2) > cosine(40.01) && rotation(2, 2) < cosine(14.99)) << rotation;
      EXPECT_LT((rig.rotation * rotation)(2, 2), cosine(14.99));
      for (const Corners* corners : {&random.pairs[i].left, &random.pairs[i].right}) {
        for (const Vector2d& corner : *corners)
          EXPECT_GE(std::min(corner.minCoeff(), (last - corner).minCoeff()), 3);
      }
      for (const Vector2d& noise : shifts(random, i, random.pairs[i])) {
        squares += noise.squaredNorm();
        count += 2;
      }
    }
  }
  EXPECT_NEAR(std::sqrt(squares / count), 0.2, 0.002);
}

TEST(FaultyRig, NamesTheBadPairs) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    for (const Fault fault : {Fault::kSomeMoved, Fault::kOneMiscounted, Fault::kOneLostInEach}) {
      const FaultyRig faulty = faulty_rig(seed, 0, fault);
      const auto& bad = faulty.bad_pairs;
      ASSERT_FALSE(bad.empty());
      const std::size_t lost = faulty.poses.size() - faulty.pairs.size();
      for (std::size_t i = 0; i < faulty.pairs.size(); ++i) {
        const Corners wrong = shifts(faulty, i + (i < bad.front() ? 0 : lost), faulty.pairs[i]);
        const bool is_sound =
            std::all_of(wrong.begin(), wrong.end(), [](const auto& shift) { return shift.norm() < 1e-9; });
        EXPECT_NE(is_sound, std::find(bad.begin(), bad.end(), i) != bad.end());
      }
    }
  }
}

}  // namespace
}  // namespace stereotlm::test
