#include "tests/support/random_rig.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/grid.h"

namespace stereotlm::test {
namespace {

using calib::Corners;
using calib::GridPair;
using Eigen::Vector2d;

// Where the cameras see the grid, without noise and without faults.
GridPair truth(const RandomRig& random, std::size_t position) {
  GridPair result;
  for (const Eigen::Vector3d& corner : calib::corner_points(random.grid)) {
    const calib::SeenPoint seen = calib::seen_by(random.rig, random.poses[position] * corner);
    result.left.push_back(seen.left);
    result.right.push_back(seen.right);
  }
  return result;
}

// The largest distance between corners that should be the same.
double apart(const Corners& a, const Corners& b) {
  double most = 0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
  return most;
}
double apart(const GridPair& a, const GridPair& b) {
  return std::max(apart(a.left, b.left), apart(a.right, b.right));
}

double cosine(double degrees) { return std::cos(degrees * std::acos(-1) / 180); }

TEST(RandomRig, IsOfTheKindThatIsPromised) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE(seed);
    const RandomRig random = random_rig(seed, 0);
    const calib::Rig& rig = random.rig;
    const Vector2d last(rig.width - 1, rig.height - 1);
    EXPECT_TRUE(rig.width >= 320 && rig.width <= 1280 && rig.width % 4 == 0) << rig.width;
    EXPECT_TRUE(rig.height >= 240 && rig.height <= 960) << rig.height;
    EXPECT_TRUE(rig.translation.norm() >= 40 && rig.translation.norm() <= 400) << rig.translation;
    EXPECT_TRUE(random.pairs.size() >= 6 && random.pairs.size() <= 20) << random.pairs.size();
    for (const calib::CameraModel& camera : {rig.left, rig.right})
      EXPECT_GT(camera.widest(), 1.1 * camera.direction(last).norm());
    Eigen::Matrix2d leaning = Eigen::Matrix2d::Zero();
    for (std::size_t i = 0; i < random.pairs.size(); ++i) {
      const Eigen::Matrix3d rotation = random.poses[i].linear();
      EXPECT_TRUE(rotation(2, 2) > cosine(40.01) && rotation(2, 2) < cosine(14.99)) << rotation;
      EXPECT_LT((rig.rotation * rotation)(2, 2), cosine(14.99));
      leaning += rotation.col(2).head<2>().normalized() * rotation.col(2).head<2>().normalized().transpose();
      EXPECT_LT(apart(random.pairs[i], truth(random, i)), 1e-9);
      for (const Corners* corners : {&random.pairs[i].left, &random.pairs[i].right}) {
        for (const Vector2d& corner : *corners)
          EXPECT_GE(std::min(corner.minCoeff(), (last - corner).minCoeff()), 4);
      }
    }
    // 0.25 if the grid leans equally often in all directions, 0 if always in one.
    EXPECT_GT((leaning / leaning.trace()).determinant(), 0.1);
  }
}

TEST(RandomRig, HasTheNoiseThatIsAskedForAndIsTheSameEachTime) {
  double squares = 0;
  double sum = 0;
  double count = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const RandomRig random = random_rig(seed, 0.2);
    EXPECT_EQ(apart(random.pairs.back(), random_rig(seed, 0.2).pairs.back()), 0);
    for (std::size_t i = 0; i < random.pairs.size(); ++i) {
      for (const auto side : {&GridPair::left, &GridPair::right}) {
        const Corners exact = truth(random, i).*side;
        for (std::size_t corner = 0; corner < exact.size(); ++corner) {
          const Vector2d noise = (random.pairs[i].*side)[corner] - exact[corner];
          squares += noise.squaredNorm();
          sum += noise.sum();
          count += 2;
        }
      }
    }
  }
  EXPECT_NEAR(std::sqrt(squares / count), 0.2, 0.002);
  EXPECT_NEAR(sum / count, 0, 0.005);
}

// Undoes a fault of the pictures. The corners must then be where they are without it.
template <typename Undo>
void expect_undone(Fault fault, const Undo& undo) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    for (const FaultyRig& faulty : {faulty_rig(seed, 0, fault), made_rig(seed, fault)}) {
      for (std::size_t i = 0; i < faulty.pairs.size(); ++i) {
        const GridPair exact = truth(faulty, i);
        GridPair pair = faulty.pairs[i];
        EXPECT_GT(apart(pair, exact), 5);
        undo(faulty, pair);
        pair.left = calib::ordered_like(exact.left, faulty.grid, pair.left);
        pair.right = calib::ordered_like(exact.right, faulty.grid, pair.right);
        EXPECT_LT(apart(pair, exact), 0.5);
      }
    }
  }
}

TEST(FaultyRig, IsSoundAgainWhenItsPicturesAre) {
  expect_undone(Fault::kExchanged, [](const auto&, GridPair& pair) { std::swap(pair.left, pair.right); });
  expect_undone(Fault::kUpsideDown, [](const FaultyRig& faulty, GridPair& pair) {
    for (Vector2d& corner : pair.right) corner = Vector2d(faulty.width - 1, faulty.height - 1) - corner;
  });
  expect_undone(Fault::kMirrored, [](const FaultyRig& faulty, GridPair& pair) {
    for (Vector2d& corner : pair.right) corner.x() = faulty.width - 1 - corner.x();
    for (auto row = pair.right.begin(); row != pair.right.end(); row += faulty.grid.columns)
      std::reverse(row, row + faulty.grid.columns);
  });
  expect_undone(Fault::kOppositeQuarters, [](const FaultyRig& faulty, GridPair& pair) {
    for (Vector2d& corner : pair.left) corner = {faulty.height - 1 - corner.y(), corner.x()};
    for (Vector2d& corner : pair.right) corner = {corner.y(), faulty.width - 1 - corner.x()};
  });
}

TEST(FaultyRig, IsWrongAsItSays) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const FaultyRig late = faulty_rig(seed, 0, Fault::kLate);
    const std::size_t lost = late.poses.size() - late.pairs.size();
    ASSERT_EQ(static_cast<std::size_t>(std::abs(late.shift)), lost);
    EXPECT_LT(apart(late.pairs[0].left, truth(late, late.shift < 0 ? lost : 0).left), 1e-9);
    EXPECT_LT(apart(late.pairs[0].right, truth(late, late.shift < 0 ? 0 : lost).right), 1e-9);
    const FaultyRig reversed = faulty_rig(seed, 0, Fault::kReversed);
    EXPECT_LT(apart(reversed.pairs[0].left, truth(reversed, 0).left), 1e-9);
    EXPECT_LT(apart(reversed.pairs[0].right, truth(reversed, reversed.poses.size() - 1).right), 1e-9);
    EXPECT_GE(faulty_rig(seed, 0.3, Fault::kMoved).moved_px, 1.5);
    for (const Eigen::Isometry3d& pose : faulty_rig(seed, 0, Fault::kFrontal).poses)
      EXPECT_EQ(pose.linear()(2, 2), 1);
    for (const Eigen::Isometry3d& pose : faulty_rig(seed, 0, Fault::kHardlyTilted).poses)
      EXPECT_GT(pose.linear()(2, 2), cosine(5.01));
  }
}

TEST(FaultyRig, NamesTheBadPairs) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    for (const Fault fault : {Fault::kSomeMoved, Fault::kOneMiscounted, Fault::kOneLostInEach}) {
      const FaultyRig faulty = faulty_rig(seed, 0, fault);
      const std::vector<std::size_t>& bad = faulty.bad_pairs;
      ASSERT_FALSE(bad.empty());
      const std::size_t lost = faulty.poses.size() - faulty.pairs.size();
      for (std::size_t i = 0; i < faulty.pairs.size(); ++i) {
        const bool is_sound = apart(faulty.pairs[i], truth(faulty, i + (i < bad.front() ? 0 : lost))) < 1e-9;
        EXPECT_NE(is_sound, std::find(bad.begin(), bad.end(), i) != bad.end());
      }
    }
  }
}

}  // namespace
}  // namespace stereotlm::test
