#include "calib/import_rig.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <map>
#include <opencv2/core.hpp>
#include <sstream>
#include <stdexcept>

#include "calib/opencv_conversions.h"

namespace stereotlm::calib {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kMostPixels = 2048;  // of a side of a picture with a table

// A value of a file: its numbers, row by row, or its text.
struct Field {
  std::string place;  // of the file, as messages name it
  std::string name;   // as the file has it
  std::vector<double> numbers;
  std::string text;
};

// A field's name, without case and underscores, with the names of the maps that hold it before it.
using Fields = std::map<std::string, Field>;

[[noreturn]] void refuse(const Field& field, const std::string& found, const std::string& rule) {
  throw std::runtime_error(fmt::format("'{}': {} = {}: {}", field.place, field.name, found, rule));
}

std::string plain(const std::string& name) {
  std::string result;
  for (const char each : name) {
    if (each != '_' && each != ' ' && each != '-')
      result += static_cast<char>(std::tolower(static_cast<unsigned char>(each)));
  }
  return result;
}

std::optional<double> number_of(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return text.empty() || end != text.c_str() + text.size() ? std::nullopt : std::optional(value);
}

void add(Fields& fields, const Field& field) {
  const auto [known, is_new] = fields.emplace(plain(field.name), field);
  if (is_new || (known->second.numbers == field.numbers && known->second.text == field.text)) return;
  refuse(field, "another value", fmt::format("must be that of '{}'", known->second.place));
}

void add(Fields& fields, const std::string& place, const std::string& name, const YAML::Node& node) {
  Field field{place, name, {}, {}};
  const auto add_numbers = [&field](const auto& self, const YAML::Node& each) -> void {
    if (each.IsSequence()) {
      for (const YAML::Node& item : each) self(self, item);
    } else if (each.IsScalar()) {
      if (const auto value = number_of(each.Scalar())) field.numbers.push_back(*value);
      field.text = each.Scalar();
    }
  };
  if (node.IsMap()) {
    for (const auto& entry : node) {
      const std::string key = entry.first.Scalar();
      const bool is_matrix = key == "data";  // of the map that is the matrix
      add(fields, place, is_matrix ? name : name.empty() ? key : name + '.' + key, entry.second);
    }
    return;
  }
  add_numbers(add_numbers, node);
  add(fields, field);
}

void add(Fields& fields, const std::string& place, const std::string& name, const cv::FileNode& node) {
  Field field{place, name, {}, {}};
  if (node.isMap() && !node["data"].empty()) {
    cv::Mat matrix;
    node >> matrix;
    matrix.convertTo(matrix, CV_64F);
    field.numbers.assign(matrix.begin<double>(), matrix.end<double>());
  } else if (node.isSeq()) {
    for (const cv::FileNode& item : node) {
      if (item.isInt() || item.isReal()) field.numbers.push_back(item.real());
    }
  } else if (node.isInt() || node.isReal()) {
    field.numbers.push_back(node.real());
  } else if (node.isString()) {
    field.text = node.string();
  }
  add(fields, field);
}

// Of a text whose lines are `name=values` or `name: values`.
void add_lines(Fields& fields, const ForeignFile& file) {
  std::istringstream lines(file.text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t end = line.find_first_of("=:");
    if (end == std::string::npos) continue;
    Field field{file.path, line.substr(0, end), {}, line.substr(end + 1)};
    std::string values = field.text;
    std::replace_if(
        values.begin(), values.end(), [](char c) { return c == '[' || c == ']' || c == ';'; }, ' ');
    std::istringstream words(values);
    for (std::string word; words >> word;) {
      if (const auto value = number_of(word)) field.numbers.push_back(*value);
    }
    fields.emplace(plain(field.name), field);
  }
}

bool begins_with(const std::string& text, const char* beginning) { return text.rfind(beginning, 0) == 0; }

Fields fields_of(const ForeignFile& file) {
  Fields fields;
  try {
    if (begins_with(file.text, "<?xml")) {
      const cv::FileStorage storage(file.text, cv::FileStorage::READ | cv::FileStorage::MEMORY);
      for (const cv::FileNode& node : storage.root()) add(fields, file.path, node.name(), node);
      return fields;
    }
    // The first line of OpenCV is no directive of YAML.
    const bool is_opencv = begins_with(file.text, "%YAML:");
    const std::vector<YAML::Node> documents = YAML::LoadAll((is_opencv ? "#" : "") + file.text);
    if (!documents.empty() && documents.front().IsMap()) {
      add(fields, file.path, "", documents.front());
      if (fields.count("cam0") == 0 && fields.count("p0") == 0 && fields.count("prect00") == 0) return fields;
      fields.clear();  // lines that look like YAML
    }
  } catch (const YAML::Exception&) {
    fields.clear();
  } catch (const cv::Exception& error) {
    throw std::runtime_error(fmt::format("'{}': {}", file.path, error.err));
  }
  add_lines(fields, file);
  return fields;
}

// The fields of some files that make one rig.
class Reader {
 public:
  Reader(Fields fields, std::string files) : fields_(std::move(fields)), files_(std::move(files)) {}

  // The first of these names that is there; null if none is.
  const Field* find(const std::vector<std::string>& names) const {
    for (const std::string& name : names) {
      if (const auto found = fields_.find(name); found != fields_.end()) return &found->second;
    }
    return nullptr;
  }
  const Field& at(const std::vector<std::string>& names, const std::string& what) const {
    if (const Field* const found = find(names)) return *found;
    refuse(what + ": missing");
  }
  [[noreturn]] void refuse(const std::string& problem) const {
    throw std::runtime_error(fmt::format("'{}': {}", files_, problem));
  }

 private:
  Fields fields_;
  std::string files_;  // as messages name them
};

template <int kRows, int kColumns>
Eigen::Matrix<double, kRows, kColumns> matrix_of(const Field& field) {
  if (field.numbers.size() != std::size_t{kRows * kColumns})
    refuse(field, fmt::format("{} numbers", field.numbers.size()),
           fmt::format("must be {}x{}", kRows, kColumns));
  Eigen::Matrix<double, kRows, kColumns> result;
  for (int i = 0; i < kRows * kColumns; ++i)
    result(i / kColumns, i % kColumns) = field.numbers[std::size_t(i)];
  if (!result.allFinite()) refuse(field, "not finite", "must hold finite numbers");
  return result;
}

// A rotation that a file has with a few digits, made exact.
Matrix3d rotation_of(const Field& field) {
  constexpr double kCloseEnough = 1e-3;
  const Matrix3d found = matrix_of<3, 3>(field);
  const Eigen::JacobiSVD<Matrix3d> svd(found, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Matrix3d rotation = svd.matrixU() * svd.matrixV().transpose();
  if ((found - rotation).norm() > kCloseEnough || rotation.determinant() < 0)
    refuse(field, "no rotation", "must be a rotation matrix");
  return rotation;
}

Matrix3d camera_matrix_of(const Field& field) {
  const Matrix3d result = matrix_of<3, 3>(field);
  if (!(result(0, 0) > 0 && result(1, 1) > 0) || result(0, 1) != 0 || result(1, 0) != 0 ||
      result.row(2) != Eigen::RowVector3d(0, 0, 1))
    refuse(field, "no camera", "must be [fx 0 cx; 0 fy cy; 0 0 1] with focal lengths above 0");
  return result;
}

void set_distortion(CameraModel& camera, const Field& field, bool is_fisheye) {
  const std::size_t count = field.numbers.size();
  camera.is_fisheye = is_fisheye;
  const bool is_tilted =
      std::any_of(field.numbers.begin() + static_cast<long>(std::min<std::size_t>(count, 12)),
                  field.numbers.end(), [](double each) { return each != 0; });
  if (is_tilted ||
      (is_fisheye ? count != 4
                  : count != 0 && count != 4 && count != 5 && count != 8 && count != 12 && count != 14))
    refuse(field, fmt::format("{} coefficients", count),
           is_fisheye ? "a fisheye lens has 4" : "must be 4, 5, 8 or 12, and those of a tilt 0");
  std::copy_n(field.numbers.begin(), std::min<std::size_t>(count, 12), camera.distortion.begin());
}

// Whether the text names a fisheye lens, or nothing if it names none. Throws if it names another one.
bool is_fisheye_model(const Field& field) {
  const std::string model = plain(field.text);
  if (model == "equidistant" || model == "fisheye" || model == "kannalabrandt4") return true;
  if (model == "plumbbob" || model == "radtan" || model == "rationalpolynomial" || model == "none" ||
      model.empty())
    return false;
  refuse(field, field.text, "must be plumb_bob, rational_polynomial, radtan, equidistant, fisheye or none");
}

void set_size(const Reader& reader, const ImportOptions& options, Rig& rig) {
  const Field* const both = reader.find({"imagesize", "size", "cam0.resolution", "resolution", "srect00"});
  const Field* const width = reader.find({"imagewidth", "width"});
  const Field* const height = reader.find({"imageheight", "height"});
  std::optional<std::pair<double, double>> size;
  const Field* place = both;
  if (both != nullptr && both->numbers.size() == 2) {
    size = {both->numbers[0], both->numbers[1]};
  } else if (width != nullptr && height != nullptr && !width->numbers.empty() && !height->numbers.empty()) {
    size = {width->numbers[0], height->numbers[0]};
    place = width;
  }
  if (!size && !options.size)
    reader.refuse("the size of the pictures is not in it: must be given by --size WxH");
  const auto is_length = [](double pixels) {
    return pixels >= 1 && pixels <= kMostPixels && pixels == std::floor(pixels);
  };
  if (size && !(is_length(size->first) && is_length(size->second)))
    refuse(*place, fmt::format("{:g}x{:g} pixels", size->first, size->second), "must be 1..2048 each");
  if (size && options.size && *size != std::pair<double, double>(*options.size))
    refuse(*place, fmt::format("{}x{}", size->first, size->second), "must be that of --size");
  rig.width = options.size ? options.size->first : static_cast<int>(size->first);
  rig.height = options.size ? options.size->second : static_cast<int>(size->second);
}

struct Side {
  const char* number;  // in OpenCV's names
  const char* word;
  const char* letter;
};
constexpr Side kLeft = {"1", "left", "l"};
constexpr Side kRight = {"2", "right", "r"};

// The usual names of one of a pair's matrices.
std::vector<std::string> names_of(const std::vector<std::string>& bases, const Side& side) {
  std::vector<std::string> names;
  for (const std::string& base : bases) {
    for (const char* const each : {side.number, side.word, side.letter}) {
      names.push_back(base + each);
      if (each != side.number) names.push_back(each + base);
    }
  }
  return names;
}

const std::vector<std::string> kMatrices = {"m", "k", "cameramatrix", "intrinsics", "mtx"};
const std::vector<std::string> kCoefficients = {"d", "distcoeffs", "distortion", "distortioncoefficients",
                                                "dist"};

// R and T of a rig from the rectifications of its cameras.
void set_place(const Matrix3d& r1, const Matrix3d& r2, const Projection& p2, Rig& rig) {
  rig.rotation = r2.transpose() * r1;
  rig.translation = r2.transpose() * Vector3d(p2(0, 3) / p2(0, 0), 0, 0);
}

ImportedRig import_opencv(const Reader& reader, const ImportOptions& options) {
  ImportedRig result{"OpenCV", {}, {}};
  set_size(reader, options, result.rig);
  const Field* const model = reader.find({"distortionmodel", "lensmodel", "fisheye"});
  const bool says_fisheye =
      model != nullptr && (model->numbers.empty() ? is_fisheye_model(*model) : model->numbers.front() != 0);
  const auto set_camera = [&](const Side& side, CameraModel& camera) {
    camera.matrix = camera_matrix_of(
        reader.at(names_of(kMatrices, side), fmt::format("M{0}, K{0} or cameraMatrix{0}", side.number)));
    set_distortion(
        camera, reader.at(names_of(kCoefficients, side), fmt::format("D{0} or distCoeffs{0}", side.number)),
        options.is_fisheye.value_or(says_fisheye));
  };
  set_camera(kLeft, result.rig.left);
  set_camera(kRight, result.rig.right);
  const Field* const rotation = reader.find({"r", "rotation", "rotationmatrix", "stereor"});
  const Field* const translation = reader.find({"t", "translation", "translationvector", "stereot"});
  if (rotation != nullptr && translation != nullptr) {
    result.rig.rotation = rotation_of(*rotation);
    result.rig.translation = matrix_of<3, 1>(*translation);
  } else {
    const char* const what = "R and T, or R1, R2 and P2";
    set_place(rotation_of(reader.at({"r1"}, what)), rotation_of(reader.at({"r2"}, what)),
              matrix_of<3, 4>(reader.at({"p2"}, what)), result.rig);
  }
  result.rig.translation *= options.unit_mm.value_or(1);
  return result;
}

ImportedRig import_ros(const std::vector<Reader>& cameras, const ImportOptions& options) {
  constexpr double kMillimetres = 1000;
  if (cameras.size() != 2) cameras.front().refuse("a rig of ROS has two camera_info: --import LEFT RIGHT");
  ImportedRig result{"ROS camera_info", {}, {}};
  std::array<Matrix3d, 2> rotations;
  std::array<Projection, 2> projections;
  for (std::size_t i = 0; i < 2; ++i) {
    const Reader& reader = cameras[i];
    Rig size;
    set_size(reader, options, size);
    if (i == 1 && (size.width != result.rig.width || size.height != result.rig.height))
      reader.refuse(fmt::format("{}x{} pixels: must be {}x{}, as the left camera has", size.width,
                                size.height, result.rig.width, result.rig.height));
    result.rig.width = size.width;
    result.rig.height = size.height;
    CameraModel& camera = i == 0 ? result.rig.left : result.rig.right;
    camera.matrix = camera_matrix_of(reader.at({"cameramatrix", "k"}, "camera_matrix"));
    const Field& model = reader.at({"distortionmodel"}, "distortion_model");
    set_distortion(camera, reader.at({"distortioncoefficients", "d"}, "distortion_coefficients"),
                   is_fisheye_model(model));
    rotations[i] = rotation_of(reader.at({"rectificationmatrix", "r"}, "rectification_matrix"));
    const Field& projection = reader.at({"projectionmatrix", "p"}, "projection_matrix");
    projections[i] = matrix_of<3, 4>(projection);
    if (i == 0 && projections[0](0, 3) != 0)
      refuse(projection, fmt::format("{} at row 1, column 4", projections[0](0, 3)),
             "must be 0 for the left camera, which is the first file");
  }
  set_place(rotations[0], rotations[1], projections[1], result.rig);
  result.rig.translation *= options.unit_mm.value_or(kMillimetres);
  return result;
}

ImportedRig import_kalibr(const Reader& reader, const ImportOptions& options) {
  constexpr double kMillimetres = 1000;
  ImportedRig result{"Kalibr camchain", {}, {}};
  set_size(reader, options, result.rig);
  for (const std::string name : {"cam0", "cam1"}) {
    CameraModel& camera = name == "cam0" ? result.rig.left : result.rig.right;
    const auto field = [&](const char* key) -> const Field& {
      return reader.at({name + '.' + plain(key)}, name + '.' + key);
    };
    if (const Field& model = field("camera_model"); model.text != "pinhole")
      refuse(model, model.text, "must be pinhole");
    const Field& resolution = field("resolution");
    if (resolution.numbers != std::vector<double>{double(result.rig.width), double(result.rig.height)})
      refuse(resolution, fmt::format("{}", fmt::join(resolution.numbers, "x")), "must be that of cam0");
    const auto intrinsics = matrix_of<4, 1>(field("intrinsics"));
    camera.matrix << intrinsics[0], 0, intrinsics[2], 0, intrinsics[1], intrinsics[3], 0, 0, 1;
    set_distortion(camera, field("distortion_coeffs"), is_fisheye_model(field("distortion_model")));
  }
  const Field& place = reader.at({"cam1.tcncnm1"}, "cam1.T_cn_cnm1");
  const Eigen::Matrix4d pose = matrix_of<4, 4>(place);
  Field rotation = place;
  rotation.numbers.clear();
  for (int i = 0; i < 9; ++i) rotation.numbers.push_back(pose(i / 3, i % 3));
  result.rig.rotation = rotation_of(rotation);
  result.rig.translation = pose.block<3, 1>(0, 3) * options.unit_mm.value_or(kMillimetres);
  return result;
}

// A rig whose pictures are rectified already: its cameras are those of the rectified pictures.
void set_rectified(const Matrix3d& left, const Matrix3d& right, double baseline_mm, ImportedRig& result) {
  result.rig.left.matrix = left;
  result.rig.right.matrix = right;
  result.rig.translation = {-baseline_mm, 0, 0};
  Rectification& made = result.rectification.emplace();
  made.p1.leftCols<3>() = left;
  made.p2.leftCols<3>() = right;
  made.p2(0, 3) = -baseline_mm * right(0, 0);
  made.q = disparity_to_depth(made.p1, made.p2);
}

// Whether the cameras are those of pictures that are rectified already.
bool is_rectified(const Rig& rig) {
  const auto is_straight = [](const CameraModel& camera) {
    return std::all_of(camera.distortion.begin(), camera.distortion.end(),
                       [](double each) { return each == 0; });
  };
  const Matrix3d& left = rig.left.matrix;
  const Matrix3d& right = rig.right.matrix;
  return is_straight(rig.left) && is_straight(rig.right) && !rig.left.is_fisheye &&
         rig.rotation.isIdentity(0) && rig.translation.y() == 0 && rig.translation.z() == 0 &&
         left(0, 0) == right(0, 0) && left(1, 1) == right(1, 1) && left(1, 2) == right(1, 2);
}

void check_same_rows(const Field& field, const Matrix3d& left, const Matrix3d& right) {
  if (left(0, 0) != right(0, 0) || left(1, 1) != right(1, 1) || left(1, 2) != right(1, 2))
    refuse(field, "another focal length or centre row than the other camera",
           "must be equal in pictures that are rectified");
}

ImportedRig import_middlebury(const Reader& reader, const ImportOptions& options) {
  ImportedRig result{"Middlebury calib.txt", {}, {}};
  set_size(reader, options, result.rig);
  const Field& right_field = reader.at({"cam1"}, "cam1");
  const Matrix3d left = camera_matrix_of(reader.at({"cam0"}, "cam0"));
  const Matrix3d right = camera_matrix_of(right_field);
  check_same_rows(right_field, left, right);
  const double baseline = matrix_of<1, 1>(reader.at({"baseline"}, "baseline"))(0);
  if (const Field* const doffs = reader.find({"doffs"})) {
    constexpr double kCloseEnough = 1e-2;
    if (std::abs(matrix_of<1, 1>(*doffs)(0) - (right(0, 2) - left(0, 2))) > kCloseEnough)
      refuse(
          *doffs, doffs->text,
          fmt::format("must be {}, the distance of the centres of cam0 and cam1", right(0, 2) - left(0, 2)));
  }
  set_rectified(left, right, baseline * options.unit_mm.value_or(1), result);
  return result;
}

ImportedRig import_kitti(const Reader& reader, const ImportOptions& options) {
  constexpr double kMillimetres = 1000;
  ImportedRig result{"KITTI calib.txt", {}, {}};
  set_size(reader, options, result.rig);
  if (!options.cameras)
    reader.refuse("several cameras: two must be given by --cameras, such as P0,P1 (grey) or P2,P3 (colour)");
  const auto projection = [&](const std::string& name) -> const Field& {
    return reader.at({plain(name)}, name);
  };
  const Field& right_field = projection(options.cameras->second);
  const Projection left = matrix_of<3, 4>(projection(options.cameras->first));
  const Projection right = matrix_of<3, 4>(right_field);
  check_same_rows(right_field, left.leftCols<3>(), right.leftCols<3>());
  const double baseline = (left(0, 3) - right(0, 3)) / left(0, 0);
  set_rectified(left.leftCols<3>(), right.leftCols<3>(), baseline * options.unit_mm.value_or(kMillimetres),
                result);
  return result;
}

// What a rig must be to serve this board: the cameras side by side, the left one first. `reader` refuses.
void check(const ImportedRig& found, const ImportOptions& options, const Reader& reader) {
  constexpr double kLeastMm = 5;
  constexpr double kMostMm = 10'000;
  const Rig& rig = found.rig;
  const Vector3d& t = rig.translation;
  const std::string place = fmt::format("T = {:.1f}, {:.1f}, {:.1f} mm: ", t.x(), t.y(), t.z());
  if (rig.width < 1 || rig.width > kMostPixels || rig.height < 1 || rig.height > kMostPixels)
    reader.refuse(fmt::format("pictures of {}x{} pixels: must be 1..2048 each", rig.width, rig.height));
  if (std::abs(t.y()) > std::abs(t.x()))
    reader.refuse(place + "one camera is above the other: they must be side by side");
  if (t.x() > 0) reader.refuse(place + "the second camera is left of the first: exchange them");
  if (rig.left.is_fisheye != rig.right.is_fisheye)
    reader.refuse("one lens is a fisheye, the other is none: both must have the same model");
  if (!options.unit_mm && (t.norm() < kLeastMm || t.norm() > kMostMm)) {
    reader.refuse(
        fmt::format("the cameras are {:.2f} mm apart: must be {} to {} mm, or the unit of T must be "
                    "given by --unit mm, cm or m",
                    t.norm(), kLeastMm, kMostMm));
  }
}

bool has(const Fields& fields, const char* name) { return fields.count(name) != 0; }

std::optional<std::string> format_of(const Fields& fields) {
  if (has(fields, "cam0.intrinsics")) return "Kalibr camchain";
  if (has(fields, "cam0") && has(fields, "baseline")) return "Middlebury calib.txt";
  if (has(fields, "p0") || has(fields, "prect00") || has(fields, "prect02")) return "KITTI calib.txt";
  if ((has(fields, "projectionmatrix") && has(fields, "cameramatrix")) ||
      (has(fields, "p") && has(fields, "k")))
    return "ROS camera_info";
  for (const std::vector<std::string>& bases : {kMatrices, kCoefficients}) {
    for (const std::string& name : names_of(bases, kLeft)) {
      if (has(fields, name.c_str())) return "OpenCV";
    }
  }
  if (has(fields, "r") && has(fields, "t")) return "OpenCV";
  return std::nullopt;
}

}  // namespace

std::optional<std::string> foreign_format(const ForeignFile& file) try {
  return format_of(fields_of(file));
} catch (const std::exception&) {
  return std::nullopt;
}

ImportedRig import_rig(const std::vector<ForeignFile>& files, const ImportOptions& options) {
  Fields all;
  std::vector<Reader> readers;
  std::string paths;
  std::string format;
  for (const ForeignFile& file : files) {
    const Fields fields = fields_of(file);
    const auto its = format_of(fields);
    if (!its)
      throw std::runtime_error(fmt::format(
          "'{}': no calibration of a kind that is known: OpenCV, ROS camera_info, Kalibr, Middlebury, KITTI",
          file.path));
    if (!format.empty() && format != *its)
      throw std::runtime_error(
          fmt::format("'{}': {}: must be {}, as the file before it", file.path, *its, format));
    format = *its;
    paths += (paths.empty() ? "" : "', '") + file.path;
    readers.emplace_back(fields, file.path);
    if (format == "ROS camera_info") continue;
    for (const auto& [name, field] : fields) add(all, field);
  }
  const Reader reader(std::move(all), paths);
  ImportedRig found = format == "ROS camera_info"        ? import_ros(readers, options)
                      : format == "Kalibr camchain"      ? import_kalibr(reader, options)
                      : format == "Middlebury calib.txt" ? import_middlebury(reader, options)
                      : format == "KITTI calib.txt"      ? import_kitti(reader, options)
                                                         : import_opencv(reader, options);
  check(found, options, reader);
  if (!found.rectification && is_rectified(found.rig))
    set_rectified(found.rig.left.matrix, found.rig.right.matrix, found.rig.translation.norm(), found);
  return found;
}

std::vector<ForeignFile> export_rig(const Rig& rig, const Rectification& rectification,
                                    const std::string& format) {
  if (format == "opencv") {
    cv::FileStorage file(".yaml",
                         cv::FileStorage::WRITE | cv::FileStorage::MEMORY | cv::FileStorage::FORMAT_YAML);
    file.writeComment(kExportMark + 2);
    file << "image_width" << rig.width << "image_height" << rig.height;
    if (rig.left.is_fisheye)
      file << "lens_model"
           << "fisheye";
    file << "M1" << to_mat(rig.left.matrix) << "D1" << coefficients_of(rig.left);
    file << "M2" << to_mat(rig.right.matrix) << "D2" << coefficients_of(rig.right);
    file << "R" << to_mat(rig.rotation) << "T" << to_mat(rig.translation);
    file << "R1" << to_mat(rectification.r1) << "R2" << to_mat(rectification.r2);
    file << "P1" << to_mat(rectification.p1) << "P2" << to_mat(rectification.p2);
    file << "Q" << to_mat(rectification.q);
    return {{".yaml", file.releaseAndGetString()}};
  }
  constexpr double kMetres = 1e-3;
  const auto matrix_text = [](const char* name, const auto& matrix) {
    std::vector<double> numbers;
    for (int i = 0; i < matrix.size(); ++i) numbers.push_back(matrix(i / matrix.cols(), i % matrix.cols()));
    return fmt::format("{}:\n  rows: {}\n  cols: {}\n  data: [{}]\n", name, matrix.rows(), matrix.cols(),
                       fmt::join(numbers, ", "));
  };
  const auto camera_text = [&](const char* name, const CameraModel& camera, const Matrix3d& rotation,
                               Projection projection) {
    const std::size_t count = camera.coefficients();
    if (count > 8)
      throw std::runtime_error(fmt::format("the {} lens has a prism: camera_info has no model for it", name));
    projection.col(3) *= kMetres;
    const Eigen::Map<const Eigen::RowVectorXd> coefficients(camera.distortion.data(), long(count));
    return fmt::format("{}\nimage_width: {}\nimage_height: {}\ncamera_name: {}\n", kExportMark, rig.width,
                       rig.height, name) +
           matrix_text("camera_matrix", camera.matrix) +
           fmt::format("distortion_model: {}\n", camera.is_fisheye ? "equidistant"
                                                 : count == 5      ? "plumb_bob"
                                                                   : "rational_polynomial") +
           matrix_text("distortion_coefficients", coefficients) +
           matrix_text("rectification_matrix", rotation) + matrix_text("projection_matrix", projection);
  };
  return {{"_left.yaml", camera_text("left", rig.left, rectification.r1, rectification.p1)},
          {"_right.yaml", camera_text("right", rig.right, rectification.r2, rectification.p2)}};
}

}  // namespace stereotlm::calib
