#include "sw/stats/accuracy.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "models/kernels/words.h"

namespace stereotlm::stats {
namespace {

// The column at which the right picture shows a left pixel; outside 0..width-1 if it does not show the pixel,
// or if the truth is unknown, which is infinite.
double right_column(int x, double level, double scale) { return std::floor(x - level / scale + 0.5); }

// For each pixel of a row: whether its truth is known and the right camera sees it too. Truths are compared
// as levels, which are integers in pictures.
std::vector<bool> known_and_visible(const media::Truth& truth, int y) {
  const int width = truth.width;
  const auto inside = [width](double column) { return column >= 0 && column < width; };
  // [right column]: the largest truth of the left pixels that match a pixel of this column.
  std::vector<double> nearest_level(static_cast<std::size_t>(width), -media::Truth::kUnknown);
  for (int x = 0; x < width; ++x) {
    const double level = truth.at(x, y);
    const double column = right_column(x, level, truth.scale);
    if (!inside(column)) continue;
    double& nearest = nearest_level[static_cast<std::size_t>(column)];
    nearest = std::max(nearest, level);
  }
  std::vector<bool> result(static_cast<std::size_t>(width), false);
  for (int x = 0; x < width; ++x) {
    const double level = truth.at(x, y);
    const double column = right_column(x, level, truth.scale);
    if (!inside(column)) continue;
    result[static_cast<std::size_t>(x)] =
        nearest_level[static_cast<std::size_t>(column)] - level <= truth.scale;
  }
  return result;
}

std::optional<double> percent(std::uint64_t part, std::uint64_t whole) {
  if (whole == 0) return std::nullopt;
  return 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

void AccuracyCounts::add(const kernels::GrayImage& disparity, const media::Truth& truth) {
  if (disparity.width != truth.width || disparity.height != truth.height) {
    throw std::invalid_argument(fmt::format("truth = {}x{}: must be as large as the disparity image, {}x{}",
                                            truth.width, truth.height, disparity.width, disparity.height));
  }
  for (int y = 0; y < disparity.height; ++y) {
    const std::vector<bool> counts = known_and_visible(truth, y);
    for (int x = 0; x < disparity.width; ++x) {
      if (!counts[static_cast<std::size_t>(x)]) continue;
      ++visible;
      const int d = disparity.at(x, y);
      if (d == kernels::kInvalidDisparity) continue;
      ++answered;
      const double error = std::abs(d - double{truth.at(x, y)} / truth.scale);
      bad_1 += error > 1 ? 1U : 0U;
      bad_2 += error > 2 ? 1U : 0U;
    }
  }
}

Accuracy AccuracyCounts::accuracy() const {
  return {percent(bad_1, answered), percent(bad_2, answered), percent(answered, visible)};
}

Accuracy accuracy(const kernels::GrayImage& disparity, const media::Truth& truth) {
  AccuracyCounts counts;
  counts.add(disparity, truth);
  return counts.accuracy();
}

}  // namespace stereotlm::stats
