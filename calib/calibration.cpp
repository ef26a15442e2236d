#include "calib/calibration.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "models/kernels/limits.h"

namespace stereotlm::calib {
namespace {

constexpr const char* kBegin = "%YAML:1.0";

int line_of(const YAML::Mark& mark) { return mark.is_null() ? 1 : mark.line + 1; }

[[noreturn]] void refuse_line(int line, const std::string& found, const std::string& rule) {
  throw std::runtime_error(fmt::format("line {}: {}: {}", line, found, rule));
}

// Reads a map of the file. `path` precedes the keys in messages.
class Reader {
 public:
  explicit Reader(const YAML::Node& map, std::string path = "") : map_(map), path_(std::move(path)) {
    if (!map_.IsMap())
      refuse_line(line_of(map_.Mark()), path_ + "no map", "must be a map of keys and values");
    std::set<std::string> keys;
    for (const auto& entry : map_) {
      const YAML::Node& key = entry.first;
      if (!key.IsScalar()) refuse_line(line_of(key.Mark()), path_ + "a key", "must be a text");
      if (!keys.insert(key.Scalar()).second)
        refuse_line(line_of(key.Mark()), path_ + key.Scalar(), "must be there once");
    }
  }

  YAML::Node at(const std::string& key) const {
    const YAML::Node found = map_[key];
    if (!found)
      throw std::runtime_error(fmt::format("{}{}: missing: a calibration has this key", path_, key));
    return found;
  }

  bool has(const std::string& key) const { return map_[key].IsDefined(); }

  Reader map(const std::string& key) const { return Reader(at(key), path_ + key + "."); }

  std::vector<Reader> maps(const std::string& key) const {
    const YAML::Node list = at(key);
    if (!list.IsSequence()) refuse(key, "no list", "must be a list");
    std::vector<Reader> result;
    for (const YAML::Node& item : list) result.emplace_back(item, path_ + key + ".");
    return result;
  }

  static constexpr int kMost = std::numeric_limits<int>::max();

  int integer(const std::string& key, int least, int most) const {
    const std::string rule = fmt::format("must be an integer, {}..{}", least, most);
    const int value = as<int>(key, "no integer", rule);
    if (value < least || value > most) refuse(key, std::to_string(value), rule);
    return value;
  }
  std::size_t count(const std::string& key) const { return static_cast<std::size_t>(integer(key, 0, kMost)); }

  double number(const std::string& key) const {
    const auto value = as<double>(key, "no number", "must be a number");
    if (!std::isfinite(value)) refuse(key, fmt::format("{}", value), "must be finite");
    return value;
  }

  std::string text(const std::string& key) const {
    const YAML::Node found = at(key);
    if (!found.IsScalar()) refuse(key, "no text", "must be a text");
    return found.Scalar();
  }

  std::vector<std::string> texts(const std::string& key) const {
    return as<std::vector<std::string>>(key, "no list of texts", "must be a list of texts");
  }

  template <typename Matrix>
  Matrix matrix(const std::string& key) const {
    constexpr int rows = Matrix::RowsAtCompileTime;
    constexpr int columns = Matrix::ColsAtCompileTime;
    const Reader its = map(key);
    const int found_rows = its.integer("rows", 1, kMost);
    const int found_columns = its.integer("cols", 1, kMost);
    if (its.text("dt") != "d" || found_rows != rows || found_columns != columns) {
      refuse(key, fmt::format("{}x{} of {}", found_rows, found_columns, its.text("dt")),
             fmt::format("must be {}x{} of d, doubles", rows, columns));
    }
    const auto data = its.as<std::vector<double>>("data", "no numbers", "must hold numbers");
    if (data.size() != static_cast<std::size_t>(rows * columns))
      its.refuse("data", fmt::format("{} numbers", data.size()), fmt::format("must be {}", rows * columns));
    const Matrix result = Eigen::Map<const Eigen::Matrix<double, columns, rows>>(data.data()).transpose();
    if (!result.allFinite()) its.refuse("data", "not finite", "must hold finite numbers");
    return result;
  }

  Eigen::Matrix3d rotation(const std::string& key) const {
    constexpr double kCloseEnough = 1e-9;
    auto result = matrix<Eigen::Matrix3d>(key);
    const bool is_rotation =
        (result * result.transpose() - Eigen::Matrix3d::Identity()).norm() < kCloseEnough &&
        result.determinant() > 0;
    if (!is_rotation) refuse(key, "no rotation", "must be a rotation matrix");
    return result;
  }

  CameraModel camera(const std::string& matrix_key, const std::string& distortion_key) const {
    CameraModel camera;
    camera.matrix = matrix<Eigen::Matrix3d>(matrix_key);
    if (!(camera.matrix(0, 0) > 0) || !(camera.matrix(1, 1) > 0) ||
        camera.matrix.row(2) != Eigen::RowVector3d(0, 0, 1)) {
      refuse(matrix_key, "no camera", "must be [fx 0 cx; 0 fy cy; 0 0 1] with focal lengths above 0");
    }
    const int count = map(distortion_key).integer("cols", 1, kMost);
    camera.is_fisheye = count == 4;
    if (count == 4)
      set_distortion<4>(camera, distortion_key);
    else if (count == 8)
      set_distortion<8>(camera, distortion_key);
    else if (count == 12)
      set_distortion<12>(camera, distortion_key);
    else
      set_distortion<5>(camera, distortion_key);
    return camera;
  }

  // Of a grid. Earlier files, of chessboards, have no such key.
  Pattern pattern() const {
    if (!has("pattern")) return Pattern::kChessboard;
    const auto found = pattern_named(text("pattern"));
    if (!found)
      refuse("pattern", text("pattern"), fmt::format("must be one of {}", fmt::join(kPatternNames, ", ")));
    return *found;
  }

  RowError row_error(const std::string& key) const {
    const Reader its = map(key);
    return {its.number("mean_px"), its.number("max_px"), its.count("corners")};
  }

  [[noreturn]] void refuse(const std::string& key, const std::string& found, const std::string& rule) const {
    refuse_line(line_of(at(key).Mark()), fmt::format("{}{}: {}", path_, key, found), rule);
  }

 private:
  template <int kCount>
  void set_distortion(CameraModel& camera, const std::string& key) const {
    const auto found = matrix<Eigen::Matrix<double, 1, kCount>>(key);
    std::copy_n(found.data(), kCount, camera.distortion.begin());
  }

  template <typename Value>
  Value as(const std::string& key, const std::string& found, const std::string& rule) const {
    try {
      return at(key).as<Value>();
    } catch (const YAML::BadConversion& /*error*/) {
      refuse(key, found, rule);
    }
  }

  YAML::Node map_;
  std::string path_;
};

Rectification rectification_of(const Reader& file) {
  constexpr double kCloseEnough = 1e-9;
  Rectification result = {file.rotation("R1"), file.rotation("R2"), file.matrix<Projection>("P1"),
                          file.matrix<Projection>("P2"), file.matrix<Eigen::Matrix4d>("Q")};
  const Eigen::Matrix4d expected = disparity_to_depth(result.p1, result.p2);
  if (!((result.q - expected).norm() <= kCloseEnough * expected.norm()))
    file.refuse("Q", "another matrix", "must be what follows from P1 and P2");
  return result;
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

Certainty certainty_of(const Reader& file) {
  Certainty its;
  its.alone_rms_px = file.number("alone_rms_px");
  its.rig_rms_px = file.number("rig_rms_px");
  its.has_fixed_intrinsics = file.integer("has_fixed_intrinsics", 0, 1) == 1;
  its.focal_sigma_px = file.number("focal_sigma_px");
  its.centre_sigma_px = file.number("centre_sigma_px");
  its.baseline_sigma_mm = file.number("baseline_sigma_mm");
  its.turn_sigma_deg = file.number("turn_sigma_deg");
  its.tilt_deg = file.number("tilt_deg");
  for (const Reader& depth : file.maps("depth_errors"))
    its.depths.push_back(
        {depth.number("depth_mm"), depth.number("rounding_mm"), depth.number("calibration_mm")});
  return its;
}

std::vector<Source> sources_of(const Reader& file) {
  std::vector<Source> sources;
  for (const Reader& source : file.maps("sources"))
    sources.push_back({source.text("left"), source.text("right"), source.count("corners_used")});
  return sources;
}

Calibration calibration_of(const Reader& file) {
  constexpr int kMostPixels = 2048;
  Calibration result;
  result.rig.width = file.integer("image_width", 1, kMostPixels);
  result.rig.height = file.integer("image_height", 1, kMostPixels);
  result.disparity_offset = file.integer("disparity_offset", -kMostPixels, kMostPixels);
  result.disparities = file.integer("disparities", 1, kernels::kDisparitiesRule.max);
  result.rig.left = file.camera("M1", "D1");
  result.rig.right = file.camera("M2", "D2");
  result.rig.rotation = file.rotation("R");
  result.rig.translation = file.matrix<Eigen::Vector3d>("T");
  result.rectification = rectification_of(file);
  result.left_lut_sha256 = file.text("left_lut_sha256");
  result.right_lut_sha256 = file.text("right_lut_sha256");
  if (file.has("imported")) {
    result.imported = file.texts("imported");
    return result;
  }
  const Reader grid = file.map("grid");
  result.grid = {grid.integer("columns", 1, kMostPixels), grid.integer("rows", 1, kMostPixels),
                 grid.number("square_mm"), grid.pattern()};
  result.sources = sources_of(file);
  result.quality = quality_of(file.map("quality"));
  if (file.has("certainty")) result.certainty = certainty_of(file.map("certainty"));
  return result;
}

}  // namespace

GridPair rectified(const Rig& rig, const Rectification& rectification, const GridPair& pair) {
  GridPair result;
  for (const Eigen::Vector2d& corner : pair.left)
    result.left.push_back(rectified_pixel(rig.left, rectification.r1, rectification.p1, corner));
  for (const Eigen::Vector2d& corner : pair.right)
    result.right.push_back(rectified_pixel(rig.right, rectification.r2, rectification.p2, corner));
  return result;
}

RowError row_error(const std::vector<double>& distances) {
  RowError error{0, 0, distances.size()};
  for (const double distance : distances) {
    error.mean_px += std::abs(distance);
    error.max_px = std::max(error.max_px, std::abs(distance));
  }
  if (!distances.empty()) error.mean_px /= static_cast<double>(distances.size());
  return error;
}

int DisparityRange::needed() const {
  return static_cast<int>(std::ceil(max)) - static_cast<int>(std::floor(min)) + 1;
}

int disparity_offset_for(const DisparityRange& range, int disparities) {
  const int least = static_cast<int>(std::floor(range.min));
  const int room = disparities - range.needed();
  constexpr int kMost = kernels::kDisparitiesRule.max;
  if (range.needed() > kMost) {
    throw std::invalid_argument(
        fmt::format("refused: the grid's disparities are {}..{}, and a board has {} at most: turn the "
                    "cameras parallel, or "
                    "photograph the grid farther away",
                    least, least + range.needed() - 1, kMost));
  }
  if (room < 0) {
    throw std::invalid_argument(
        fmt::format("--disparities = {}: must be {} or more for the grid's own, {}..{}; or "
                    "--disparity-offset N, for a part of them",
                    disparities, range.needed(), least, least + range.needed() - 1));
  }
  return std::min(least, std::max(0, least - room / 2));
}

Calibration parse_calibration(const std::string& text) {
  if (text.rfind(kBegin, 0) != 0)
    refuse_line(1, "no OpenCV FileStorage", fmt::format("must begin with {}", kBegin));
  if (text.size() > kMostCalibrationBytes)
    throw std::runtime_error(fmt::format("{} bytes: must be {} at most", text.size(), kMostCalibrationBytes));
  try {
    // The first line is no directive of YAML.
    const std::vector<YAML::Node> documents = YAML::LoadAll('#' + text);
    if (documents.size() != 1) refuse_line(1, fmt::format("{} documents", documents.size()), "must be one");
    return calibration_of(Reader(documents.front()));
  } catch (const YAML::Exception& error) {
    refuse_line(line_of(error.mark), error.msg, "must be OpenCV FileStorage YAML");
  }
}

}  // namespace stereotlm::calib
