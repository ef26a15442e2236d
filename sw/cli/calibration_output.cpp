#include "sw/cli/calibration_output.h"

#include <fnmatch.h>

#include <algorithm>
#include <array>
#include <exception>
#include <filesystem>
#include <string>

#include "calib/calibration.h"
#include "sw/files/whole_file.h"

namespace stereotlm::cli {
namespace {

namespace fs = std::filesystem;

// Patterns for fnmatch() of what follows F in the names of the files.
constexpr std::array kEndings = {".yaml",
                                 "_left.lut",
                                 "_right.lut",
                                 "_drawings/",
                                 "_drawings/corners_+([0-9]).png",
                                 "_drawings/rectified_+([0-9]).png",
                                 "_drawings/displacement.png",
                                 "_drawings/source_lines.png",
                                 "_pictures/",
                                 "_pictures/@(left|right)_+([0-9]).png",
                                 "_pictures/scene_@(left|right|truth).png"};

bool is_calibration(const fs::path& file) {
  try {
    calib::parse_calibration(files::read_whole_file(file, calib::kMostCalibrationBytes));
    return true;
  } catch (const std::exception& /*error*/) {
    return false;
  }
}

}  // namespace

files::OutputContent calibration_content(const runs::RigFiles& files, bool makes_pictures,
                                         const std::vector<files::NamedFile>& inputs) {
  const std::string stem = files.calibration.stem();
  files::OutputContent content;
  content.called = "folder";
  content.mark = files.calibration.filename();
  content.kind = {"calibration", is_calibration};
  content.rule =
      "only files that calibrate has made, with their calibration, are replaced: must be moved away";
  content.is_ours = [stem](const std::string& name) {
    return name.rfind(stem, 0) == 0 && std::any_of(kEndings.begin(), kEndings.end(), [&](const char* ending) {
             return fnmatch(ending, name.c_str() + stem.size(), FNM_EXTMATCH | FNM_PATHNAME) == 0;
           });
  };
  content.others_stay = true;
  if (!makes_pictures) content.kept = files.pictures.filename();
  content.aside = stem + ".partial";
  content.inputs = inputs;
  return content;
}

}  // namespace stereotlm::cli
