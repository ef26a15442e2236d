#include "models/kernels/image_matcher.h"

#include <algorithm>
#include <array>
#include <limits>

#include "models/checked.h"
#include "models/kernels/limits.h"

namespace stereotlm::kernels {
namespace {

constexpr std::int16_t kSmallest = std::numeric_limits<std::int16_t>::min();
constexpr std::int16_t kLargest = std::numeric_limits<std::int16_t>::max();

// Column sums are read and written once per row, and should fit into the second-level cache.
constexpr double kMostColumnSumBytes = 400e3;

constexpr int divided_up(int value, int divisor) { return (value + divisor - 1) / divisor; }
constexpr int rounded_up(int value, int unit) { return divided_up(value, unit) * unit; }

}  // namespace

ImageMatcher::ImageMatcher(int width, int height, int window, int disparities, bool right_based,
                           const MatchingCost& cost, const Simd& simd)
    : width_(width), height_(height), radius_((window - 1) / 2), simd_(simd) {
  plan_.window = kWindowRule.required("window", window);
  plan_.disparities = kDisparitiesRule.required("disparities", disparities);
  plan_.right_based = right_based;
  checked("cost", cost);
  windows_across_ = width - 2 * radius_;
  windows_down_ = height - 2 * radius_;
  if (windows_across_ < 1 || windows_down_ < 1) return;
  // No right window has more candidates.
  plan_.disparities = std::min(plan_.disparities, windows_across_);
  if (cost.kind == CostKind::kZncc) {
    correlations_.emplace(width, height, window, plan_.disparities, simd);
    return;
  }
  choose_loops(cost);
  choose_bands();
  plan_.first_outside = windows_across_ - (segments_ - 1) * plan_.columns;

  const int positions = plan_.columns + window - 1;
  const int more = plan_.disparities - 1;
  row_stride_ = static_cast<std::size_t>(
      rounded_up((segments_ - 1) * plan_.columns + rounded_up(positions + more, 8), kMostFrameLanes));
  row_stride_ = std::max(row_stride_, static_cast<std::size_t>(rounded_up(width, kMostFrameLanes)));
  prepare(left_, positions + more, plan_.columns + more);
  prepare(right_, positions, plan_.columns);
  no_row_.resize(static_cast<std::size_t>(width));

  const auto lanes = static_cast<std::size_t>(simd_.lanes);
  outside_ = VectorArray(static_cast<std::size_t>(plan_.columns + plan_.disparities) * lanes);
  for (int position = 0; position < plan_.columns + plan_.disparities; ++position) {
    for (int lane = 0; lane < simd_.lanes; ++lane) {
      const int window_column = lane % segments_ * plan_.columns + position;
      outside_.data()[static_cast<std::size_t>(position) * lanes + static_cast<std::size_t>(lane)] =
          window_column < windows_across_ ? kSmallest : kLargest;
    }
  }
  band_begins_ = VectorArray(lanes);
  for (int lane = 0; lane < simd_.lanes; ++lane)
    band_begins_.data()[lane] = lane % segments_ == 0 ? kLargest : kSmallest;
  column_sums_ = VectorArray(static_cast<std::size_t>(plan_.disparities) *
                             static_cast<std::size_t>(plan_.columns + window) *
                             static_cast<std::size_t>(loops_.sum_vectors) * lanes);
  const auto side = [this](MatchedImage& its) -> MatchSide {
    return {its.pixel_vectors.data(), pixel_stride(its), its.best.data(), its.unpacked.data()};
  };
  memory_ = {side(right_), side(left_), outside_.data(), band_begins_.data(), column_sums_.data()};
}

void ImageMatcher::choose_loops(const MatchingCost& cost) {
  switch (cost.kind) {
    case CostKind::kSad:
      loops_ = simd_.sad_loops(plan_.window);
      return;
    case CostKind::kSsd:
      loops_ = simd_.ssd_loops(plan_.window);
      return;
    case CostKind::kZncc:
      return;
    case CostKind::kCensus:
      pixel_bytes_ = cost.pixel_bytes();
      loops_ = simd_.census_loops(pixel_bytes_, plan_.window);
      for (MatchedImage* side : {&left_, &right_}) side->census.emplace(width_, height_, cost, simd_);
  }
}

// Chooses the number of bands that needs the least work. Neighbouring segments share window - 1 columns, and
// neighbouring bands as many rows. These are computed twice, each time with about half the usual work. More
// than one band is chosen only if the column sums take at most kMostColumnSumBytes.
void ImageMatcher::choose_bands() {
  const double shared = plan_.window - 1;
  double least = std::numeric_limits<double>::max();
  for (int bands = 1; bands <= simd_.lanes; bands *= 2) {
    const int segments = simd_.lanes / bands;
    const int columns = rounded_up(divided_up(windows_across_, segments), 8);
    const int rows = divided_up(windows_down_, bands);
    const double bytes =
        2.0 * loops_.sum_vectors * simd_.lanes * plan_.disparities * (columns + plan_.window);
    const double work = (rows + 0.5 * shared) * (columns + 0.5 * shared);
    if (work >= least || (bands > 1 && bytes > kMostColumnSumBytes)) continue;
    least = work;
    bands_ = bands;
    segments_ = segments;
    plan_.columns = columns;
    band_rows_ = rows;
  }
}

void ImageMatcher::prepare(MatchedImage& side, int positions, int windows) {
  const auto lanes = static_cast<std::size_t>(simd_.lanes);
  const auto vectors = [lanes](int count, int vectors_each) {
    return VectorArray(static_cast<std::size_t>(count) * static_cast<std::size_t>(vectors_each) * lanes);
  };
  const auto rows = static_cast<std::size_t>(bands_) * row_stride_;
  side.positions = positions;
  side.rows = VectorArray(rows);
  side.out.resize(rows);
  side.pixel_vectors = vectors(rounded_up(positions, 8), pixel_bytes_);
  side.best = vectors(windows, loops_.best_vectors);
  if (loops_.unpacks) side.unpacked = vectors(positions, 2);
}

// The distance from one byte of the pixels to the next in MatchedImage::pixel_vectors, in lanes.
int ImageMatcher::pixel_stride(const MatchedImage& side) const {
  return rounded_up(side.positions, 8) * simd_.lanes;
}

void ImageMatcher::enter_rows(MatchedImage& side, const std::uint8_t* image, int step) {
  if (!side.census) return enter_rows(side, image, step, side.pixel_vectors.data());
  for (int byte = 0; byte < pixel_bytes_; ++byte) {
    enter_rows(side, side.census->plane(byte), step,
               side.pixel_vectors.data() + std::ptrdiff_t{byte} * pixel_stride(side));
  }
}

// Row `step` of each band enters its windows. Rows below the image repeat its last row; their results are not
// used.
void ImageMatcher::enter_rows(MatchedImage& side, const std::uint8_t* plane, int step,
                              std::int16_t* pixel_vectors) {
  const auto width = static_cast<std::size_t>(width_);
  const auto row_of = [&](int row) {
    return plane + static_cast<std::size_t>(std::min(row, height_ - 1)) * width;
  };
  std::array<const std::int16_t*, kMostFrameLanes> lanes{};
  std::size_t lane = 0;
  for (int band = 0; band < bands_; ++band) {
    const int row = band * band_rows_ + step;
    std::int16_t* pairs = side.rows.data() + static_cast<std::size_t>(band) * row_stride_;
    simd_.pair_pixels(row_of(row), step < plan_.window ? no_row_.data() : row_of(row - plan_.window), width_,
                      pairs);
    for (int segment = 0; segment < segments_; ++segment)
      lanes[lane++] = pairs + std::ptrdiff_t{segment} * plan_.columns;
  }
  simd_.to_lanes(lanes.data(), side.positions, pixel_vectors);
}

void ImageMatcher::leave_rows(MatchedImage& side, int step, std::uint8_t* disparity) {
  std::array<std::uint8_t*, kMostFrameLanes> lanes{};
  for (int lane = 0; lane < simd_.lanes; ++lane) {
    lanes[static_cast<std::size_t>(lane)] = side.out.data() +
                                            static_cast<std::size_t>(lane / segments_) * row_stride_ +
                                            std::ptrdiff_t{lane % segments_} * plan_.columns;
  }
  simd_.from_lanes(side.best.data(), plan_.columns, lanes.data());
  for (int band = 0; band < bands_; ++band) {
    const int row = band * band_rows_ + step - (plan_.window - 1);
    if (row >= windows_down_) continue;
    const std::uint8_t* from = side.out.data() + static_cast<std::size_t>(band) * row_stride_;
    std::copy_n(from, windows_across_, disparity + (std::ptrdiff_t{row} + radius_) * width_ + radius_);
  }
}

void ImageMatcher::run(const std::uint8_t* left, const std::uint8_t* right, std::uint8_t* left_disparity,
                       std::uint8_t* right_disparity) {
  if (windows_across_ < 1 || windows_down_ < 1) return;
  if (correlations_) {
    return correlations_->run(left, right, left_disparity, plan_.right_based ? right_disparity : nullptr);
  }
  column_sums_.fill(0);
  if (left_.census) {
    left_.census->run(left);
    right_.census->run(right);
  }
  for (int step = 0; step < band_rows_ + plan_.window - 1; ++step) {
    enter_rows(left_, left, step);
    enter_rows(right_, right, step);
    if (step < plan_.window - 1) {
      loops_.add_row(plan_, memory_);
      continue;
    }
    loops_.match_row(plan_, memory_);
    leave_rows(left_, step, left_disparity);
    if (plan_.right_based) leave_rows(right_, step, right_disparity);
  }
}

}  // namespace stereotlm::kernels
