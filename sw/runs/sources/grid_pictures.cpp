#include "sw/runs/sources/grid_pictures.h"

#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <system_error>
#include <tuple>
#include <utility>

#include "models/fpga/core_config.h"
#include "sw/files/text_forms.h"
#include "sw/media/load.h"
#include "sw/process/streams.h"

namespace stereotlm::runs {
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

// Prints a note about the first pair whose names do not end in the same number: if each side lacks a
// different picture, all pairs between these two are wrong.
void compare_numbers(const Names& left, const Names& right) {
  const auto number_of = [](const std::string& file) {
    const std::string stem = fs::path(file).stem();
    return stem.substr(stem.find_last_not_of("0123456789") + 1);
  };
  for (std::size_t i = 0; i < left.size(); ++i) {
    if (number_of(left[i]) == number_of(right[i])) continue;
    process::say("note",
                 fmt::format("pictures are paired in the order of their names, '{}' with '{}': do they "
                             "belong together?",
                             left[i], right[i]));
    return;
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
  std::map<std::string, std::string> paths;  // paths by SHA-256 of the pixels
  std::string first;
  int width = 0;  // of the first picture
  int height = 0;
  int converted = 0;
  const auto load = [&](const std::string& option, const std::string& path) {
    kernels::GrayImage image;
    problems.attempt(option + ' ', [&] {
      media::LoadedGray loaded = media::load_gray(path);
      converted += loaded.converted_from_colour ? 1 : 0;
      for (const std::string& note : loaded.notes) process::say("note", fmt::format("'{}': {}", path, note));
      image = std::move(loaded.image);
      const auto refuse = [&path](const std::string& rule) {
        throw std::runtime_error(fmt::format("'{}': {}", path, rule));
      };
      const std::string size = fmt::format("{}x{} pixels: ", image.width, image.height);
      const bool is_first = paths.empty();
      // The same picture twice would count twice without new information.
      const auto [known, is_new] =
          paths.emplace(files::sha256_hex(image.pixels.data(), image.pixels.size()), path);
      if (!is_new) refuse(fmt::format("the same picture as '{}': must be another one", known->second));
      if (is_first) std::tie(first, width, height) = std::tuple(path, image.width, image.height);
      const kernels::IntegerRule& widths = fpga::kWidthWithTableRule;
      const kernels::IntegerRule& heights = fpga::kHeightWithTableRule;
      if (is_first && !(widths.allows(width) && heights.allows(height)))
        refuse(size + fmt::format("a board's images with a look-up table are {} wide and {} high",
                                  widths.text(), heights.text()));
      if (image.width != width || image.height != height)
        refuse(size + fmt::format("must be as large as '{}', {}x{}", first, width, height));
    });
    return image;
  };
  std::vector<calib::PicturePair> pairs;
  for (std::size_t i = 0; i < left_files.size(); ++i) {
    if (process::interrupted()) return {};
    pairs.push_back(
        {left_files[i], right_files[i], load("--left", left_files[i]), load("--right", right_files[i])});
  }
  if (converted > 0)
    process::say("note", fmt::format("{} of {} pictures: colour, converted to grey", converted,
                                     2 * left_files.size()));
  compare_numbers(left_files, right_files);
  return pairs;
}

}  // namespace stereotlm::runs
