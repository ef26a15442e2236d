#include "sw/cli/calibration_output.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <system_error>

#include "calib/calibration_reader.h"
#include "calib/storage_yaml.h"
#include "sw/report/whole_file.h"

namespace stereotlm::cli {
namespace {

namespace fs = std::filesystem;

using Patterns = std::vector<const char*>;  // of fnmatch

const Patterns kDrawings = {"corners_[0-9]*.png", "rectified_[0-9]*.png", "displacement.png",
                            "source_lines.png"};
const Patterns kPictures = {"left_[0-9]*.png", "right_[0-9]*.png", "scene_left.png", "scene_right.png",
                            "scene_truth.png"};

bool is_there(const fs::path& path) { return fs::exists(fs::symlink_status(path)); }

// A folder that is replaced whole holds nothing but files of ours.
void check_folder(const fs::path& folder, const Patterns& ours) {
  if (!is_there(folder)) return;
  if (!fs::is_directory(fs::symlink_status(folder))) {
    throw std::runtime_error(fmt::format("'{}': must be a folder that calibrate has made", folder.string()));
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    const bool is_ours = std::any_of(ours.begin(), ours.end(), [&name](const char* pattern) {
      return fnmatch(pattern, name.c_str(), 0) == 0;
    });
    if (is_ours && fs::is_regular_file(entry.symlink_status())) continue;
    throw std::runtime_error(
        fmt::format("'{}': in a folder that is replaced whole: must be moved away", entry.path().string()));
  }
}

}  // namespace

CalibrationOutput::CalibrationOutput(const std::string& calibration, bool makes_pictures)
    : files_(rig_files(calibration)), makes_pictures_(makes_pictures) {
  fs::path folder = files_.calibration.parent_path();
  if (folder.empty()) folder = ".";
  aside_ = folder / (files_.calibration.stem().string() + ".partial");
  try {
    if (!fs::is_directory(folder))
      throw std::runtime_error(fmt::format("'{}': no such folder", folder.string()));
    check_aside();
    check_earlier();
    fs::remove_all(aside_);
    fs::create_directory(aside_);
  } catch (const std::system_error& error) {
    throw std::runtime_error(fmt::format("'{}': cannot be written: {}", calibration, error.code().message()));
  }
}

CalibrationOutput::~CalibrationOutput() {
  std::error_code ignored;
  fs::remove_all(aside_, ignored);
}

// What a killed run may have left behind is ours to remove, and nothing else.
void CalibrationOutput::check_aside() const {
  if (!is_there(aside_)) return;
  if (!fs::is_directory(fs::symlink_status(aside_))) {
    throw std::runtime_error(fmt::format(
        "'{}': the name of a folder that calibrate uses meanwhile: must be moved away", aside_.string()));
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(aside_)) {
    const fs::path name = entry.path().filename();
    if (name == files_.drawings.filename()) {
      check_folder(entry.path(), kDrawings);
    } else if (name == files_.pictures.filename()) {
      check_folder(entry.path(), kPictures);
    } else if (name != files_.calibration.filename() && name != files_.left_lut.filename() &&
               name != files_.right_lut.filename()) {
      throw std::runtime_error(fmt::format(
          "'{}': in a folder that calibrate uses meanwhile: must be moved away", entry.path().string()));
    }
  }
}

void CalibrationOutput::check_earlier() const {
  std::vector<fs::path> replaced = {files_.left_lut, files_.right_lut, files_.drawings};
  if (makes_pictures_) replaced.push_back(files_.pictures);
  // A run that was killed while it put its files into place has left the calibration, which comes last,
  // aside.
  const bool has_earlier = is_there(files_.calibration) || is_there(aside(files_.calibration));
  for (const fs::path& path : replaced) {
    if (is_there(path) && !has_earlier) {
      throw std::runtime_error(
          fmt::format("'{}': exists, without its calibration: must be moved away", path.string()));
    }
  }
  for (const fs::path& path : {files_.left_lut, files_.right_lut}) {
    if (is_there(path) && !fs::is_regular_file(fs::symlink_status(path))) {
      throw std::runtime_error(fmt::format("'{}': must be a file that calibrate has made", path.string()));
    }
  }
  check_folder(files_.drawings, kDrawings);
  if (makes_pictures_) check_folder(files_.pictures, kPictures);
  if (!is_there(files_.calibration)) return;
  try {
    calib::parse_calibration(report::read_whole_file(files_.calibration, calib::kMostStorageBytes));
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(fmt::format("'{}': exists and is no calibration ({}): must be moved away",
                                         files_.calibration.string(), error.what()));
  }
}

fs::path CalibrationOutput::aside(const fs::path& file) const {
  return aside_ / file.lexically_relative(files_.calibration.parent_path());
}

void CalibrationOutput::add(const fs::path& file, std::string_view bytes) {
  try {
    fs::create_directories(aside(file).parent_path());
    report::write_whole_file(aside(file), bytes);
  } catch (const std::system_error& error) {
    throw std::runtime_error(
        fmt::format("'{}': cannot be written: {}", file.string(), error.code().message()));
  }
}

void CalibrationOutput::add(const fs::path& file, const std::vector<std::uint8_t>& bytes) {
  add(file, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

void CalibrationOutput::commit() {
  try {
    for (const fs::path& folder : {files_.drawings, files_.pictures}) {
      if (!is_there(aside(folder))) continue;
      fs::remove_all(folder);
      fs::rename(aside(folder), folder);
    }
    for (const fs::path& file : {files_.left_lut, files_.right_lut, files_.calibration}) {
      fs::rename(aside(file), file);
    }
    report::sync_folder(aside_.parent_path());
  } catch (const std::system_error& error) {
    throw std::runtime_error(
        fmt::format("'{}': cannot be replaced: {}", files_.calibration.string(), error.code().message()));
  }
}

}  // namespace stereotlm::cli
