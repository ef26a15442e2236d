#include "sw/cli/calibration_output.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <system_error>

#include "calib/calibration_reader.h"
#include "sw/files/folder_entries.h"
#include "sw/files/whole_file.h"

namespace stereotlm::cli {
namespace {

namespace fs = std::filesystem;
using files::is_file;
using files::is_folder;
using files::is_there;

using Patterns = std::vector<const char*>;  // patterns for fnmatch()

const Patterns kDrawings = {"corners_[0-9]*.png", "rectified_[0-9]*.png", "displacement.png",
                            "source_lines.png"};
const Patterns kPictures = {"left_[0-9]*.png", "right_[0-9]*.png", "scene_left.png", "scene_right.png",
                            "scene_truth.png"};

fs::path folder_of(const runs::RigFiles& files) {
  const fs::path folder = files.calibration.parent_path();
  return folder.empty() ? "." : folder;
}

const runs::RigFiles& in_a_folder(const runs::RigFiles& files) {
  std::error_code error;
  const fs::file_status status = fs::status(folder_of(files), error);
  if (fs::is_directory(status)) return files;
  throw std::runtime_error(fmt::format("'{}': {}", folder_of(files).string(),
                                       fs::status_known(status) ? "no such folder" : error.message()));
}

// Returns an entry of `folder` that `calibrate` has not written; nullopt if there is none. `ours`: the names
// that `calibrate` writes.
std::optional<fs::path> foreign_file(const fs::path& folder, const Patterns& ours) {
  for (const fs::path& name : files::entries(folder)) {
    const bool is_ours = std::any_of(ours.begin(), ours.end(), [&name](const char* pattern) {
      return fnmatch(pattern, name.c_str(), 0) == 0;
    });
    if (!is_ours || !is_file(folder / name)) return name;
  }
  return std::nullopt;
}

std::optional<std::string> foreign_part(const fs::path& entry, const runs::RigFiles& files) {
  const fs::path name = entry.filename();
  const auto in_folder = [&](const Patterns& ours) -> std::optional<std::string> {
    if (!is_folder(entry)) return name;
    const auto foreign = foreign_file(entry, ours);
    return foreign ? std::optional<std::string>(name / *foreign) : std::nullopt;
  };
  if (name == files.drawings.filename()) return in_folder(kDrawings);
  if (name == files.pictures.filename()) return in_folder(kPictures);
  const bool is_ours = name == files.calibration.filename() || name == files.left_lut.filename() ||
                       name == files.right_lut.filename();
  return is_ours && is_file(entry) ? std::nullopt : std::optional<std::string>(name);
}

void check_folder(const fs::path& folder, const Patterns& ours) {
  if (!is_there(folder)) return;
  if (!is_folder(folder)) {
    throw std::runtime_error(fmt::format("'{}': must be a folder that calibrate has made", folder.string()));
  }
  if (const auto foreign = foreign_file(folder, ours)) {
    throw std::runtime_error(fmt::format("'{}': in a folder that is replaced whole: must be moved away",
                                         (folder / *foreign).string()));
  }
}

// Throws std::runtime_error if a file that would be replaced was not written by `calibrate`. `in_commit`: a
// killed run was moving its files into place. The calibration may then be missing, because it is moved last.
void check_earlier(const runs::RigFiles& files, bool makes_pictures, bool in_commit) {
  std::vector<fs::path> replaced = {files.left_lut, files.right_lut, files.drawings};
  if (makes_pictures) replaced.push_back(files.pictures);
  const bool has_earlier = is_there(files.calibration) || in_commit;
  for (const fs::path& path : replaced) {
    if (is_there(path) && !has_earlier) {
      throw std::runtime_error(
          fmt::format("'{}': exists, without its calibration: must be moved away", path.string()));
    }
  }
  for (const fs::path& path : {files.left_lut, files.right_lut}) {
    if (is_there(path) && !is_file(path)) {
      throw std::runtime_error(fmt::format("'{}': must be a file that calibrate has made", path.string()));
    }
  }
  check_folder(files.drawings, kDrawings);
  if (makes_pictures) check_folder(files.pictures, kPictures);
  if (!is_there(files.calibration)) return;
  try {
    calib::parse_calibration(files::read_whole_file(files.calibration, calib::kMostCalibrationBytes));
  } catch (const std::exception& error) {
    throw std::runtime_error(fmt::format("'{}': exists and is no calibration ({}): must be moved away",
                                         files.calibration.string(), error.what()));
  }
}

files::OutputContent content_of(const runs::RigFiles& files, bool makes_pictures,
                                const std::vector<files::NamedFile>& inputs) {
  files::OutputContent content;
  content.inputs = inputs;
  content.called = "folder";
  content.mark = files.calibration.filename();
  content.aside = files.calibration.stem().string() + ".partial";
  content.foreign = [files](const fs::path& entry) { return foreign_part(entry, files); };
  content.replaced = [files, makes_pictures](const fs::path& entry) {
    const bool is_kept = entry.filename() == files.pictures.filename() && !makes_pictures;
    return !is_kept && !foreign_part(entry, files);
  };
  const fs::path earlier = fs::path(content.aside) / files::kEarlierFolder;
  content.problem = [=](const fs::path& dir, bool /*was_left*/) -> std::optional<std::string> {
    check_earlier(files, makes_pictures, is_there(dir / earlier));
    return std::nullopt;
  };
  return content;
}

}  // namespace

CalibrationOutput::CalibrationOutput(const std::string& calibration, bool makes_pictures,
                                     const std::vector<files::NamedFile>& inputs)
    : files_(in_a_folder(runs::rig_files(calibration))),
      folder_(folder_of(files_), content_of(files_, makes_pictures, inputs)) {}

void CalibrationOutput::add(const fs::path& file, std::string_view bytes) {
  folder_.add(file.lexically_relative(files_.calibration.parent_path()), bytes);
}

void CalibrationOutput::add(const fs::path& file, const std::vector<std::uint8_t>& bytes) {
  add(file, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

}  // namespace stereotlm::cli
