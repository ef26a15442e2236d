#include "calib/import_rig.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <opencv2/calib3d.hpp>

#include "calib/calibration.h"
#include "calib/opencv_conversions.h"

namespace stereotlm::calib {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

// A rig with lenses of this model, in every other part like one that people have.
Rig rig_with(const std::vector<double>& lens, bool is_fisheye) {
  Rig rig;
  rig.width = 640;
  rig.height = 480;
  for (CameraModel* const camera : {&rig.left, &rig.right}) {
    camera->matrix << 521.25, 0, 318.5, 0, 519.75, 244.25, 0, 0, 1;
    std::copy(lens.begin(), lens.end(), camera->distortion.begin());
    camera->is_fisheye = is_fisheye;
  }
  rig.right.matrix(0, 2) = 325;
  rig.rotation = Eigen::AngleAxisd(0.02, Eigen::Vector3d(0.3, 0.9, -0.1).normalized()).toRotationMatrix();
  rig.translation = {-79.5, 0.75, 1.5};
  return rig;
}

struct Lens {
  std::vector<double> coefficients;
  bool is_fisheye = false;
};
const std::vector<Lens> kLenses = {{{-0.28, 0.08, 0.001, -0.002, 0.01}},
                                   {{0.3, -0.1, 0.001, -0.002, 0.01, 0.5, -0.05, 0.02}},
                                   {{-0.2, 0.05, 0, 0, 0, 0, 0, 0, 0.004, -0.001, -0.003, 0.002}},
                                   {{-0.02, 0.01, -0.004, 0.001}, true}};

// Each model of a lens sees what OpenCV's projection sees, and direction() is its inverse.
TEST(CameraModel, IsThatOfOpenCV) {
  for (const Lens& lens : kLenses) {
    const CameraModel camera = rig_with(lens.coefficients, lens.is_fisheye).left;
    EXPECT_EQ(camera.coefficients(), lens.coefficients.size());
    for (double x = -0.6; x < 0.7; x += 0.3) {
      for (double y = -0.45; y < 0.5; y += 0.3) {
        std::vector<cv::Point2d> seen;
        if (lens.is_fisheye) {
          cv::fisheye::projectPoints(std::vector<cv::Point3d>{{x, y, 1}}, seen, cv::Vec3d(), cv::Vec3d(),
                                     to_mat(camera.matrix), coefficients_of(camera));
        } else {
          cv::projectPoints(std::vector<cv::Point3d>{{x, y, 1}}, cv::Vec3d(), cv::Vec3d(),
                            to_mat(camera.matrix), coefficients_of(camera), seen);
        }
        const Eigen::Vector2d pixel = camera.pixel({x, y});
        EXPECT_NEAR(pixel.x(), seen[0].x, 1e-9);
        EXPECT_NEAR(pixel.y(), seen[0].y, 1e-9);
        EXPECT_LT((camera.direction(pixel) - Eigen::Vector2d(x, y)).norm(), 1e-10);
      }
    }
  }
}

TEST(CameraModel, EndsWhereALensWouldFoldThePicture) {
  EXPECT_NEAR(rig_with({-0.3, 0, 0, 0}, true).left.widest(), std::tan(std::sqrt(1 / 0.9)), 2e-3);
  EXPECT_NEAR(rig_with({0, 0, 0, 0, 0, 1}, false).left.widest(), 1, 2e-3);  // r / (1 + r^2)
}

TEST(ImportRig, ReadsWhatItExports) {
  for (const Lens& lens : kLenses) {
    const Rig rig = rig_with(lens.coefficients, lens.is_fisheye);
    const Rectification rectification = rectify(rig);
    for (const char* const format : {"opencv", "ros"}) {
      if (format == std::string("ros") && lens.coefficients.size() == 12) {
        EXPECT_THAT([&] { export_rig(rig, rectification, format); },
                    ThrowsMessage<std::runtime_error>(HasSubstr("has a prism")));
        continue;
      }
      const ImportedRig found = import_rig(export_rig(rig, rectification, format), {});
      EXPECT_EQ(found.rig.left.distortion, rig.left.distortion);
      EXPECT_EQ(found.rig.left.is_fisheye, lens.is_fisheye);
      EXPECT_TRUE(found.rig.right.matrix.isApprox(rig.right.matrix, 1e-14));
      EXPECT_TRUE(found.rig.rotation.isApprox(rig.rotation, 1e-9));
      EXPECT_TRUE(found.rig.translation.isApprox(rig.translation, 1e-9)) << found.rig.translation;
      EXPECT_TRUE(rectify(found.rig).p2.isApprox(rectification.p2, 1e-7));
    }
  }
}

// A calibration of this program is read as one of OpenCV, its lens model too.
TEST(ImportRig, KeepsTheLensModelOfItsOwnFiles) {
  for (const Lens& lens : kLenses) {
    Calibration made;
    made.imported = {"a file"};
    made.disparities = 80;
    made.rig = rig_with(lens.coefficients, lens.is_fisheye);
    made.rectification = rectify(made.rig);
    const std::string text = calibration_yaml(made);
    for (const Rig& rig : {import_rig({{"rig.yaml", text}}, {}).rig, parse_calibration(text).rig}) {
      EXPECT_EQ(rig.left.is_fisheye, lens.is_fisheye);
      EXPECT_EQ(rig.left.distortion, made.rig.left.distortion);
    }
  }
}

const char* const kNamed = R"({"K_left": [[500, 0, 320], [0, 500, 240], [0, 0, 1]], "dist_left": [0, 0, 0, 0],
  "K_right": [[500, 0, 320], [0, 500, 240], [0, 0, 1]], "dist_right": [-0.1, 0, 0, 0],
  "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "T": [-0.12, 0, 0], "image_size": [640, 480]})";

TEST(ImportRig, TakesTheUsualNamesAndAUnit) {
  ImportOptions options;
  options.unit_mm = 1000;
  const ImportedRig found = import_rig({{"rig.json", kNamed}}, options);
  EXPECT_EQ(found.rig.translation.x(), -120);
  EXPECT_EQ(found.rig.right.distortion[0], -0.1);
  EXPECT_EQ(found.rig.width, 640);
  EXPECT_THAT(
      [] {
        import_rig({{"rig.json", kNamed}}, {});
      },
      ThrowsMessage<std::runtime_error>(HasSubstr("--unit mm, cm or m says")));
}

const std::string kKitti =
    "P0: 700 0 600 0 0 700 170 0 0 0 1 0\nP1: 700 0 600 -378 0 700 170 0 0 0 1 0\n"
    "P2: 700 0 600 42 0 700 170 0 0 0 1 0\nP3: 700 0 600 -329 0 700 170 0 0 0 1 0\n";
const std::string kMiddlebury =
    "cam0=[3000 0 1000; 0 3000 500; 0 0 1]\ncam1=[3000 0 1100; 0 3000 500; 0 0 1]\n"
    "doffs=100\nbaseline=190\nwidth=2000\nheight=1000\nndisp=280\n";

// Depth = focal length x baseline / (disparity + doffs).
TEST(ImportRig, KeepsPicturesThatAreRectifiedAlready) {
  ImportOptions options;
  options.size = {1240, 376};
  options.cameras = {"P2", "P3"};
  const ImportedRig kitti = import_rig({{"calib.txt", kKitti}}, options);
  const ImportedRig middlebury = import_rig({{"calib.txt", kMiddlebury}}, {});
  const auto depth = [](const ImportedRig& rig, double disparity) {
    const Eigen::Vector4d point = rig.rectification.value().q * Eigen::Vector4d(0, 0, disparity, 1);
    return point.z() / point.w();
  };
  EXPECT_NEAR(depth(kitti, 53), 1000 * (42 + 329) / 53.0, 1e-6);
  EXPECT_NEAR(depth(middlebury, 28), 3000 * 190 / 128.0, 1e-6);
  EXPECT_TRUE(middlebury.rectification->r2.isIdentity(0));
}

TEST(ImportRig, RefusesWhatIsNoRig) {
  const auto refused = [](std::string text, const std::string& from, const std::string& to,
                          const ImportOptions& options = {}) {
    const std::size_t at = text.find(from);
    text.replace(at, from.size(), to);
    try {
      import_rig({{"F", text}}, options);
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string("taken");
  };
  EXPECT_THAT(refused(kNamed, "[0, 1, 0], [0, 0, 1]], \"T\"", "[0, 1, 0.2], [0, 0, 1]], \"T\""),
              HasSubstr("'F': R = no rotation: must be a rotation matrix"));
  EXPECT_THAT(refused(kNamed, "[-0.12, 0, 0]", "[120, 0, 0]"), HasSubstr("the cameras are swapped"));
  EXPECT_THAT(refused(kNamed, "[-0.12, 0, 0]", "[0, -120, 0]"), HasSubstr("120.0 mm below the left one"));
  EXPECT_THAT(refused(kNamed, "\"T\"", "\"X\""), HasSubstr("R and T, or R1, R2 and P2: missing"));
  EXPECT_THAT(refused(kNamed, "640", "642"),
              HasSubstr("642x480: a board takes widths that are a multiple of 4"));
  EXPECT_THAT(refused(kNamed, "640", "300"), HasSubstr("in pictures of 300x480: must be inside"));
  EXPECT_THAT(refused(kNamed, "dist_left", "other"), HasSubstr("D1 or distCoeffs1: missing"));
  EXPECT_THAT(refused(kNamed, "[-0.1, 0, 0, 0]", "[-0.1, 0, 0]"), HasSubstr("must be 4, 5, 8 or 12"));
  EXPECT_THAT(refused(kNamed, "[640, 480]", "[0, 480]"), HasSubstr("0x480 pixels: must be 1..2048 each"));
  EXPECT_THAT(refused(kNamed, "image_size", "other"), HasSubstr("must be given by --size WxH"));
  ImportOptions sized;
  sized.size = {320, 240};
  EXPECT_THAT(refused(kNamed, "T", "T", sized), HasSubstr("640x480: must be that of --size"));
  EXPECT_THAT(refused(kMiddlebury, "doffs=100", "doffs=90"), HasSubstr("doffs = 90: must be 100"));
  EXPECT_THAT(refused(kMiddlebury, "500; 0 0 1]\ndoffs", "501; 0 0 1]\ndoffs"),
              HasSubstr("'F': cam1 = another"));
  EXPECT_THAT(refused(kKitti, "P0", "P0", sized), HasSubstr("must be given by --cameras"));
  EXPECT_THAT(refused("a: 1", "a", "a"), HasSubstr("no calibration of a kind that is known"));
}

}  // namespace
}  // namespace stereotlm::calib
