#include "calib/calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "calib/opencv_conversions.h"
#include "sw/media/synthetic_rig.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::calib {
namespace {

using testing::HasSubstr;

Calibration calibration() {
  Calibration made;
  made.grid = {9, 6, 25.4};
  made.rig = media::SyntheticRig(2, 320, 240).rig();
  made.rectification = rectify(made.rig);
  made.disparities = 112;
  made.disparity_offset = -7;
  made.quality = {0.1,         0.2, 1 / 3.0, {0.3, 0.4, 500}, {0.5, 0.6, 400}, HeldOut{0.7, {0.8, 0.9, 500}},
                  {1.25, 99.5}};
  made.certainty =
      Certainty{0.1, 0.2, true, 1 / 7.0, 0.4, 0.5, 0.6, 33.3, {{500, 1.5, 2.5}, {900, 3, 1 / 9.0}}};
  made.sources = {{"a: b.jpg", "right \"1\".jpg", 54}, {"left2.jpg", "right2.jpg", 0}};
  made.left_lut_sha256 = std::string(64, 'a');
  made.right_lut_sha256 = std::string(64, '0');
  return made;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string refusal(const std::string& text) {
  return test::message_of([&text] { parse_calibration(text); });
}

TEST(CalibrationYaml, HoldsTheKeysOfOpenCVsSample) {
  const Calibration made = calibration();
  cv::FileStorage file(calibration_yaml(made), cv::FileStorage::READ | cv::FileStorage::MEMORY);
  const auto expect_matrix = [&file](const char* key, const cv::Mat& expected) {
    cv::Mat matrix;
    file[key] >> matrix;
    ASSERT_EQ(matrix.type(), CV_64F) << key;
    EXPECT_EQ(cv::norm(matrix, expected, cv::NORM_INF), 0) << key;
  };
  expect_matrix("M1", to_mat(made.rig.left.matrix));
  expect_matrix("D1", coefficients_of(made.rig.left));
  expect_matrix("M2", to_mat(made.rig.right.matrix));
  expect_matrix("D2", coefficients_of(made.rig.right));
  expect_matrix("R", to_mat(made.rig.rotation));
  expect_matrix("T", to_mat(made.rig.translation));
  expect_matrix("R1", to_mat(made.rectification.r1));
  expect_matrix("R2", to_mat(made.rectification.r2));
  expect_matrix("P1", to_mat(made.rectification.p1));
  expect_matrix("P2", to_mat(made.rectification.p2));
  expect_matrix("Q", to_mat(made.rectification.q));
  EXPECT_EQ(static_cast<int>(file["image_width"]), 320);
  EXPECT_EQ(static_cast<int>(file["image_height"]), 240);
  EXPECT_EQ(static_cast<int>(file["disparities"]), 112);
  EXPECT_EQ(static_cast<int>(file["disparity_offset"]), -7);
  EXPECT_EQ(static_cast<int>(file["grid"]["columns"]), 9);
  EXPECT_EQ(static_cast<double>(file["grid"]["square_mm"]), 25.4);
  EXPECT_EQ(static_cast<std::string>(file["left_lut_sha256"]), made.left_lut_sha256);
  EXPECT_EQ(static_cast<double>(file["quality"]["row_error"]["max_px"]), 0.4);
  EXPECT_EQ(static_cast<double>(file["certainty"]["focal_sigma_px"]), 1 / 7.0);
  EXPECT_EQ(static_cast<double>(file["certainty"]["depth_errors"][1]["calibration_mm"]), 1 / 9.0);
  EXPECT_EQ(static_cast<std::string>(file["sources"][0]["right"]), "right \"1\".jpg");
}

TEST(CalibrationYaml, IsReadToTheLastBit) {
  const std::string text = calibration_yaml(calibration());
  EXPECT_EQ(calibration_yaml(parse_calibration(text)), text);
}

TEST(CalibrationYaml, HoldsThePatternOfTheGrid) {
  Calibration made = calibration();
  made.grid = {4, 11, 15, Pattern::kAsymmetricCircles};
  const std::string text = calibration_yaml(made);
  EXPECT_EQ(parse_calibration(text).grid.pattern, Pattern::kAsymmetricCircles);
  const std::string line = "pattern: asymmetric_circles";
  EXPECT_EQ(parse_calibration(replaced(text, line, "")).grid.pattern, Pattern::kChessboard);
  EXPECT_THAT(refusal(replaced(text, line, "pattern: dots")),
              HasSubstr("grid.pattern: dots: must be one of chessboard, circles, asymmetric_circles"));
}

TEST(CalibrationYaml, IsReadWithoutHeldOutPairs) {
  Calibration made = calibration();
  made.quality.held_out.reset();
  EXPECT_FALSE(parse_calibration(calibration_yaml(made)).quality.held_out);
}

TEST(CalibrationYaml, IsRefusedIfItIsNoStorage) {
  const std::string begin = "%YAML:1.0\n---\n";
  const std::string no_storage = ": must be OpenCV FileStorage YAML";
  for (const auto& [text, problem] : std::vector<std::pair<std::string, std::string>>{
           {"", "line 1: no OpenCV FileStorage: must begin with %YAML:1.0"},
           {"P5\n2 2\n255\n0000", "line 1: no OpenCV FileStorage: must begin with %YAML:1.0"},
           {begin, "line 3: no map: must be a map of keys and values"},
           {begin + "- 1\n", "line 3: no map: must be a map of keys and values"},
           {begin + "other: 1\n", "image_width: missing: a calibration has this key"},
           {begin + "a: 1\nM1: [1, 2\n", "line 5: end of sequence flow not found" + no_storage},
           {begin + "M1:\n   a: 1\n   : : x\n", "image_width: missing: a calibration has this key"},
           {begin + "a: 1\nb: 2\na: 3\n", "line 5: a: must be there once"},
           {begin + "[a, b]: 1\n", "line 3: a key: must be a text"},
           {begin + "a: 1\n---\nb: 2\n", "line 1: 2 documents: must be one"},
       }) {
    EXPECT_EQ(refusal(text), problem) << text;
  }
}

TEST(CalibrationYaml, IsRefusedInBoundedTimeIfItIsHugeOrDeep) {
  const std::string begin = "%YAML:1.0\n---\na: ";
  for (const std::string part : {"[", "{a: ", "- ", "\n- ", "? ", "a: ", "[a, ", "\"", "!", "!!a ", "&a ",
                                 "*a ", "#", "\n ", "|\n ", ",", ": ", "[1,"}) {
    std::string text = begin;
    while (text.size() + part.size() <= kMostCalibrationBytes) text += part;
    EXPECT_THROW(parse_calibration(text), std::runtime_error) << part;
  }
  EXPECT_THAT(refusal(begin + std::string(50'000, '[')), HasSubstr("must be OpenCV FileStorage YAML"));
  EXPECT_EQ(refusal(begin + "1 " + std::string(kMostCalibrationBytes, '#')),
            "1000019 bytes: must be 1000000 at most");
}

TEST(CalibrationYaml, IsNotWrittenLongerThanItCanBeRead) {
  Calibration made = calibration();
  made.sources.assign(2000, {std::string(250, 'l'), std::string(250, 'r'), 54});
  EXPECT_THAT(test::message_of([&] { calibration_yaml(made); }),
              HasSubstr("a calibration of 2000 pairs = 11"));
}

TEST(CalibrationYaml, IsRefusedWithTheKeyThatIsDamaged) {
  const std::string text = calibration_yaml(calibration());
  struct Damage {
    const char* from;
    const char* to;
    const char* problem;
  };
  for (const Damage& damage : {
           Damage{"image_width: 320", "image_width: 0", "line 3: image_width: 0: must be"},
           Damage{"image_width: 320", "image_width: wide", "image_width: no integer"},
           Damage{"disparity_offset: -7", "offset: -7", "disparity_offset: missing"},
           Damage{"M2:", "M3:", "M2: missing"},
           Damage{"rows: 3\n   cols: 1", "rows: 1\n   cols: 3", "T: 1x3 of d: must be 3x1 of d, doubles"},
           Damage{"rows: 3\n   cols: 1\n   dt: d", "rows: 3\n   cols: 1\n   dt: f",
                  "T: 3x1 of f: must be 3x1 of d, doubles"},
           Damage{"0., 0., 1. ]", "0., 1. ]", "M1.data: 8 numbers: must be 9"},
           Damage{"0., 0., 1. ]", "0., 0., one ]", "line 13: M1.data: no numbers: must hold numbers"},
           Damage{"square_mm: ", "square_mm: mm", "grid.square_mm: no number"},
       })
    EXPECT_THAT(refusal(replaced(text, damage.from, damage.to)), HasSubstr(damage.problem));
  for (const std::string key : {"P2", "quality"})
    EXPECT_THAT(refusal(text.substr(0, text.find(key + ':'))), HasSubstr(key + ": missing"));
}

TEST(CalibrationYaml, IsRefusedWithImpossibleMatrices) {
  const auto expect_refused = [](const char* problem, void (*damage)(Calibration&)) {
    Calibration made = calibration();
    damage(made);
    EXPECT_THAT(refusal(calibration_yaml(made)), HasSubstr(problem));
  };
  expect_refused("R: no rotation", [](Calibration& made) { made.rig.rotation(0, 0) += 1e-3; });
  expect_refused("R2: no rotation", [](Calibration& made) { made.rectification.r2 *= -1; });
  expect_refused("Q: ", [](Calibration& made) { made.rectification.q(2, 3) *= 1.001; });
  expect_refused("M1: no camera", [](Calibration& made) { made.rig.left.matrix(0, 0) = -500; });
  expect_refused("T.data: not finite", [](Calibration& made) {
    made.rig.translation.x() = std::numeric_limits<double>::infinity();
  });
}

TEST(DisparityOffset, CentresTheGridsDisparities) {
  const DisparityRange range = {100.14, 203.4};
  EXPECT_EQ(range.needed(), 105);
  EXPECT_EQ(disparity_offset_for(range, 105), 100);
  EXPECT_EQ(disparity_offset_for(range, 106), 100);
  EXPECT_EQ(disparity_offset_for(range, 107), 99);
  EXPECT_EQ(disparity_offset_for(range, 112), 97);
}

TEST(DisparityOffset, IsNotBelowZeroUnlessItMustBe) {
  EXPECT_EQ(disparity_offset_for({3.5, 20}, 80), 0);
  EXPECT_EQ(disparity_offset_for({-3, 250}, 254), -3);
  EXPECT_THAT(test::message_of([] {
                disparity_offset_for({-3, 251}, 254);
              }),
              testing::HasSubstr("the grid's disparities are -3..251, and a board has 254 at most"));
  EXPECT_EQ(disparity_offset_for({-3.5, 20}, 80), -4);
}

TEST(DisparityOffset, NamesTheDisparitiesNeededIfTheyDoNotFit) {
  EXPECT_EQ(test::message_of([] {
              disparity_offset_for({100.14, 203.4}, 104);
            }),
            "--disparities = 104: must be 105 or more for the grid's own, 100..204; or --disparity-offset N, "
            "for a part of them");
}

TEST(RowError, IsTheAverageOfAbsoluteValues) {
  EXPECT_EQ(row_error({}).corners, 0U);
  EXPECT_EQ(row_error({}).mean_px, 0);
  const RowError error = row_error({0.5, -1.5});
  EXPECT_DOUBLE_EQ(error.mean_px, 1);
  EXPECT_DOUBLE_EQ(error.max_px, 1.5);
  EXPECT_EQ(error.corners, 2U);
}

}  // namespace
}  // namespace stereotlm::calib
