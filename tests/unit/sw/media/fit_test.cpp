#include "sw/media/fit.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/scratch_folder.h"

namespace stereotlm::media {
namespace {

constexpr float kNone = Truth::kUnknown;

// Pixel (x, y) is 10 * y + x + 1.
kernels::GrayImage counted(int width, int height) {
  kernels::GrayImage picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) picture.at(x, y) = static_cast<std::uint8_t>(10 * y + x + 1);
  }
  return picture;
}

TEST(Fit, CropsTheMiddle) {
  const Fit fit = {"crop", Size{4, 2}};
  const kernels::GrayImage picture = counted(7, 5);  // of 3 columns and 3 rows too many 1 and 1 come first
  EXPECT_EQ(fit.fitted(picture).pixels, (std::vector<std::uint8_t>{12, 13, 14, 15, 22, 23, 24, 25}));
  EXPECT_EQ(fit.fitted(Truth(picture, 2)).levels, (std::vector<float>{12, 13, 14, 15, 22, 23, 24, 25}));
  EXPECT_EQ(fit.fitted(Truth(picture, 2)).scale, 2);
}

TEST(Fit, PadsOnTheRightAndBelow) {
  const Fit fit = {"pad", Size{4, 3}};
  const kernels::GrayImage picture = counted(3, 2);
  EXPECT_EQ(fit.fitted(picture).pixels,
            (std::vector<std::uint8_t>{1, 2, 3, 3, 11, 12, 13, 13, 11, 12, 13, 13}));
  EXPECT_EQ(fit.fitted(Truth(picture, 1)).levels,
            (std::vector<float>{1, 2, 3, kNone, 11, 12, 13, kNone, kNone, kNone, kNone, kNone}));
}

TEST(Fit, RefusesOtherSizesWithTheCure) {
  const auto said = [](const char* name, const Size& size, bool has_calibration = false) {
    return test::message_of([&] { Fit{name, Size{64, 48}, has_calibration}.check("'f'", size); });
  };
  const std::string rule = " pixels: must be as large as the board's images, 64x48";
  EXPECT_EQ(
      said("", {45, 40}),
      "'f': 45x40" + rule + ": add --fit pad, or --set image.width=44 --set image.height=40 --fit crop");
  EXPECT_EQ(said("", {80, 48}),
            "'f': 80x48" + rule + ": add --fit crop, or --set image.width=80 --set image.height=48");
  EXPECT_EQ(said("", {80, 40}), "'f': 80x40" + rule + ": add --set image.width=80 --set image.height=40");
  EXPECT_EQ(said("", {80, 48}, true), "'f': 80x48" + rule) << "--fit does not go with a calibration";
  const std::string images = "as large as the board's images, 64x48: add --fit ";
  EXPECT_EQ(said("crop", {63, 48}).find("'f': 63x48 pixels: must be at least " + images + "pad"), 0U);
  EXPECT_EQ(said("pad", {65, 48}).find("'f': 65x48 pixels: must be at most " + images + "crop"), 0U);
  for (const Size& size : {Size{64, 48}, Size{65, 50}})
    EXPECT_NO_THROW((Fit{"crop", Size{64, 48}}.check("", size)));
  for (const Size& size : {Size{64, 48}, Size{1, 1}})
    EXPECT_NO_THROW((Fit{"pad", Size{64, 48}}.check("", size)));
  EXPECT_NO_THROW((Fit{"", Size{64, 48}}.check("", {64, 48})));
  EXPECT_NE(said("pad", {0, 1}), "");
}

TEST(Truth, MovesWithTheLeftPictureByAnOffset) {
  Truth truth(kernels::GrayImage(4, 1), 2);
  truth.levels = {2, kNone, 6, 8};
  EXPECT_EQ(with_offset(truth, 1).levels, (std::vector<float>{kNone, 4, 6, kNone}));
  EXPECT_EQ(with_offset(truth, 3).levels, (std::vector<float>{2, kNone, kNone, kNone}));
  EXPECT_EQ(with_offset(truth, -2).levels, (std::vector<float>{kNone, kNone, 6, kNone}));
  truth.levels = {2, 4, 6, 8};
  EXPECT_EQ(with_offset(truth, 2).levels, (std::vector<float>{2, 4, kNone, kNone}));
  EXPECT_EQ(with_offset(truth, 0).levels, truth.levels);
  truth.levels[2] = 1;
  EXPECT_EQ(with_offset(truth, 2).levels[0], -3) << "a disparity that the board cannot find is known";
}

}  // namespace
}  // namespace stereotlm::media
