#include "calib/calibration_yaml.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "calib/calibration_reader.h"
#include "calib/opencv_types.h"
#include "calib/storage_yaml.h"
#include "calib/synthetic_rig.h"
#include "tests/support/scratch_folder.h"

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
  const std::string begin = "%YAML:1.0\n---\n";
  const std::string no_storage = ": must be OpenCV FileStorage YAML";
  for (const auto& [text, problem] : std::vector<std::pair<std::string, std::string>>{
           {"", "line 1: no OpenCV FileStorage: must begin with %YAML:1.0"},
           {"P5\n2 2\n255\n0000", "line 1: no OpenCV FileStorage: must begin with %YAML:1.0"},
           {begin, "line 3: no map of keys and values" + no_storage},
           {begin + "- 1\n", "line 3: no map of keys and values" + no_storage},
           {begin + "other: 1\n", "image_width: missing: a calibration has this key"},
           {begin + "a: 1\nM1: [1, 2\n", "line 5: end of sequence flow not found" + no_storage},
           {begin + "M1:\n   a: 1\n   : : x\n", "image_width: missing: a calibration has this key"},
           {begin + "a: 1\nb: 2\na: 3\n", "line 5: a: must be there once"},
           {begin + "a: &x 1\n", "line 3: an anchor or alias" + no_storage},
           {begin + "[a, b]: 1\n", "line 3: a key that is a map or list" + no_storage},
           {begin + "a: 1\n---\nb: 2\n", "line 4: a second document: must be the only one"},
           {begin + "a: 1\nb: \x04\n", "line 4: control character 0x04" + no_storage},
       }) {
    EXPECT_EQ(refusal(text), problem) << text;
  }
}

TEST(CalibrationYaml, WithoutBoundIsRefusedWithoutBoundlessWork) {
  const std::string begin = "%YAML:1.0\n---\na: ";
  for (const std::string part : {"[", "{a: ", "- ", "\n- ", "? ", "a: ", "[a, ", "\"", "!", "!!a ", "&a ",
                                 "*a ", "#", "\n ", "|\n ", ",", ": ", "[1,"}) {
    std::string text = begin;
    while (text.size() + part.size() <= kMostStorageBytes) text += part;
    EXPECT_NE(refusal(text), "not refused") << part;
  }
  const std::string deep = "line 3: nested too deeply: 8 maps and lists in each other at most";
  EXPECT_EQ(refusal(begin + std::string(50'000, '[')), deep);
  EXPECT_EQ(refusal(begin + "1 " + std::string(kMostStorageBytes, '#')),
            "1000019 bytes: must be 1000000 at most");
}

TEST(CalibrationYaml, ThatCouldNotBeReadIsNotWritten) {
  Calibration made = calibration();
  made.sources.assign(2000, {std::string(250, 'l'), std::string(250, 'r'), 54});
  EXPECT_THAT(test::message_of([&] { calibration_yaml(made); }),
              HasSubstr("a calibration of 2000 pairs = 11"));
}

TEST(CalibrationYaml, ThatIsDamagedIsRefusedWithItsKey) {
  const std::string text = calibration_yaml(calibration());
  EXPECT_THAT(refusal(replaced(text, "image_width: 320", "image_width: 0")),
              HasSubstr("line 3: image_width: 0: must be"));
  EXPECT_THAT(refusal(replaced(text, "image_width: 320", "image_width: wide")),
              HasSubstr("image_width: no integer"));
  EXPECT_THAT(refusal(replaced(text, "disparity_offset: -7", "offset: -7")),
              HasSubstr("disparity_offset: missing"));
  EXPECT_THAT(refusal(replaced(text, "M2:", "M3:")), HasSubstr("M2: missing"));
  EXPECT_THAT(refusal(replaced(text, "rows: 3\n   cols: 1", "rows: 1\n   cols: 3")),
              HasSubstr("T: 1x3 of d: must be 3x1 of d, doubles"));
  EXPECT_THAT(refusal(replaced(text, "rows: 3\n   cols: 1\n   dt: d", "rows: 3\n   cols: 1\n   dt: f")),
              HasSubstr("T: 3x1 of f: must be 3x1 of d, doubles"));
  EXPECT_THAT(refusal(replaced(text, "0., 0., 1. ]", "0., 1. ]")),
              HasSubstr("M1.data: 8 numbers: must be 9"));
  EXPECT_THAT(refusal(replaced(text, "0., 0., 1. ]", "0., 0., one ]")),
              HasSubstr("line 14: M1.data: no number: must hold numbers"));
  EXPECT_THAT(refusal(replaced(text, "square_mm: ", "square_mm: mm")),
              HasSubstr("grid.square_mm: no number"));
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
  EXPECT_THAT(refusal(calibration_yaml(made)), HasSubstr("T.data: not finite"));
}

}  // namespace
}  // namespace stereotlm::calib
