#include "calib/calibrate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "models/kernels/stereo.h"
#include "sw/media/synthetic_rig.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::calib {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;
const GridShape kShape = {7, 5, 30};

// Rendering the pictures takes most of the time, so all cases share one rig.
class CalibrateTest : public testing::Test {
 protected:
  static CalibrationRequest request(int pairs) {
    CalibrationRequest request;
    request.grid = kShape;
    request.disparities = 120;
    for (int number = 0; number < pairs; ++number) {
      auto view = rig().grid_view(kShape, number);
      request.pictures.push_back({"left" + std::to_string(number), "right" + std::to_string(number),
                                  std::move(view.left), std::move(view.right)});
    }
    return request;
  }

  static const media::SyntheticRig& rig() {
    static const media::SyntheticRig rig(8, kWidth, kHeight);
    return rig;
  }
};

TEST_F(CalibrateTest, RecoversAKnownRigAndItsDisparities) {
  const CalibrationResult found = calibrate(request(8));
  const Calibration& made = found.calibration;
  const Rig& known = rig().rig();
  EXPECT_EQ(found.pairs.size(), 8U);
  EXPECT_TRUE(found.skipped.empty());
  EXPECT_LT(made.quality.stereo_rms_px, 0.15);
  EXPECT_LT(made.quality.row_error.mean_px, 0.1);
  ASSERT_TRUE(made.quality.held_out);
  EXPECT_LT(made.quality.held_out->row_error.mean_px, 0.15);
  EXPECT_GT(made.quality.held_out->rms_px, made.quality.stereo_rms_px);
  EXPECT_LT(made.quality.found_again.mean_px, 0.4);
  EXPECT_NEAR(made.rig.left.matrix(0, 0) / known.left.matrix(0, 0), 1, 0.01);
  EXPECT_LT((made.rig.rotation - known.rotation).cwiseAbs().maxCoeff(), 0.01);
  EXPECT_NEAR(made.rig.translation.norm() / known.translation.norm(), 1, 0.01);

  // With the recovered tables the board finds the disparities of the true matches of the scene.
  const auto scene = rig().scene();
  kernels::StereoConfig config;
  config.disparities = 60;
  const TablePair plain = tables(made.rig, made.rectification, 0);
  const kernels::GrayImage board =
      kernels::disparity_image(scene.left, scene.right, &plain.left, &plain.right, config);
  const std::vector<float> truth = rig().disparity(made.rig, made.rectification, 0);
  std::size_t answered = 0;
  std::size_t right = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (board.pixels[i] == 255 || std::isnan(truth[i])) continue;
    ++answered;
    if (std::abs(static_cast<float>(board.pixels[i]) - truth[i]) <= 1) ++right;
  }
  EXPECT_GT(answered, truth.size() / 2);
  EXPECT_GT(static_cast<double>(right), 0.95 * static_cast<double>(answered));
}

TEST_F(CalibrateTest, RecoversAKnownRigFromCircles) {
  const media::SyntheticRig known(8, 480, 360);
  for (const GridShape& shape :
       {GridShape{7, 5, 30, Pattern::kCircles}, GridShape{4, 9, 20, Pattern::kAsymmetricCircles}}) {
    CalibrationRequest request;
    request.grid = shape;
    request.disparities = 160;
    for (int number = 0; number < 8; ++number) {
      auto view = known.grid_view(shape, number);
      request.pictures.push_back({"left", "right", std::move(view.left), std::move(view.right)});
    }
    request.pictures[3].right = kernels::GrayImage(480, 360, 100);
    const CalibrationResult found = calibrate(request);
    const Rig& rig = found.calibration.rig;
    EXPECT_EQ(found.pairs.size(), 7U);
    EXPECT_EQ(found.skipped, std::vector<std::string>{"'right': no grid of " + shape.text() + " found"});
    EXPECT_NEAR(rig.left.matrix(0, 0) / known.rig().left.matrix(0, 0), 1, 0.005);
    EXPECT_LT((rig.rotation - known.rig().rotation).cwiseAbs().maxCoeff(), 0.01);
    EXPECT_NEAR(rig.translation.norm() / known.rig().translation.norm(), 1, 0.005);
    EXPECT_LT(found.calibration.quality.row_error.mean_px, 0.05);
    // The circles are searched for again. Nearest pixels give an error of some tenths.
    EXPECT_GE(found.calibration.quality.found_again.corners, 100U);
    EXPECT_GT(found.calibration.quality.found_again.mean_px, 0.01);
    EXPECT_LT(found.calibration.quality.found_again.mean_px, 0.4);
  }
}

TEST_F(CalibrateTest, ReportsEachPictureAndNamesHalves) {
  CalibrationRequest some = request(4);
  std::vector<std::string> reports;
  some.progress = [&reports](std::size_t pictures, const std::string& last) {
    reports.push_back(std::to_string(pictures) + ' ' + last);
  };
  some.pictures[1].right_name = some.pictures[1].left_name = "both.png";
  some.pictures[1].right = kernels::GrayImage(kWidth, kHeight, 100);
  calibrate(some);
  ASSERT_EQ(reports.size(), 8U);
  EXPECT_EQ(reports[0], "1 'left0': found");
  EXPECT_EQ(reports[2], "3 'both.png' (left half): found");
  EXPECT_EQ(reports[3], "4 'both.png' (right half): no grid of 7x5 inner corners found");
  EXPECT_EQ(reports[7], "8 'right3': found");
}

TEST_F(CalibrateTest, UsesTheGivenOffset) {
  CalibrationRequest with_auto = request(4);
  with_auto.disparities = 200;
  const CalibrationResult chosen = calibrate(with_auto);
  with_auto.disparity_offset = chosen.calibration.disparity_offset + 3;
  const CalibrationResult given = calibrate(with_auto);
  EXPECT_EQ(given.calibration.disparity_offset, chosen.calibration.disparity_offset + 3);
  EXPECT_EQ(given.tables.right.entries, chosen.tables.right.entries);
  EXPECT_EQ(given.tables.left.entries[100 * kWidth + 50], chosen.tables.left.entries[100 * kWidth + 53]);
}

TEST_F(CalibrateTest, NamesAndSkipsPicturesWithoutGrid) {
  CalibrationRequest some = request(5);
  some.pictures[1].right = kernels::GrayImage(kWidth, kHeight, 100);
  const CalibrationResult found = calibrate(some);
  ASSERT_EQ(found.pairs.size(), 4U);
  EXPECT_EQ(found.pairs[1].picture, 2U);
  EXPECT_EQ(found.skipped, std::vector<std::string>{"'right1': no grid of 7x5 inner corners found"});
  EXPECT_EQ(found.calibration.sources[1].left, "left2");
}

kernels::GrayImage turned(const kernels::GrayImage& image) {
  kernels::GrayImage result(image.height, image.width);
  for (int row = 0; row < result.height; ++row) {
    for (int column = 0; column < result.width; ++column) {
      result.at(column, row) = image.at(row, image.height - 1 - column);
    }
  }
  return result;
}

TEST_F(CalibrateTest, NamesTheMistakeInThePicturesOrTheRequest) {
  const CalibrationRequest sound = request(4);
  const auto expect_refused = [&sound](const char* problem, void (*spoil)(CalibrationRequest&)) {
    CalibrationRequest request = sound;
    spoil(request);
    EXPECT_THAT(test::message_of([&request] { calibrate(request); }), testing::ContainsRegex(problem));
  };
  const auto without_grids = [](CalibrationRequest& request) {
    for (const std::size_t pair : {1U, 2U}) request.pictures[pair].left = kernels::GrayImage(kWidth, kHeight);
  };
  expect_refused("7x5 inner corners in both pictures = 2 of 4: must be 3 or more", without_grids);
  expect_refused("'left1': no grid", without_grids);
  const auto of_another_size = [](CalibrationRequest& request) { request.grid = {8, 6, 30}; };
  expect_refused("8x6 inner corners in both pictures = 0 of 4", of_another_size);
  expect_refused("a board of 10x7 squares has 9x6", of_another_size);
  expect_refused("the cameras are swapped", [](CalibrationRequest& request) {
    for (PicturePair& pair : request.pictures) std::swap(pair.left, pair.right);
  });
  expect_refused("they must stand in two places", [](CalibrationRequest& request) {
    for (PicturePair& pair : request.pictures) pair.right = pair.left;
  });
  expect_refused("the cameras must stand side by side", [](CalibrationRequest& request) {
    for (PicturePair& pair : request.pictures) {
      pair.left = turned(pair.left);
      pair.right = turned(pair.right);
    }
  });
  expect_refused("disparities = 4: must be [0-9]+ or more for the grid's own",
                 [](CalibrationRequest& request) { request.disparities = 4; });
}

}  // namespace
}  // namespace stereotlm::calib
