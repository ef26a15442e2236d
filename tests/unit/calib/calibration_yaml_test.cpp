#include "calib/calibration_yaml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>

#include "calib/opencv_types.h"
#include "calib/synthetic_rig.h"

namespace stereotlm::calib {
namespace {

using testing::HasSubstr;

Calibration calibration() {
  Calibration made;
  made.grid = {9, 6, 25.4};
  made.rig = SyntheticRig(2, 320, 240).rig();
  made.rectification = rectify(made.rig);
  made.disparities = 112;
  made.disparity_offset = -7;
  made.quality = {0.1,         0.2, 1 / 3.0, {0.3, 0.4, 500}, {0.5, 0.6, 400}, HeldOut{0.7, {0.8, 0.9, 500}},
                  {1.25, 99.5}};
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
  try {
    parse_calibration(text);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "not refused";
}

TEST(CalibrationYaml, IsReadToTheLastBit) {
  const Calibration made = calibration();
  const Calibration read = parse_calibration(calibration_yaml(made));
  EXPECT_EQ(read.rig.width, 320);
  EXPECT_EQ(read.rig.height, 240);
  EXPECT_EQ(read.rig.left.matrix, made.rig.left.matrix);
  EXPECT_EQ(read.rig.left.distortion, made.rig.left.distortion);
  EXPECT_EQ(read.rig.right.matrix, made.rig.right.matrix);
  EXPECT_EQ(read.rig.right.distortion, made.rig.right.distortion);
  EXPECT_EQ(read.rig.rotation, made.rig.rotation);
  EXPECT_EQ(read.rig.translation, made.rig.translation);
  EXPECT_EQ(read.rectification.r1, made.rectification.r1);
  EXPECT_EQ(read.rectification.r2, made.rectification.r2);
  EXPECT_EQ(read.rectification.p1, made.rectification.p1);
  EXPECT_EQ(read.rectification.p2, made.rectification.p2);
  EXPECT_EQ(read.rectification.q, made.rectification.q);
  EXPECT_EQ(read.disparities, 112);
  EXPECT_EQ(read.disparity_offset, -7);
  EXPECT_EQ(read.grid.columns, 9);
  EXPECT_EQ(read.grid.rows, 6);
  EXPECT_EQ(read.grid.square_mm, 25.4);
  EXPECT_EQ(read.left_lut_sha256, made.left_lut_sha256);
  EXPECT_EQ(read.right_lut_sha256, made.right_lut_sha256);
  EXPECT_EQ(calibration_yaml(read), calibration_yaml(made));
}

TEST(CalibrationYaml, HoldsTheKeysOfOpenCVsSample) {
  const Calibration made = calibration();
  cv::FileStorage file(calibration_yaml(made), cv::FileStorage::READ | cv::FileStorage::MEMORY);
  for (const char* key : {"M1", "D1", "M2", "D2", "R", "T", "R1", "R2", "P1", "P2", "Q"}) {
    cv::Mat matrix;
    file[key] >> matrix;
    EXPECT_EQ(matrix.type(), CV_64F) << key;
  }
  cv::Mat q;
  file["Q"] >> q;
  EXPECT_EQ(to_eigen<Eigen::Matrix4d>(q), made.rectification.q);
  EXPECT_EQ(static_cast<int>(file["image_width"]), 320);
  EXPECT_EQ(static_cast<int>(file["disparity_offset"]), -7);
  EXPECT_EQ(static_cast<double>(file["quality"]["row_error"]["max_px"]), 0.4);
  EXPECT_EQ(static_cast<std::string>(file["sources"][0]["right"]), "right \"1\".jpg");
}

TEST(CalibrationYaml, WithoutHeldOutPairsIsRead) {
  Calibration made = calibration();
  made.quality.held_out.reset();
  EXPECT_FALSE(parse_calibration(calibration_yaml(made)).quality.held_out);
}

TEST(CalibrationYaml, ThatIsNoneIsRefused) {
  EXPECT_THAT(refusal(""), HasSubstr("first line: another: must be %YAML:1.0"));
  EXPECT_THAT(refusal("P5\n2 2\n255\n0000"), HasSubstr("first line: another: must be %YAML:1.0"));
  EXPECT_THAT(refusal("%YAML:1.0\n---\nM1: [1, 2\n"), HasSubstr("must be OpenCV FileStorage YAML"));
  EXPECT_THAT(refusal("%YAML:1.0\n---\nother: 1\n"), HasSubstr("image_width: missing"));
}

TEST(CalibrationYaml, ThatIsDamagedIsRefusedWithItsKey) {
  const std::string text = calibration_yaml(calibration());
  EXPECT_THAT(refusal(replaced(text, "image_width: 320", "image_width: 0")),
              HasSubstr("image_width: 0: must be"));
  EXPECT_THAT(refusal(replaced(text, "image_width: 320", "image_width: wide")),
              HasSubstr("image_width: no integer"));
  EXPECT_THAT(refusal(replaced(text, "disparity_offset: -7", "offset: -7")),
              HasSubstr("disparity_offset: missing"));
  EXPECT_THAT(refusal(replaced(text, "M2:", "M3:")), HasSubstr("M2: missing"));
  EXPECT_THAT(refusal(replaced(text, "rows: 3\n   cols: 1", "rows: 1\n   cols: 3")), HasSubstr("T: "));
  EXPECT_THAT(refusal(text.substr(0, text.find("P2:"))), HasSubstr("P2: missing"));
  EXPECT_THAT(refusal(text.substr(0, text.find("quality:"))), HasSubstr("quality: missing"));
}

TEST(CalibrationYaml, WithMatricesThatCannotBeIsRefused) {
  Calibration made = calibration();
  made.rig.rotation(0, 0) += 1e-3;
  EXPECT_THAT(refusal(calibration_yaml(made)), HasSubstr("R: no rotation"));
  made = calibration();
  made.rectification.r2 *= -1;
  EXPECT_THAT(refusal(calibration_yaml(made)), HasSubstr("R2: no rotation"));
  made = calibration();
  made.rectification.q(2, 3) *= 1.001;
  EXPECT_THAT(refusal(calibration_yaml(made)), HasSubstr("Q: "));
  made = calibration();
  made.rig.left.matrix(0, 0) = -500;
  EXPECT_THAT(refusal(calibration_yaml(made)), HasSubstr("M1: no camera"));
  made = calibration();
  made.rig.translation.x() = std::numeric_limits<double>::infinity();
  EXPECT_THAT(refusal(calibration_yaml(made)), HasSubstr("T: not finite"));
}

}  // namespace
}  // namespace stereotlm::calib
