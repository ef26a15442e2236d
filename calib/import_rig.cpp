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
#include <set>
#include <sstream>
#include <stdexcept>

#include "calib/opencv_conversions.h"

namespace stereotlm::calib {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr int kMostPixels = 2048;  // of a side of a picture with a table
constexpr int kWidthStep = 4;      // of the width of a board's images, pixels

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

void add_values(const YAML::Node& node, Field& field) {
  if (node.IsSequence()) {
    for (const YAML::Node& item : node) add_values(item, field);
  }
  if (!node.IsScalar()) return;
  field.text = node.Scalar();
  if (const auto value = number_of(field.text)) field.numbers.push_back(*value);
}

void add(Fields& fields, const std::string& place, const std::string& name, const YAML::Node& node) {
  Field field{place, name, {}, {}};
  if (!node.IsMap()) {
    add_values(node, field);
    return add(fields, field);
  }
  for (const auto& entry : node) {
    const std::string key = entry.first.Scalar();
    const bool is_matrix = key == "data";  // of the map that is the matrix
    add(fields, place, is_matrix ? name : name.empty() ? key : name + '.' + key, entry.second);
  }
}

void add(Fields& fields, const std::string& place, const std::string& name, const cv::FileNode& node) {
  Field field{place, name, {}, {}};
  const cv::FileNode values = node.isMap() ? node["data"] : node;  // of a matrix
  if (values.isString()) field.text = values.string();
  for (const cv::FileNode& item : values) {
    if (item.isInt() || item.isReal()) field.numbers.push_back(item.real());
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
  constexpr auto kOrder = kColumns == 1 ? Eigen::ColMajor : Eigen::RowMajor;
  const Eigen::Map<const Eigen::Matrix<double, kRows, kColumns, kOrder>> result(field.numbers.data());
  if (!result.allFinite()) refuse(field, "not finite", "must hold finite numbers");
  return result;
}

// A rotation that a field has with a few digits, made exact.
Matrix3d rotation_of(const Field& field, const Matrix3d& found) {
  constexpr double kCloseEnough = 1e-3;
  const Eigen::JacobiSVD<Matrix3d> svd(found, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Matrix3d rotation = svd.matrixU() * svd.matrixV().transpose();
  if ((found - rotation).norm() > kCloseEnough || rotation.determinant() < 0)
    refuse(field, "no rotation", "must be a rotation matrix");
  return rotation;
}

Matrix3d rotation_of(const Field& field) { return rotation_of(field, matrix_of<3, 3>(field)); }

Matrix3d camera_matrix_of(const Field& field) {
  const Matrix3d result = matrix_of<3, 3>(field);
  if (!(result(0, 0) > 0 && result(1, 1) > 0) || result(0, 1) != 0 || result(1, 0) != 0 ||
      result.row(2) != Eigen::RowVector3d(0, 0, 1))
    refuse(field, "no camera", "must be [fx 0 cx; 0 fy cy; 0 0 1] with focal lengths above 0");
  return result;
}

void set_distortion(CameraModel& camera, const Field& field, bool is_fisheye) {
  const std::vector<double>& numbers = field.numbers;
  const std::set<std::size_t> counts =
      is_fisheye ? std::set<std::size_t>{4} : std::set<std::size_t>{0, 4, 5, 8, 12, 14};
  const std::size_t used = std::min<std::size_t>(numbers.size(), 12);
  const std::vector<double> tilt(numbers.begin() + static_cast<long>(used), numbers.end());
  if (counts.count(numbers.size()) == 0 || tilt != std::vector<double>(tilt.size()))
    refuse(field, fmt::format("{} coefficients", numbers.size()),
           is_fisheye ? "a fisheye lens has 4" : "must be 4, 5, 8 or 12, and those of a tilt 0");
  camera.is_fisheye = is_fisheye;
  std::copy_n(numbers.begin(), used, camera.distortion.begin());
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
  const Field* place = reader.find({"imagesize", "size", "cam0.resolution", "resolution", "srect00"});
  std::vector<double> size = place != nullptr ? place->numbers : std::vector<double>();
  if (size.size() != 2) {
    place = reader.find({"imagewidth", "width"});
    const Field* const height = reader.find({"imageheight", "height"});
    size = place != nullptr ? place->numbers : std::vector<double>();
    if (height != nullptr) size.insert(size.end(), height->numbers.begin(), height->numbers.end());
  }
  const bool is_known = size.size() == 2;
  if (!is_known && !options.size)
    reader.refuse("the size of the pictures is not in it: must be given by --size WxH");
  const std::vector<double> given =
      options.size ? std::vector<double>{double(options.size->first), double(options.size->second)} : size;
  if (!is_known) size = given;
  const std::string found = fmt::format("{:g}x{:g}", size[0], size[1]);
  const bool is_right = std::all_of(size.begin(), size.end(), [](double pixels) {
    return pixels >= 1 && pixels <= kMostPixels && pixels == std::floor(pixels);
  });
  const std::string rule = fmt::format("must be 1..{} each", kMostPixels);
  if (!is_right && !is_known) reader.refuse(fmt::format("--size = {}: {}", found, rule));
  if (!is_right) refuse(*place, found + " pixels", rule);
  if (size != given) refuse(*place, found, "must be that of --size");
  rig.width = static_cast<int>(size[0]);
  rig.height = static_cast<int>(size[1]);
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

// The following functions set a rig, with T in the unit of the format. `readers`: one of all the files; of
// ROS one of each. The size is that of the first.
using Readers = std::vector<Reader>;

void import_opencv(const Readers& readers, const ImportOptions& options, Rig& rig) {
  const Reader& reader = readers.front();
  const Field* const model = reader.find({"distortionmodel", "lensmodel", "fisheye"});
  const bool says_fisheye =
      model != nullptr && (model->numbers.empty() ? is_fisheye_model(*model) : model->numbers.front() != 0);
  for (const auto& [side, camera] : {std::pair(kLeft, &rig.left), std::pair(kRight, &rig.right)}) {
    camera->matrix = camera_matrix_of(
        reader.at(names_of(kMatrices, side), fmt::format("M{0}, K{0} or cameraMatrix{0}", side.number)));
    set_distortion(
        *camera, reader.at(names_of(kCoefficients, side), fmt::format("D{0} or distCoeffs{0}", side.number)),
        options.is_fisheye.value_or(says_fisheye));
  }
  const Field* const rotation = reader.find({"r", "rotation", "rotationmatrix", "stereor"});
  const Field* const translation = reader.find({"t", "translation", "translationvector", "stereot"});
  if (rotation != nullptr && translation != nullptr) {
    rig.rotation = rotation_of(*rotation);
    rig.translation = matrix_of<3, 1>(*translation);
  } else {
    const char* const what = "R and T, or R1, R2 and P2";
    set_place(rotation_of(reader.at({"r1"}, what)), rotation_of(reader.at({"r2"}, what)),
              matrix_of<3, 4>(reader.at({"p2"}, what)), rig);
  }
}

void import_ros(const Readers& readers, const ImportOptions& options, Rig& rig) {
  if (readers.size() != 2) readers.front().refuse("a rig of ROS has two camera_info: --import LEFT RIGHT");
  std::vector<Matrix3d> rotations;
  std::vector<Projection> projections;
  for (const Reader& reader : readers) {
    Rig size;
    set_size(reader, options, size);
    if (size.width != rig.width || size.height != rig.height)
      reader.refuse(fmt::format("{}x{} pixels: must be {}x{}, as the left camera has", size.width,
                                size.height, rig.width, rig.height));
    CameraModel& camera = rotations.empty() ? rig.left : rig.right;
    camera.matrix = camera_matrix_of(reader.at({"cameramatrix", "k"}, "camera_matrix"));
    set_distortion(camera, reader.at({"distortioncoefficients", "d"}, "distortion_coefficients"),
                   is_fisheye_model(reader.at({"distortionmodel"}, "distortion_model")));
    rotations.push_back(rotation_of(reader.at({"rectificationmatrix", "r"}, "rectification_matrix")));
    const Field& projection = reader.at({"projectionmatrix", "p"}, "projection_matrix");
    projections.push_back(matrix_of<3, 4>(projection));
    if (projections.front()(0, 3) != 0)
      refuse(projection, fmt::format("{} at row 1, column 4", projections.front()(0, 3)),
             "must be 0 for the left camera, which is the first file");
  }
  set_place(rotations[0], rotations[1], projections[1], rig);
}

void import_kalibr(const Readers& readers, const ImportOptions& /*options*/, Rig& rig) {
  for (const auto& [name, camera] : {std::pair("cam0", &rig.left), std::pair("cam1", &rig.right)}) {
    const auto field = [&readers, its = name](const std::string& key) -> const Field& {
      return readers.front().at({its + ('.' + plain(key))}, its + ('.' + key));
    };
    if (const Field& model = field("camera_model"); model.text != "pinhole")
      refuse(model, model.text, "must be pinhole");
    const Field& resolution = field("resolution");
    if (resolution.numbers != std::vector<double>{double(rig.width), double(rig.height)})
      refuse(resolution, fmt::format("{}", fmt::join(resolution.numbers, "x")), "must be that of cam0");
    const auto intrinsics = matrix_of<4, 1>(field("intrinsics"));
    camera->matrix << intrinsics[0], 0, intrinsics[2], 0, intrinsics[1], intrinsics[3], 0, 0, 1;
    set_distortion(*camera, field("distortion_coeffs"), is_fisheye_model(field("distortion_model")));
  }
  const Field& place = readers.front().at({"cam1.tcncnm1"}, "cam1.T_cn_cnm1");
  const Eigen::Matrix4d pose = matrix_of<4, 4>(place);
  rig.rotation = rotation_of(place, pose.topLeftCorner<3, 3>());
  rig.translation = pose.topRightCorner<3, 1>();
}

bool has_same_rows(const Matrix3d& left, const Matrix3d& right) {
  return left(0, 0) == right(0, 0) && left(1, 1) == right(1, 1) && left(1, 2) == right(1, 2);
}

// Sets the rig of pictures that are rectified already. `right`: the field of the right camera.
void set_rectified(const Field& field, const Matrix3d& left, const Matrix3d& right, double baseline,
                   Rig& rig) {
  if (!has_same_rows(left, right))
    refuse(field, "another focal length or centre row than the other camera",
           "must be equal in pictures that are rectified");
  rig.left.matrix = left;
  rig.right.matrix = right;
  rig.translation = {-baseline, 0, 0};
}

void import_middlebury(const Readers& readers, const ImportOptions& /*options*/, Rig& rig) {
  const Reader& reader = readers.front();
  const Field& right_field = reader.at({"cam1"}, "cam1");
  const Matrix3d left = camera_matrix_of(reader.at({"cam0"}, "cam0"));
  const Matrix3d right = camera_matrix_of(right_field);
  set_rectified(right_field, left, right, matrix_of<1, 1>(reader.at({"baseline"}, "baseline"))(0), rig);
  constexpr double kCloseEnough = 1e-2;
  const double distance = right(0, 2) - left(0, 2);
  const Field* const doffs = reader.find({"doffs"});
  if (doffs != nullptr && std::abs(matrix_of<1, 1>(*doffs)(0) - distance) > kCloseEnough)
    refuse(*doffs, doffs->text,
           fmt::format("must be {}, the distance of the centres of cam0 and cam1", distance));
}

void import_kitti(const Readers& readers, const ImportOptions& options, Rig& rig) {
  const Reader& reader = readers.front();
  if (!options.cameras)
    reader.refuse("several cameras: two must be given by --cameras, such as P0,P1 (grey) or P2,P3 (colour)");
  const auto& [first, second] = *options.cameras;
  const Field& right_field = reader.at({plain(second)}, second);
  const Projection left = matrix_of<3, 4>(reader.at({plain(first)}, first));
  const Projection right = matrix_of<3, 4>(right_field);
  set_rectified(right_field, left.leftCols<3>(), right.leftCols<3>(), (left(0, 3) - right(0, 3)) / left(0, 0),
                rig);
}

// The rectification of a rig whose pictures are rectified already; nullopt if they are not.
std::optional<Rectification> made_rectification(const Rig& rig) {
  const std::array<double, 12> none{};
  if (rig.left.distortion != none || rig.right.distortion != none || rig.left.is_fisheye ||
      !rig.rotation.isIdentity(0) || rig.translation.y() != 0 || rig.translation.z() != 0 ||
      !has_same_rows(rig.left.matrix, rig.right.matrix))
    return std::nullopt;
  Rectification made;
  made.p1.leftCols<3>() = rig.left.matrix;
  made.p2.leftCols<3>() = rig.right.matrix;
  made.p2(0, 3) = rig.translation.x() * rig.right.matrix(0, 0);
  made.q = disparity_to_depth(made.p1, made.p2);
  return made;
}

// What a rig must be to serve this board: the cameras side by side, the left one first. `reader` refuses.
void check(const Rig& rig, const ImportOptions& options, const Reader& reader) {
  constexpr double kLeastMm = 5;
  constexpr double kMostMm = 10'000;
  const double distance = rig.translation.norm();
  // A size that the user gives may be wrong. A file may hold a part of a picture.
  const double margin = options.size ? 0.3 : 0;
  for (const CameraModel* camera : {&rig.left, &rig.right}) {
    const Eigen::Vector2d centre = camera->matrix.block<2, 1>(0, 2);
    const Eigen::Vector2d share = centre.cwiseQuotient(Eigen::Vector2d(rig.width, rig.height));
    if (share.minCoeff() >= margin && share.maxCoeff() <= 1 - margin) continue;
    reader.refuse(fmt::format(
        "the centre of a camera is ({:.1f}, {:.1f}) in pictures of {}x{}: must be {}: is "
        "their size right?",
        centre.x(), centre.y(), rig.width, rig.height, options.size ? "near the middle" : "inside"));
  }
  if (rig.width % kWidthStep != 0) {
    reader.refuse(
        fmt::format("pictures of {}x{}: a board takes widths that are a multiple of {}: crop the "
                    "pictures on the right, and change their size in the file",
                    rig.width, rig.height, kWidthStep));
  }
  if (rig.left.is_fisheye != rig.right.is_fisheye)
    reader.refuse("one lens is a fisheye, the other is none: both must have the same model");
  if (!options.unit_mm && (distance < kLeastMm || distance > kMostMm)) {
    reader.refuse(fmt::format(
        "the cameras are {:.2f} mm apart: must be {} to {} mm; --unit mm, cm or m says in which unit "
        "T is; T in squares of the grid must be converted first",
        distance, kLeastMm, kMostMm));
  }
  if (const auto problem = problem_of(rig)) reader.refuse(*problem);
}

struct Format {
  const char* name;
  double unit_mm;                               // of T
  std::vector<std::vector<std::string>> marks;  // a file of this format has all fields of one of them
  void (*import)(const Readers& readers, const ImportOptions& options, Rig& rig);
};

// The format of a file; null if it is not known.
const Format* format_of(const Fields& fields) {
  static const std::vector<Format> formats = [] {
    std::vector<std::vector<std::string>> of_opencv = {{"r", "t"}};
    for (const std::vector<std::string>& bases : {kMatrices, kCoefficients}) {
      for (const std::string& name : names_of(bases, kLeft)) of_opencv.push_back({name});
    }
    return std::vector<Format>{
        {"Kalibr camchain", 1000, {{"cam0.intrinsics"}}, import_kalibr},
        {"Middlebury calib.txt", 1, {{"cam0", "baseline"}}, import_middlebury},
        {"KITTI calib.txt", 1000, {{"p0"}, {"prect00"}, {"prect02"}}, import_kitti},
        {"ROS camera_info", 1000, {{"projectionmatrix", "cameramatrix"}, {"p", "k"}}, import_ros},
        {"OpenCV", 1, of_opencv, import_opencv}};
  }();
  const auto has = [&fields](const std::string& name) { return fields.count(name) != 0; };
  for (const Format& format : formats) {
    for (const std::vector<std::string>& mark : format.marks) {
      if (std::all_of(mark.begin(), mark.end(), has)) return &format;
    }
  }
  return nullptr;
}

}  // namespace

std::optional<std::string> foreign_format(const ForeignFile& file) try {
  const Format* const format = format_of(fields_of(file));
  return format != nullptr ? std::optional<std::string>(format->name) : std::nullopt;
} catch (const std::exception&) {
  return std::nullopt;
}

ImportedRig import_rig(const std::vector<ForeignFile>& files, const ImportOptions& options) {
  Fields all;
  Readers readers;
  std::string paths;
  const Format* format = nullptr;
  for (const ForeignFile& file : files) {
    const Fields fields = fields_of(file);
    const Format* const its = format_of(fields);
    if (its == nullptr)
      throw std::runtime_error(fmt::format(
          "'{}': no calibration of a kind that is known: OpenCV, ROS camera_info, Kalibr, Middlebury, KITTI",
          file.path));
    if (format != nullptr && format != its)
      throw std::runtime_error(
          fmt::format("'{}': {}: must be {}, as the file before it", file.path, its->name, format->name));
    format = its;
    paths += (paths.empty() ? "" : "', '") + file.path;
    readers.emplace_back(fields, file.path);
    if (format->import == import_ros) continue;
    for (const auto& [name, field] : fields) add(all, field);
  }
  const Reader reader(std::move(all), paths);
  if (format->import != import_ros) readers = {reader};
  ImportedRig found{format->name, {}, {}};
  set_size(readers.front(), options, found.rig);
  format->import(readers, options, found.rig);
  found.rig.translation *= options.unit_mm.value_or(format->unit_mm);
  check(found.rig, options, reader);
  found.rectification = made_rectification(found.rig);
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
  const auto matrix_text = [](const char* name, const Eigen::MatrixXd& matrix) {
    const Eigen::MatrixXd by_rows = matrix.transpose();
    return fmt::format("{}:\n  rows: {}\n  cols: {}\n  data: [{}]\n", name, matrix.rows(), matrix.cols(),
                       fmt::join(by_rows.data(), by_rows.data() + by_rows.size(), ", "));
  };
  const auto camera_text = [&](const char* name, const CameraModel& camera, const Matrix3d& rotation,
                               Projection projection) {
    const std::size_t count = camera.coefficients();
    if (count > 8)
      throw std::runtime_error(fmt::format("the {} lens has a prism: camera_info has no model for it", name));
    projection.col(3) *= kMetres;
    const Eigen::Map<const Eigen::RowVectorXd> coefficients(camera.distortion.data(), long(count));
    const char* const model = camera.is_fisheye ? "equidistant"
                              : count == 5      ? "plumb_bob"
                                                : "rational_polynomial";
    return fmt::format("{}\nimage_width: {}\nimage_height: {}\ncamera_name: {}\ndistortion_model: {}\n",
                       kExportMark, rig.width, rig.height, name, model) +
           matrix_text("camera_matrix", camera.matrix) +
           matrix_text("distortion_coefficients", coefficients) +
           matrix_text("rectification_matrix", rotation) + matrix_text("projection_matrix", projection);
  };
  return {{"_left.yaml", camera_text("left", rig.left, rectification.r1, rectification.p1)},
          {"_right.yaml", camera_text("right", rig.right, rectification.r2, rectification.p2)}};
}

}  // namespace stereotlm::calib
