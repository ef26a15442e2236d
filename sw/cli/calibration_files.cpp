#include "sw/cli/calibration_files.h"

#include <fmt/format.h>
#include <fnmatch.h>
#include <glob.h>

#include <algorithm>
#include <array>
#include <exception>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include "calib/calibration.h"
#include "models/fpga/core_config.h"
#include "sw/files/text_forms.h"
#include "sw/files/whole_file.h"
#include "sw/media/load.h"
#include "sw/process/interrupt.h"
#include "sw/process/streams.h"

namespace stereotlm::cli {
namespace {

namespace fs = std::filesystem;

using Names = std::vector<std::string>;

// The files that match a pattern, sorted by name. A file whose name equals the pattern is taken literally.
Names files_of(const std::string& option, const Names& patterns, process::Problems& problems) {
  Names files;
  for (const std::string& pattern : patterns) {
    std::error_code none;
    if (std::filesystem::exists(pattern, none)) {
      files.push_back(pattern);
      continue;
    }
    glob_t found = {};
    const int status = glob(pattern.c_str(), 0, nullptr, &found);
    if (status == GLOB_NOMATCH) {
      problems.add(
          fmt::format("{} '{}': no such file: must be a file's name, or a pattern of some", option, pattern));
    } else if (status != 0) {
      problems.add(fmt::format("{} '{}': a folder of this pattern cannot be read", option, pattern));
    }
    for (std::size_t i = 0; i < found.gl_pathc; ++i) files.emplace_back(found.gl_pathv[i]);
    globfree(&found);
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::string name_of(const std::string& path) { return std::filesystem::path(path).stem(); }

// The length of the common prefix of all names.
std::size_t common_beginning(const Names& names) {
  std::size_t length = names.front().size();
  for (const std::string& name : names) {
    const auto end = names.front().begin() + static_cast<std::ptrdiff_t>(std::min(length, name.size()));
    const auto differs = std::mismatch(names.front().begin(), end, name.begin()).first;
    length = static_cast<std::size_t>(differs - names.front().begin());
  }
  return length;
}

// The names without their common prefix and suffix.
Names own_parts(const Names& files) {
  Names names;
  for (const std::string& file : files) names.push_back(name_of(file));
  const std::size_t beginning = common_beginning(names);
  for (std::string& name : names) name = name.substr(beginning);
  Names reversed;
  for (const std::string& name : names) reversed.emplace_back(name.rbegin(), name.rend());
  const std::size_t end = common_beginning(reversed);
  for (std::string& name : names) name.resize(name.size() - end);
  return names;
}

// Prints a note about the first pair whose names differ: if each side lacks a different picture, all pairs
// between these two are wrong.
void compare_names(const Names& left, const Names& right) {
  const Names left_parts = own_parts(left);
  const Names right_parts = own_parts(right);
  const auto differ = std::mismatch(left_parts.begin(), left_parts.end(), right_parts.begin());
  if (differ.first == left_parts.end()) return;
  const auto at = static_cast<std::size_t>(differ.first - left_parts.begin());
  process::say(
      "note",
      fmt::format("pictures are paired in the order of their names, '{}' with '{}': do they belong together?",
                  left[at], right[at]));
}

class Loader {
 public:
  explicit Loader(process::Problems& problems) : problems_(problems) {}

  kernels::GrayImage load(const std::string& option, const std::string& path) {
    try {
      media::LoadedGray loaded = media::load_gray(path);
      if (loaded.converted_from_colour) ++converted_;
      ++count_;
      check_size(option, path, loaded.image);
      check_new(option, path, loaded.image);
      return std::move(loaded.image);
    } catch (const std::exception& error) {
      problems_.add(fmt::format("{} {}", option, error.what()));
      return {};
    }
  }

  void say_converted() const {
    if (converted_ > 0) {
      process::say("note", fmt::format("{} of {} pictures: colour, converted to grey", converted_, count_));
    }
  }

 private:
  void check_size(const std::string& option, const std::string& path, const kernels::GrayImage& image) {
    if (first_.empty()) {
      first_ = path;
      width_ = image.width;
      height_ = image.height;
      const kernels::IntegerRule& width = fpga::kWidthWithTableRule;
      const kernels::IntegerRule& height = fpga::kHeightWithTableRule;
      if (!width.allows(width_) || !height.allows(height_)) {
        problems_.add(fmt::format(
            "{} '{}': {}x{} pixels: a board's images with a look-up table are {} wide and {} high", option,
            path, width_, height_, width.text(), height.text()));
      }
    } else if (image.width != width_ || image.height != height_) {
      problems_.add(fmt::format("{} '{}': {}x{} pixels: must be as large as '{}', {}x{}", option, path,
                                image.width, image.height, first_, width_, height_));
    }
  }

  // Reports a picture that appears twice: it would count twice without new information.
  void check_new(const std::string& option, const std::string& path, const kernels::GrayImage& image) {
    const auto [known, is_new] =
        paths_.emplace(files::sha256_hex(image.pixels.data(), image.pixels.size()), path);
    if (is_new) return;
    problems_.add(
        fmt::format("{} '{}': the same picture as '{}': must be another one", option, path, known->second));
  }

  process::Problems& problems_;
  std::map<std::string, std::string> paths_;  // paths by SHA-256 of the pixels
  std::string first_;
  int width_ = 0;
  int height_ = 0;
  int converted_ = 0;
  int count_ = 0;
};

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

std::vector<calib::PicturePair> load_grid_pictures(const Names& left, const Names& right,
                                                   process::Problems& problems) {
  const Names left_files = files_of("--left", left, problems);
  const Names right_files = files_of("--right", right, problems);
  if (left_files.empty() || right_files.empty()) return {};
  if (left_files.size() != right_files.size()) {
    problems.add(fmt::format(
        "--left, --right: {} left pictures ('{}' .. '{}') and {} right ones ('{}' .. '{}'): must be as many",
        left_files.size(), left_files.front(), left_files.back(), right_files.size(), right_files.front(),
        right_files.back()));
    return {};
  }
  Loader loader(problems);
  std::vector<calib::PicturePair> pairs;
  for (std::size_t i = 0; i < left_files.size(); ++i) {
    if (process::interrupted()) return {};
    pairs.push_back({left_files[i], right_files[i], loader.load("--left", left_files[i]),
                     loader.load("--right", right_files[i])});
  }
  loader.say_converted();
  compare_names(left_files, right_files);
  return pairs;
}

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
