#pragma once

#include <cstdint>
#include <string>

// The times of contract section 3, in ps from time 0. Each is rounded once, halves up, from its exact value.
namespace stereotlm::test {

using PlainTime = std::uint64_t;  // ps

// An exact decimal number: numerator / denominator.
struct PlainNumber {
  std::int64_t numerator = 1;
  std::int64_t denominator = 1;
};

// `decimal`: digits with at most one point, such as "33.333".
PlainNumber plain_number(const std::string& decimal);

class PlainClock {
 public:
  explicit PlainClock(const PlainNumber& mhz) : mhz_(mhz) {}
  PlainTime edge(std::uint64_t number) const;
  // The number of the first edge at or after a time.
  std::uint64_t first_edge(PlainTime time) const;
  // Whole clocks from time 0 to a time.
  std::uint64_t clocks_by(PlainTime time) const { return first_edge(time + 1) - 1; }

 private:
  PlainNumber mhz_;
};

struct PlainCamera {
  int width = 0;
  int height = 0;
  PlainNumber rate_hz{2997, 100};
};

// From time 0 to the beginning of frame `number` of a free-running camera.
PlainTime plain_frame_ps(const PlainNumber& rate_hz, std::uint64_t number);
// From the beginning of a frame to the arrival of a pixel.
PlainTime plain_pixel_ps(const PlainCamera& camera, int column, int row);

}  // namespace stereotlm::test
