#include "calib/calibration_yaml.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "calib/opencv_types.h"

namespace stereotlm::calib {
namespace {

// OpenCV's base64 and other forms are not written by us.
constexpr const char* kBegin = "%YAML:1.0";

[[noreturn]] void refuse(const std::string& key, const std::string& found, const std::string& rule) {
  throw std::runtime_error(fmt::format("{}: {}: {}", key, found, rule));
}

// --- writing

void write(cv::FileStorage& file, const char* key, const RowError& error) {
  file << key << "{"
       << "mean_px" << error.mean_px << "max_px" << error.max_px << "corners"
       << static_cast<int>(error.corners) << "}";
}

void write(cv::FileStorage& file, const Quality& quality) {
  file << "quality"
       << "{";
  file << "reprojection_rms_px" << quality.stereo_rms_px;
  file << "left_reprojection_rms_px" << quality.left_rms_px;
  file << "right_reprojection_rms_px" << quality.right_rms_px;
  write(file, "row_error", quality.row_error);
  write(file, "row_error_found_again", quality.found_again);
  if (quality.held_out) {
    file << "held_out_reprojection_rms_px" << quality.held_out->rms_px;
    write(file, "held_out_row_error", quality.held_out->row_error);
  }
  file << "grid_disparity_min_px" << quality.disparities.min;
  file << "grid_disparity_max_px" << quality.disparities.max;
  file << "}";
}

void write(cv::FileStorage& file, const std::vector<Source>& sources) {
  file << "sources"
       << "[";
  for (const Source& source : sources) {
    file << "{"
         << "left" << source.left << "right" << source.right << "corners_used"
         << static_cast<int>(source.corners_used) << "}";
  }
  file << "]";
}

// --- reading

class Reader {
 public:
  explicit Reader(const cv::FileNode& node, std::string path = "") : node_(node), path_(std::move(path)) {}

  cv::FileNode at(const std::string& key) const {
    const cv::FileNode found = node_[key];
    if (found.empty()) refuse(path_ + key, "missing", "a calibration has this key");
    return found;
  }

  Reader map(const std::string& key) const {
    const cv::FileNode found = at(key);
    if (!found.isMap()) refuse(path_ + key, "no map", "must be a map");
    return Reader(found, path_ + key + ".");
  }

  bool has(const std::string& key) const { return !node_[key].empty(); }

  int integer(const std::string& key, int least, int most) const {
    const cv::FileNode found = at(key);
    const std::string rule = fmt::format("must be an integer, {}..{}", least, most);
    if (!found.isInt()) refuse(path_ + key, "no integer", rule);
    const int value = static_cast<int>(found);
    if (value < least || value > most) refuse(path_ + key, std::to_string(value), rule);
    return value;
  }

  double number(const std::string& key) const {
    const cv::FileNode found = at(key);
    if (!found.isReal() && !found.isInt()) refuse(path_ + key, "no number", "must be a number");
    const double value = static_cast<double>(found);
    if (!std::isfinite(value)) refuse(path_ + key, fmt::format("{}", value), "must be finite");
    return value;
  }

  std::string text(const std::string& key) const {
    const cv::FileNode found = at(key);
    if (!found.isString()) refuse(path_ + key, "no text", "must be a text");
    return static_cast<std::string>(found);
  }

  template <typename Matrix>
  Matrix matrix(const std::string& key) const {
    cv::Mat found;
    try {
      at(key) >> found;
      auto result = to_eigen<Matrix>(found);
      if (!result.allFinite()) refuse(path_ + key, "not finite", "must hold finite numbers");
      return result;
    } catch (const std::invalid_argument& error) {
      refuse(path_ + key, "", error.what());
    } catch (const cv::Exception&) {
      refuse(path_ + key, "no matrix", "must be a matrix of doubles");
    }
  }

  Eigen::Matrix3d rotation(const std::string& key) const {
    constexpr double kCloseEnough = 1e-9;
    auto result = matrix<Eigen::Matrix3d>(key);
    const bool is_rotation =
        (result * result.transpose() - Eigen::Matrix3d::Identity()).norm() < kCloseEnough &&
        result.determinant() > 0;
    if (!is_rotation) refuse(path_ + key, "no rotation", "must be a rotation matrix");
    return result;
  }

  CameraModel camera(const std::string& matrix_key, const std::string& distortion_key) const {
    CameraModel camera;
    camera.matrix = matrix<Eigen::Matrix3d>(matrix_key);
    if (!(camera.matrix(0, 0) > 0) || !(camera.matrix(1, 1) > 0) ||
        camera.matrix.row(2) != Eigen::RowVector3d(0, 0, 1)) {
      refuse(path_ + matrix_key, "no camera", "must be [fx 0 cx; 0 fy cy; 0 0 1] with focal lengths above 0");
    }
    const auto distortion = matrix<Eigen::Matrix<double, 1, 5>>(distortion_key);
    for (std::size_t i = 0; i < camera.distortion.size(); ++i) {
      camera.distortion[i] = distortion(static_cast<Eigen::Index>(i));
    }
    return camera;
  }

  RowError row_error(const std::string& key) const {
    const Reader its = map(key);
    return {its.number("mean_px"), its.number("max_px"),
            static_cast<std::size_t>(its.integer("corners", 0, std::numeric_limits<int>::max()))};
  }

 private:
  cv::FileNode node_;
  std::string path_;
};

// Q of OpenCV's stereoRectify.
Eigen::Matrix4d q_of(const Projection& p1, const Projection& p2) {
  const double focal = p1(0, 0);
  const double baseline = -p2(0, 3) / p2(0, 0);
  Eigen::Matrix4d q = Eigen::Matrix4d::Zero();
  q << 1, 0, 0, -p1(0, 2),  //
      0, 1, 0, -p1(1, 2),   //
      0, 0, 0, focal,       //
      0, 0, 1 / baseline, -(p1(0, 2) - p2(0, 2)) / baseline;
  return q;
}

void check_q(const Rectification& rectification) {
  constexpr double kCloseEnough = 1e-9;
  const Eigen::Matrix4d expected = q_of(rectification.p1, rectification.p2);
  if ((rectification.q - expected).norm() <= kCloseEnough * expected.norm()) return;
  refuse("Q", "another matrix", "must be what follows from P1 and P2");
}

Quality quality_of(const Reader& file) {
  Quality quality;
  quality.stereo_rms_px = file.number("reprojection_rms_px");
  quality.left_rms_px = file.number("left_reprojection_rms_px");
  quality.right_rms_px = file.number("right_reprojection_rms_px");
  quality.row_error = file.row_error("row_error");
  quality.found_again = file.row_error("row_error_found_again");
  if (file.has("held_out_row_error")) {
    quality.held_out =
        HeldOut{file.number("held_out_reprojection_rms_px"), file.row_error("held_out_row_error")};
  }
  quality.disparities = {file.number("grid_disparity_min_px"), file.number("grid_disparity_max_px")};
  return quality;
}

std::vector<Source> sources_of(const Reader& file) {
  std::vector<Source> sources;
  const cv::FileNode list = file.at("sources");
  if (!list.isSeq()) refuse("sources", "no list", "must be a list");
  for (const cv::FileNode& node : list) {
    const Reader source(node, "sources.");
    sources.push_back(
        {source.text("left"), source.text("right"),
         static_cast<std::size_t>(source.integer("corners_used", 0, std::numeric_limits<int>::max()))});
  }
  return sources;
}

Calibration calibration_of(const Reader& file) {
  constexpr int kMostPixels = 2048;
  Calibration result;
  result.rig.width = file.integer("image_width", 1, kMostPixels);
  result.rig.height = file.integer("image_height", 1, kMostPixels);
  result.disparity_offset = file.integer("disparity_offset", -kMostPixels, kMostPixels);
  result.disparities = file.integer("disparities", 1, 254);
  result.rig.left = file.camera("M1", "D1");
  result.rig.right = file.camera("M2", "D2");
  result.rig.rotation = file.rotation("R");
  result.rig.translation = file.matrix<Eigen::Vector3d>("T");
  result.rectification = {file.rotation("R1"), file.rotation("R2"), file.matrix<Projection>("P1"),
                          file.matrix<Projection>("P2"), file.matrix<Eigen::Matrix4d>("Q")};
  check_q(result.rectification);
  result.left_lut_sha256 = file.text("left_lut_sha256");
  result.right_lut_sha256 = file.text("right_lut_sha256");
  const Reader grid = file.map("grid");
  result.grid = {grid.integer("columns", 1, kMostPixels), grid.integer("rows", 1, kMostPixels),
                 grid.number("square_mm")};
  result.sources = sources_of(file);
  result.quality = quality_of(file.map("quality"));
  return result;
}

}  // namespace

std::string calibration_yaml(const Calibration& calibration) {
  cv::FileStorage file(".yaml",
                       cv::FileStorage::WRITE | cv::FileStorage::MEMORY | cv::FileStorage::FORMAT_YAML);
  const Rig& rig = calibration.rig;
  const Rectification& rectification = calibration.rectification;
  file << "image_width" << rig.width << "image_height" << rig.height;
  file << "disparities" << calibration.disparities << "disparity_offset" << calibration.disparity_offset;
  file << "left_lut_sha256" << calibration.left_lut_sha256;
  file << "right_lut_sha256" << calibration.right_lut_sha256;
  file << "M1" << to_mat(rig.left.matrix) << "D1" << to_mat(rig.left.distortion);
  file << "M2" << to_mat(rig.right.matrix) << "D2" << to_mat(rig.right.distortion);
  file << "R" << to_mat(rig.rotation) << "T" << to_mat(rig.translation);
  file << "R1" << to_mat(rectification.r1) << "R2" << to_mat(rectification.r2);
  file << "P1" << to_mat(rectification.p1) << "P2" << to_mat(rectification.p2) << "Q"
       << to_mat(rectification.q);
  file << "grid"
       << "{"
       << "columns" << calibration.grid.columns << "rows" << calibration.grid.rows << "square_mm"
       << calibration.grid.square_mm << "}";
  write(file, calibration.sources);
  write(file, calibration.quality);
  return file.releaseAndGetString();
}

Calibration parse_calibration(const std::string& text) {
  if (text.compare(0, std::string(kBegin).size(), kBegin) != 0) {
    refuse("first line", "another", fmt::format("must be {}", kBegin));
  }
  cv::FileStorage file;
  try {
    file.open(text, cv::FileStorage::READ | cv::FileStorage::MEMORY | cv::FileStorage::FORMAT_YAML);
    if (!file.isOpened()) refuse("text", "not readable", "must be OpenCV FileStorage YAML");
    return calibration_of(Reader(file.root()));
  } catch (const cv::Exception& error) {
    // OpenCV 4.6 says in `func` what its parser objects to: "name(line): why".
    const std::size_t place = error.func.find('(');
    const std::string what = place == std::string::npos ? error.err : "line " + error.func.substr(place);
    throw std::runtime_error(what + ": must be OpenCV FileStorage YAML");
  }
}

}  // namespace stereotlm::calib
