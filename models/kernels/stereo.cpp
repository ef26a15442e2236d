#include "models/kernels/stereo.h"

#include <cstddef>
#include <stdexcept>

#include "models/kernels/column_filter.h"
#include "models/kernels/lr_check.h"
#include "models/kernels/sad_columns.h"
#include "models/kernels/select_min.h"
#include "models/kernels/words.h"

namespace stereotlm::kernels {
namespace {

void require_one_size(const GrayImage& left, const GrayImage& right) {
  if (left.width != right.width || left.height != right.height) {
    throw std::invalid_argument("left image of " + std::to_string(left.width) + " x " +
                                std::to_string(left.height) + " with a right image of " +
                                std::to_string(right.width) + " x " + std::to_string(right.height) +
                                ": must be of one size");
  }
}

void require_sound(const StereoConfig& config) {
  if (const auto found = problems(config); !found.empty()) throw std::invalid_argument(found.front());
}

}  // namespace

std::vector<std::string> problems(const StereoConfig& config) {
  std::vector<std::string> found;
  kWindowRule.check("window", config.window, found);
  kDisparitiesRule.check("disparities", config.disparities, found);
  if (config.lr_tolerance) kLrToleranceRule.check("lr_tolerance", *config.lr_tolerance, found);
  if (config.filter) {
    for (const std::string& problem : problems(*config.filter)) found.push_back("filter: " + problem);
  }
  return found;
}

GrayImage filter_image(const GrayImage& image, const FilterKernel& kernel) {
  if (image.pixels.empty()) throw std::invalid_argument("image to be filtered: must not be empty");
  ColumnFilter filter(image.width, image.height, 1, kernel);
  filter.start_frame(0);
  GrayImage filtered(image.width, image.height);
  const int half = kernel.half();
  // A pixel leaves `half` rows and columns after it entered, so the last ones need `half` columns of one more
  // row.
  const auto width = static_cast<std::ptrdiff_t>(image.width);
  const std::ptrdiff_t delay = half * width + half;
  const auto pixels = static_cast<std::ptrdiff_t>(image.pixels.size());
  for (std::ptrdiff_t index = 0; index < pixels + delay; ++index) {
    const std::uint8_t entering =
        index < pixels ? image.pixels[static_cast<std::size_t>(index)] : std::uint8_t{0};
    filter.push({entering, true});
    if (index >= delay) filtered.pixels[static_cast<std::size_t>(index - delay)] = filter.output().values[0];
  }
  return filtered;
}

Matches match(const GrayImage& left, const GrayImage& right, int window, int disparities) {
  require_one_size(left, right);
  require_sound({window, disparities, std::nullopt, std::nullopt});
  const int width = left.width;
  const int height = left.height;
  const int radius = (window - 1) / 2;
  Matches matches{GrayImage(width, height, kInvalidDisparity), GrayImage(width, height, kInvalidDisparity)};
  SadColumns sums(window, disparities);
  SelectMinChain chain(disparities);
  std::vector<std::uint8_t> left_pixels(static_cast<std::size_t>(window));
  std::vector<std::uint8_t> right_pixels(static_cast<std::size_t>(window));
  for (int row = radius; row < height - radius; ++row) {
    sums.start_frame();
    chain.start_frame();
    // `column` ends the window around left pixel column - radius; unit A runs on until its last pixel has
    // left it.
    for (int column = 0; column < width + radius + disparities - 1; ++column) {
      for (int k = 0; k < window && column < width; ++k) {
        left_pixels[static_cast<std::size_t>(k)] = left.at(column, row - radius + k);
        right_pixels[static_cast<std::size_t>(k)] = right.at(column, row - radius + k);
      }
      sums.push_column(left_pixels.data(), right_pixels.data());
      const int centre = column - radius;
      if (centre < 0) continue;
      const int candidates = candidate_count(centre, row, width, height, window, disparities);
      if (centre < width)
        matches.left_based.at(centre, row) = select_min_tree(sums.window_sums(), candidates, sums.lanes());
      const std::uint8_t right_based = chain.step(sums.window_sums(), candidates);
      const int right_column = centre - (disparities - 1);
      if (right_column >= 0 && right_column < width) matches.right_based.at(right_column, row) = right_based;
    }
  }
  return matches;
}

GrayImage disparity_image(const GrayImage& left, const GrayImage& right, const RectificationTable* left_table,
                          const RectificationTable* right_table, const StereoConfig& config) {
  require_one_size(left, right);
  require_sound(config);
  const auto prepare = [&config](const GrayImage& source, const RectificationTable* table) {
    GrayImage rectified = table != nullptr ? rectify(source, *table) : source;
    return config.filter ? filter_image(rectified, *config.filter) : rectified;
  };
  const Matches matches =
      match(prepare(left, left_table), prepare(right, right_table), config.window, config.disparities);
  GrayImage disparity(left.width, left.height, kInvalidDisparity);
  for (int row = 0; row < left.height; ++row) {
    for (int column = 0; column < left.width; ++column) {
      const std::uint8_t d = matches.left_based.at(column, row);
      if (d == kInvalidDisparity) continue;
      const std::size_t index = static_cast<std::size_t>(row) * static_cast<std::size_t>(left.width) +
                                static_cast<std::size_t>(column);
      if (left_table != nullptr && !entry_is_valid(left_table->entries[index])) continue;
      if (left_right_consistent(d, matches.right_based.at(column - d, row), config.lr_tolerance)) {
        disparity.pixels[index] = d;
      }
    }
  }
  return disparity;
}

}  // namespace stereotlm::kernels
