#include "calib/calibration_reader.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "platform/yaml/yaml_tree.h"

namespace stereotlm::calib {
namespace {

using platform::YamlNode;

constexpr const char* kRule = "must be OpenCV FileStorage YAML";

[[noreturn]] void refuse(int line, const std::string& found, const std::string& rule) {
  throw std::runtime_error(fmt::format("line {}: {}: {}", line, found, rule));
}

// Refuses what FileStorage does not write: anchors, aliases, keys that are no texts, and keys that are
// repeated.
void check_tree(const YamlNode& node) {
  if (!node.misuse.empty()) refuse(node.place.line, "an anchor or alias", kRule);
  for (const YamlNode& item : node.items) check_tree(item);
  std::set<std::string> keys;
  for (const auto& [key, value] : node.entries) {
    if (!key.is_scalar()) refuse(key.place.line, "a key that is no text", kRule);
    if (!keys.insert(key.text).second) refuse(key.place.line, key.text, "must be there once");
    check_tree(value);
  }
}

// The map of a FileStorage text.
YamlNode parse_storage(const std::string& text) {
  constexpr const char* kBegin = "%YAML:1.0";
  if (text.rfind(kBegin, 0) != 0)
    refuse(1, "no OpenCV FileStorage", fmt::format("must begin with {}", kBegin));
  if (text.size() > kMostCalibrationBytes)
    throw std::runtime_error(fmt::format("{} bytes: must be {} at most", text.size(), kMostCalibrationBytes));
  try {
    // The first line is no directive of YAML. As a comment it is ignored.
    YamlNode root =
        platform::parse_yaml('#' + text.substr(1), platform::Place::kBoard, platform::Dialect::kOpenCv);
    if (!root.is_map()) refuse(root.place.line, "no map of keys and values", kRule);
    check_tree(root);
    return root;
  } catch (const platform::YamlError& error) {
    refuse(error.place.line, error.what(), kRule);
  }
}

// The value as a number. Nullopt if its text is in quotes, or if a part of the text does not belong to a
// number.
template <typename Number>
std::optional<Number> number_of(const YamlNode& value) {
  Number number = 0;
  const char* const end = value.text.data() + value.text.size();
  const auto [stop, error] = std::from_chars(value.text.data(), end, number);
  if (!value.is_scalar() || value.quoted || error != std::errc() || stop != end) return std::nullopt;
  return number;
}

// Accepts the words that OpenCV writes for numbers that are not finite.
std::optional<double> double_of(const YamlNode& value) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (value.text == ".Inf") return kInfinity;
  if (value.text == "-.Inf") return -kInfinity;
  if (value.text == ".Nan") return std::numeric_limits<double>::quiet_NaN();
  return number_of<double>(value);
}

// Reads a map of the file. `path` precedes the keys in messages.
class Reader {
 public:
  explicit Reader(const YamlNode& map, std::string path = "") : map_(map), path_(std::move(path)) {}

  const YamlNode& at(const std::string& key) const {
    const YamlNode::Entry* const found = map_.find(key);
    if (found == nullptr) {
      throw std::runtime_error(fmt::format("{}{}: missing: a calibration has this key", path_, key));
    }
    return found->value;
  }

  bool has(const std::string& key) const { return map_.find(key) != nullptr; }

  Reader map(const std::string& key) const {
    const YamlNode& found = at(key);
    if (!found.is_map()) refuse(key, "no map", "must be a map");
    return Reader(found, path_ + key + ".");
  }

  const std::vector<YamlNode>& list(const std::string& key) const {
    const YamlNode& found = at(key);
    if (!found.is_list()) refuse(key, "no list", "must be a list");
    return found.items;
  }

  int integer(const std::string& key, int least, int most) const {
    const auto value = number_of<int>(at(key));
    const std::string rule = fmt::format("must be an integer, {}..{}", least, most);
    if (!value) refuse(key, "no integer", rule);
    if (*value < least || *value > most) refuse(key, std::to_string(*value), rule);
    return *value;
  }
  std::size_t count(const std::string& key) const {
    return static_cast<std::size_t>(integer(key, 0, std::numeric_limits<int>::max()));
  }

  double number(const std::string& key) const {
    const auto value = double_of(at(key));
    if (!value) refuse(key, "no number", "must be a number");
    if (!std::isfinite(*value)) refuse(key, fmt::format("{}", *value), "must be finite");
    return *value;
  }

  std::string text(const std::string& key) const {
    const YamlNode& found = at(key);
    if (!found.is_scalar()) refuse(key, "no text", "must be a text");
    return found.text;
  }

  template <typename Matrix>
  Matrix matrix(const std::string& key) const {
    Matrix result;
    const auto rows = static_cast<int>(result.rows());
    const auto columns = static_cast<int>(result.cols());
    const Reader its = map(key);
    const int found_rows = its.integer("rows", 1, std::numeric_limits<int>::max());
    const int found_columns = its.integer("cols", 1, std::numeric_limits<int>::max());
    if (its.text("dt") != "d" || found_rows != rows || found_columns != columns) {
      refuse(key, fmt::format("{}x{} of {}", found_rows, found_columns, its.text("dt")),
             fmt::format("must be {}x{} of d, doubles", rows, columns));
    }
    const std::vector<YamlNode>& data = its.list("data");
    if (data.size() != static_cast<std::size_t>(rows * columns))
      its.refuse("data", fmt::format("{} numbers", data.size()), fmt::format("must be {}", rows * columns));
    for (int i = 0; i < rows * columns; ++i) {
      const YamlNode& item = data[static_cast<std::size_t>(i)];
      const auto value = double_of(item);
      if (!value) its.refuse_at(item.place.line, "data", "no number", "must hold numbers");
      if (!std::isfinite(*value))
        its.refuse_at(item.place.line, "data", "not finite", "must hold finite numbers");
      result(i / columns, i % columns) = *value;
    }
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
    const auto distortion = matrix<Eigen::Matrix<double, 1, 5>>(distortion_key);
    for (std::size_t i = 0; i < camera.distortion.size(); ++i) {
      camera.distortion[i] = distortion(static_cast<Eigen::Index>(i));
    }
    return camera;
  }

  RowError row_error(const std::string& key) const {
    const Reader its = map(key);
    return {its.number("mean_px"), its.number("max_px"), its.count("corners")};
  }

  [[noreturn]] void refuse(const std::string& key, const std::string& found, const std::string& rule) const {
    refuse_at(at(key).place.line, key, found, rule);
  }

 private:
  [[noreturn]] void refuse_at(int line, const std::string& key, const std::string& found,
                              const std::string& rule) const {
    calib::refuse(line, fmt::format("{}{}: {}", path_, key, found), rule);
  }

  const YamlNode& map_;
  std::string path_;
};

// Q as OpenCV's stereoRectify computes it.
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

Rectification rectification_of(const Reader& file) {
  constexpr double kCloseEnough = 1e-9;
  Rectification result = {file.rotation("R1"), file.rotation("R2"), file.matrix<Projection>("P1"),
                          file.matrix<Projection>("P2"), file.matrix<Eigen::Matrix4d>("Q")};
  const Eigen::Matrix4d expected = q_of(result.p1, result.p2);
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

std::vector<Source> sources_of(const Reader& file) {
  std::vector<Source> sources;
  for (const YamlNode& item : file.list("sources")) {
    const Reader source(item, "sources.");
    sources.push_back({source.text("left"), source.text("right"), source.count("corners_used")});
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
  result.rectification = rectification_of(file);
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

Calibration parse_calibration(const std::string& text) {
  const YamlNode root = parse_storage(text);
  return calibration_of(Reader(root));
}

}  // namespace stereotlm::calib
