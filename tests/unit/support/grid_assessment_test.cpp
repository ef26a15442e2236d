#include "tests/support/grid_assessment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "calib/synthetic_rig.h"

namespace stereotlm::test {
namespace {

// The true rig, and a board that answers with whole disparities.
class GridAssessmentTest : public testing::Test {
 protected:
  GridAssessmentTest() {
    made_.grid = {9, 6, 25};
    made_.rig = known_.rig();
    made_.rectification = rectify(made_.rig);
    made_.disparities = 200;
    made_.disparity_offset = 15;
    const auto corners = known_.grid_corners(made_.grid, 0);
    corners_ = {corners.left, corners.right};
    const calib::GridPair its = rectified(made_.rig, made_.rectification, corners_);
    for (std::size_t i = 0; i < its.left.size(); ++i) {
      const double d = its.left[i].x() - its.right[i].x() - made_.disparity_offset;
      set(its.left[i], static_cast<int>(std::floor(d + 0.5)));
      places_.push_back(its.left[i]);
      disparities_.push_back(static_cast<int>(std::floor(d + 0.5)));
    }
  }

  void set(const Eigen::Vector2d& rectified_left, int disparity) {
    disparity_.at(static_cast<int>(std::floor(rectified_left.x() - made_.disparity_offset + 0.5)),
                  static_cast<int>(std::floor(rectified_left.y() + 0.5))) =
        static_cast<std::uint8_t>(disparity);
  }

  calib::SyntheticRig known_{6, 640, 480};
  calib::Calibration made_;
  calib::GridPair corners_;
  kernels::GrayImage disparity_{640, 480, 255};
  std::vector<Eigen::Vector2d> places_;
  std::vector<int> disparities_;
};

TEST_F(GridAssessmentTest, OfTheBestWholeDisparitiesIsTheFloor) {
  const GridAssessment found = assess(made_, corners_, disparity_);
  EXPECT_EQ(found.corners, 54U);
  EXPECT_EQ(found.right, 54U);
  EXPECT_EQ(found.wrong, 0U);
  EXPECT_EQ(found.unanswered, 0U);
  EXPECT_EQ(found.lengths.percent.size(), 93U);  // 8 * 6 + 9 * 5
  EXPECT_EQ(found.lengths.percent, found.lengths_floor.percent);
  EXPECT_EQ(found.lengths.percent, found.lengths_of_answered.percent);
  EXPECT_GT(found.lengths.mean_absolute(), 0.1);
  EXPECT_LT(found.lengths.mean_absolute(), 3);
  EXPECT_LT(std::abs(found.lengths.mean()), found.lengths.mean_absolute());
  EXPECT_EQ(found.plane_percent, found.plane_floor_percent);
  EXPECT_GT(found.plane_percent, 0.01);
  EXPECT_LT(found.plane_percent, 1);
}

TEST_F(GridAssessmentTest, CountsWrongAndMissingAnswers) {
  set(places_[0], 255);
  set(places_[20], disparities_[20] + 2);
  set(places_[30], disparities_[30] + 1);
  const GridAssessment found = assess(made_, corners_, disparity_);
  EXPECT_EQ(found.unanswered, 1U);
  EXPECT_EQ(found.wrong, 1U);
  EXPECT_EQ(found.right, 52U);
  // Corner 0 has two neighbours, corner 20 four.
  EXPECT_EQ(found.lengths_of_answered.percent.size(), 91U);
  EXPECT_EQ(found.lengths.percent.size(), 87U);
  EXPECT_GT(found.plane_percent, found.plane_floor_percent);
}

TEST_F(GridAssessmentTest, MeasuresInMillimetres) {
  // Squares that are said to be 2 % larger than they are.
  made_.grid.square_mm *= 1.02;
  const GridAssessment found = assess(made_, corners_, disparity_);
  made_.grid.square_mm /= 1.02;
  const GridAssessment right = assess(made_, corners_, disparity_);
  EXPECT_NEAR(found.lengths.mean(), right.lengths.mean() - 2, 0.1);
  EXPECT_NEAR(right.distance_mm, found.distance_mm, 1e-9);
  EXPECT_GT(right.distance_mm, 200);
  EXPECT_LT(right.distance_mm, 2000);
}

TEST_F(GridAssessmentTest, RefusesDisparitiesOfAnotherSize) {
  EXPECT_THROW(assess(made_, corners_, kernels::GrayImage(320, 240)), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::test
