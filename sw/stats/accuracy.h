#pragma once

#include <cstdint>
#include <optional>

#include "models/kernels/gray_image.h"
#include "sw/media/load.h"

namespace stereotlm::stats {

// The accuracy of disparities, as sw/report/README.md defines it (stats.json), in percent, 0..100. Only
// pixels count whose truth is known and which the right camera sees too. A pixel with a valid disparity is
// answered. nullopt: the denominator is 0.
struct Accuracy {
  std::optional<double>
      bad_1_percent;  // share of the answered pixels that are wrong by more than 1 disparity
  std::optional<double> bad_2_percent;     // share of the answered pixels that are wrong by more than 2
  std::optional<double> answered_percent;  // share of the pixels that are answered: the density
};

// The pixels of one or more disparity images from which their accuracy follows.
struct AccuracyCounts {
  std::uint64_t visible = 0;  // known, and seen by the right camera too
  std::uint64_t answered = 0;
  std::uint64_t bad_1 = 0;
  std::uint64_t bad_2 = 0;

  // Adds those of an image, as accuracy() takes it.
  void add(const kernels::GrayImage& disparity, const media::Truth& truth);
  Accuracy accuracy() const;
};

// If more than this share of the answers is wrong by more than 1 disparity, the truth probably belongs to
// another picture, or has another scale.
inline constexpr double kDoubtfulBad1Percent = 50;

// `disparity`: referenced to the left picture; kernels::kInvalidDisparity marks pixels without a valid
// disparity. Throws std::invalid_argument if the sizes differ.
Accuracy accuracy(const kernels::GrayImage& disparity, const media::Truth& truth);

}  // namespace stereotlm::stats
