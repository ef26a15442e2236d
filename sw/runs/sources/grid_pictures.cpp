#include "sw/runs/sources/grid_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <utility>

#include "models/fpga/core_config.h"
#include "sw/files/text_forms.h"
#include "sw/media/load.h"
#include "sw/process/streams.h"
#include "sw/runs/sources/open_source.h"
#include "sw/runs/sources/pair_files.h"

namespace stereotlm::runs {

namespace {

kernels::GrayImage half_of(const kernels::GrayImage& image, int first_column) {
  kernels::GrayImage half(image.width / 2, image.height);
  for (int row = 0; row < half.height; ++row) {
    for (int column = 0; column < half.width; ++column)
      half.at(column, row) = image.at(first_column + column, row);
  }
  return half;
}

void check_size(const std::string& name, int width, int height, process::Problems& problems) {
  const kernels::IntegerRule& widths = fpga::kWidthWithTableRule;
  const kernels::IntegerRule& heights = fpga::kHeightWithTableRule;
  if (widths.allows(width) && heights.allows(height)) return;
  problems.add(fmt::format("{}: {}x{} pixels: a board's images with a look-up table are {} wide and {} high",
                           name, width, height, widths.text(), heights.text()));
}

}  // namespace

std::vector<calib::PicturePair> load_grid_pictures(const std::vector<std::string>& left,
                                                   const std::vector<std::string>& right,
                                                   const std::vector<std::string>& side_by_side,
                                                   process::Problems& problems) {
  const bool is_split = !side_by_side.empty();
  PairFiles files;
  if (is_split)
    files.left = files.right = files_of("--side-by-side", side_by_side, files.notes, problems);
  else
    files = find_pairs(left, right, problems);
  int loaded_files = 0;
  int converted = 0;
  const auto load = [&](const std::string& option, const std::string& path) {
    kernels::GrayImage image;
    problems.attempt(option + ' ', [&] {
      media::LoadedGray loaded = media::load_gray(path);
      ++loaded_files;
      converted += loaded.converted_from_colour ? 1 : 0;
      for (const std::string& note : loaded.notes) process::say("note", fmt::format("'{}': {}", path, note));
      if (is_split && loaded.image.width % 2 != 0)
        throw std::runtime_error(fmt::format("'{}': {} pixels wide: must be even", path, loaded.image.width));
      image = std::move(loaded.image);
    });
    return image;
  };
  std::map<std::string, std::string> names;  // by SHA-256 of the pixels
  std::map<std::pair<int, int>, std::vector<std::string>> names_of_size;
  const auto check = [&](const std::string& name, const kernels::GrayImage& image) {
    if (image.pixels.empty()) return;  // could not be loaded
    // The same picture twice would count twice without new information.
    const auto [known, is_new] =
        names.emplace(files::sha256_hex(image.pixels.data(), image.pixels.size()), name);
    if (!is_new)
      problems.add(fmt::format("{}: the same picture as {}: must be another one", name, known->second));
    std::vector<std::string>& of_size = names_of_size[{image.width, image.height}];
    if (of_size.empty()) check_size(name, image.width, image.height, problems);
    of_size.push_back(name);
  };
  std::vector<calib::PicturePair> pairs;
  for (std::size_t i = 0; i < files.left.size(); ++i) {
    if (process::interrupted()) return {};
    kernels::GrayImage first = load(is_split ? "--side-by-side" : "--left", files.left[i]);
    kernels::GrayImage second = is_split ? half_of(first, first.width / 2) : load("--right", files.right[i]);
    if (is_split) first = half_of(first, 0);
    check(fmt::format(is_split ? "--side-by-side '{}' (left half)" : "--left '{}'", files.left[i]), first);
    check(fmt::format(is_split ? "--side-by-side '{}' (right half)" : "--right '{}'", files.right[i]),
          second);
    pairs.push_back({files.left[i], files.right[i], std::move(first), std::move(second)});
  }
  if (names_of_size.size() > 1) {
    std::vector<std::string> sizes;
    for (const auto& [size, of_size] : names_of_size)
      sizes.push_back(
          fmt::format("{} of {}x{}, such as {}", of_size.size(), size.first, size.second, of_size.front()));
    const auto [width, height] = names_of_size.begin()->first;
    const char* const turn = width != height && names_of_size.count({height, width}) != 0
                                 ? "turn those that lie on their side, or "
                                 : "";
    problems.add(
        fmt::format("pictures of several sizes: {}: must all have one size: {}take the others again with "
                    "both cameras set to one size, or scale those that show the whole view of a camera",
                    fmt::join(sizes, "; "), turn));
  }
  if (converted > 0)
    process::say("note",
                 fmt::format("{} of {} pictures: colour, converted to grey", converted, loaded_files));
  for (const std::string& note : files.notes) process::say("note", note);
  return pairs;
}

std::vector<calib::PicturePair> load_grid_video(const std::vector<std::string>& files,
                                                const std::string& layout, process::Problems& problems) {
  constexpr std::uint64_t kMost = 40;
  InputPictures pictures;
  for (const std::string& file : files) pictures.video.push_back({file, ""});
  pictures.video_layout = layout;
  const OpenedSource opened = open_source(pictures, nullptr, problems);
  for (const std::string& note : opened.notes) process::say("note", note);
  std::vector<calib::PicturePair> pairs;
  if (opened.pairs == nullptr) return pairs;
  const std::string& last = files.back();
  check_size(fmt::format("--video '{}'", files.front()), opened.sizes.front().width,
             opened.sizes.front().height, problems);
  const std::uint64_t count = std::min(kMost, opened.pairs->length());
  for (std::uint64_t i = 0; i < count && !process::interrupted(); ++i) {
    const std::uint64_t frame = i * opened.pairs->length() / count;
    problems.attempt("--video ", [&] {
      const host::StereoPair& pair = opened.pairs->pair(frame);
      pairs.push_back({fmt::format("{} frame {} left", files.front(), frame),
                       fmt::format("{} frame {} right", last, frame), pair.left, pair.right});
    });
  }
  return pairs;
}

}  // namespace stereotlm::runs
