#include "sw/runs/sources/grid_pictures.h"

#include <fmt/format.h>

#include <map>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "models/fpga/core_config.h"
#include "sw/files/text_forms.h"
#include "sw/media/load.h"
#include "sw/process/streams.h"
#include "sw/runs/sources/pair_files.h"

namespace stereotlm::runs {

std::vector<calib::PicturePair> load_grid_pictures(const std::vector<std::string>& left,
                                                   const std::vector<std::string>& right,
                                                   process::Problems& problems) {
  const PairFiles files = find_pairs(left, right, problems);
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
  for (std::size_t i = 0; i < files.left.size(); ++i) {
    if (process::interrupted()) return {};
    pairs.push_back(
        {files.left[i], files.right[i], load("--left", files.left[i]), load("--right", files.right[i])});
  }
  if (converted > 0)
    process::say("note",
                 fmt::format("{} of {} pictures: colour, converted to grey", converted, 2 * pairs.size()));
  for (const std::string& note : files.notes) process::say("note", note);
  return pairs;
}

}  // namespace stereotlm::runs
