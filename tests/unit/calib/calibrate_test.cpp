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
