#include "sw/cli/calibration_output.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <system_error>

#include "sw/cli/calibration_library.h"
#include "sw/report/whole_file.h"

namespace stereotlm::cli {
namespace {

namespace fs = std::filesystem;

// In the folders of drawings and pictures.
bool is_ours(const fs::path& name) {
  constexpr const char* kPatterns[] = {"corners_[0-9]*.png", "rectified_[0-9]*.png", "left_[0-9]*.png",
                                       "right_[0-9]*.png",   "displacement.png",     "source_lines.png",
                                       "scene_left.png",     "scene_right.png",      "scene_truth.png"};
  return std::any_of(std::begin(kPatterns), std::end(kPatterns),
                     [&name](const char* pattern) { return fnmatch(pattern, name.c_str(), 0) == 0; });
}

void check_folder(const fs::path& folder) {
  if (!fs::exists(fs::symlink_status(folder))) return;
  if (!fs::is_directory(fs::symlink_status(folder))) {
    throw std::runtime_error(fmt::format("'{}': must be a folder that calibrate has made", folder.string()));
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (is_ours(entry.path().filename()) && entry.is_regular_file()) continue;
    throw std::runtime_error(
        fmt::format("'{}': in a folder that is replaced whole: must be moved away", entry.path().string()));
  }
}

}  // namespace

CalibrationOutput::CalibrationOutput(const std::string& calibration) : files_(rig_files(calibration)) {
  fs::path folder = files_.calibration.parent_path();
  if (folder.empty()) folder = ".";
  aside_ = folder / (files_.calibration.stem().string() + ".partial");
  try {
    if (!fs::is_directory(folder)) {
      throw std::runtime_error(fmt::format("'{}': no such folder", folder.string()));
    }
    check_earlier();
    fs::remove_all(aside_);
    fs::create_directory(aside_);
    report::write_whole_file(aside_ / "probe", "can this folder be written to?");
    fs::remove(aside_ / "probe");
  } catch (const std::system_error& error) {
    std::error_code ignored;
    fs::remove_all(aside_, ignored);
    throw std::runtime_error(fmt::format("'{}': cannot be written: {}", calibration, error.code().message()));
  }
}

CalibrationOutput::~CalibrationOutput() {
  std::error_code ignored;
  fs::remove_all(aside_, ignored);
}

void CalibrationOutput::check_earlier() const {
  if (fs::exists(files_.calibration)) {
    try {
      calibration_functions().parse_calibration(read_file(files_.calibration));
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(fmt::format("'{}': exists and is no calibration ({}): must be moved away",
                                           files_.calibration.string(), error.what()));
    }
  } else {
    for (const fs::path& file : {files_.left_lut, files_.right_lut}) {
      if (!fs::exists(fs::symlink_status(file))) continue;
      throw std::runtime_error(
          fmt::format("'{}': exists, without its calibration: must be moved away", file.string()));
    }
  }
  check_folder(files_.drawings);
  check_folder(files_.pictures);
  if (!fs::exists(fs::symlink_status(aside_))) return;
  for (const fs::directory_entry& entry : fs::directory_iterator(aside_)) {
    const fs::path name = entry.path().filename();
    const fs::path ours[] = {files_.calibration.filename(), files_.left_lut.filename(),
                             files_.right_lut.filename(), files_.drawings.filename(),
                             files_.pictures.filename()};
    if (name == "probe" || std::find(std::begin(ours), std::end(ours), name) != std::end(ours)) continue;
    throw std::runtime_error(fmt::format(
        "'{}': in a folder that calibrate uses meanwhile: must be moved away", entry.path().string()));
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
      fs::remove_all(folder);
      if (fs::exists(aside(folder))) fs::rename(aside(folder), folder);
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
