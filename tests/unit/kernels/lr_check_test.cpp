#include "models/kernels/lr_check.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "tests/support/random_board.h"

namespace stereotlm::kernels {
namespace {

struct Stream {
  std::vector<std::uint8_t> left;
  std::vector<bool> left_valid;
  std::vector<std::uint8_t> right;
};

Stream random_stream(int columns, int disparities, test::SplitMix64& random) {
  const auto disparity = [&] {
    return static_cast<std::uint8_t>(random.chance(15) ? kInvalidDisparity
                                                       : random.between(0, disparities - 1));
  };
  Stream stream;
  for (int column = 0; column < columns; ++column) {
    stream.left.push_back(disparity());
    stream.left_valid.push_back(random.chance(85));
    stream.right.push_back(disparity());
  }
  return stream;
}

// Right pixel c arrives with column c + D - 1.
std::uint8_t expected_output(const Stream& stream, int column, std::optional<int> tolerance) {
  const auto at = static_cast<std::size_t>(column);
  const int d = stream.left[at];
  if (!stream.left_valid[at] || d == kInvalidDisparity) return kInvalidDisparity;
  if (!tolerance) return stream.left[at];
  const int right = stream.right[static_cast<std::size_t>(column - d)];
  if (right == kInvalidDisparity || std::abs(d - right) > *tolerance) return kInvalidDisparity;
  return stream.left[at];
}

TEST(LrCheck, StreamsWithADelayOfTheDisparities) {
  test::SplitMix64 random(4);
  for (const int disparities : {1, 2, 17, 80, 253, 254}) {
    for (const std::optional<int> tolerance : {std::optional(0), std::optional(2), std::optional(253), {}}) {
      SCOPED_TRACE(std::to_string(disparities) + " disparities, tolerance " +
                   (tolerance ? std::to_string(*tolerance) : "off"));
      LrCheck check(disparities, tolerance);
      for (int frame = 0; frame < 2; ++frame) {
        Stream stream = random_stream(1200, disparities, random);
        // No left pixel points to one before the first.
        for (std::size_t column = 0; column < 254; ++column) {
          if (stream.left[column] > column) stream.left[column] = kInvalidDisparity;
        }
        check.start_frame();
        for (int column = 0; column < 1200; ++column) {
          const auto at = static_cast<std::size_t>(column);
          const int back = column - (disparities - 1);
          const std::uint8_t right =
              back < 0 ? kInvalidDisparity : stream.right[static_cast<std::size_t>(back)];
          const std::uint8_t out = check.step(stream.left[at], stream.left_valid[at], right);
          ASSERT_EQ(out, back < 0 ? kInvalidDisparity : expected_output(stream, back, tolerance)) << column;
        }
      }
    }
  }
}

TEST(LrCheck, RefusesDisparitiesOrToleranceOutsideTheirRange) {
  EXPECT_NO_THROW(LrCheck(1, 0));
  EXPECT_NO_THROW(LrCheck(254, 253));
  for (const int disparities : {0, 255}) EXPECT_THROW(LrCheck(disparities, 0), std::invalid_argument);
  for (const int tolerance : {-1, 254}) EXPECT_THROW(LrCheck(8, tolerance), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::kernels
