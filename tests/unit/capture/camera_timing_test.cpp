#include "models/capture/camera_timing.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/support/plain_clock.h"

namespace stereotlm::capture {
namespace {

CameraTiming timing_of(int width, int height, double frame_rate_hz) {
  return CameraTiming({width, height, frame_rate_hz, CameraTrigger::kFreeRunning});
}

TEST(CameraTiming, BeginsEachFrameAtTheRoundedMultipleOfItsDecimalPeriod) {
  EXPECT_EQ(timing_of(640, 480, 0.1).frame_ps(3), 30'000'000'000'000U);
  const CameraTiming half = timing_of(640, 480, 327.68);  // 10^14 / 2^15 = 3051757812.5 ps
  EXPECT_EQ(half.frame_ps(1), 3'051'757'813U);
  EXPECT_EQ(half.frame_ps(2), 6'103'515'625U);
  EXPECT_EQ(half.frame_ps(3), 9'155'273'438U);
  const CameraTiming timing = timing_of(640, 480, 29.97);
  for (const std::uint64_t number : {1U, 2U, 3U, 59U, 1'000U, 999'999U, 100'000'000U})
    EXPECT_EQ(timing.frame_ps(number), test::plain_frame_ps({2997, 100}, number)) << number;
}

TEST(CameraTiming, PutsEveryPixelAtItsRoundedExactTime) {
  struct Case {
    int width;
    int height;
    double frame_rate_hz;
    test::PlainNumber rate;
  };
  for (const Case& c :
       {Case{640, 480, 29.97, {2997, 100}}, Case{4, 1, 0.1, {1, 10}}, Case{8, 3, 327.68, {32768, 100}},
        Case{8192, 8191, 999.999, {999999, 1000}}, Case{36, 50, 59.94, {5994, 100}}}) {
    const CameraTiming timing = timing_of(c.width, c.height, c.frame_rate_hz);
    const int row_step = c.height / 16 + 1;
    for (int row = 0; row < c.height; row += row_step) {
      EXPECT_EQ(timing.row_ps(row), timing.pixel_ps(0, row));
      for (int column = 0; column < c.width; ++column)
        ASSERT_EQ(timing.pixel_ps(column, row),
                  test::plain_pixel_ps({c.width, c.height, c.rate}, column, row))
            << c.frame_rate_hz << " Hz, " << column << ", " << row;
    }
  }
}

TEST(CameraTiming, IsExactToTheLastDigitOfALongFrameRate) {
  for (const double rate : {0.12345678901234567, 29.97002997002997, 999.99999999999989}) {
    const CameraTiming timing = timing_of(8188, 8191, rate);
    const long double line_ps = 32e12L / 35 / 8191 / static_cast<long double>(rate);
    for (const int row : {0, 1, 4000, 8190}) {
      for (int column = 0; column < 8188; ++column) {
        const long double exact = line_ps * (static_cast<long double>(row) + 745.0L / 908 / 8188 * column);
        EXPECT_NEAR(static_cast<double>(static_cast<long double>(timing.pixel_ps(column, row)) - exact), 0,
                    0.51)
            << rate << ", " << column << ", " << row;
      }
    }
    EXPECT_NEAR(static_cast<double>(static_cast<long double>(timing.frame_ps(1)) - 1e12L / rate), 0, 0.51);
  }
}

TEST(CameraTiming, CountsAPixelFromItsArrivalOn) {
  for (const double rate : {29.97, 0.1, 1000.0}) {
    for (const int width : {4, 36, 8192}) {
      const CameraTiming timing = timing_of(width, 500, rate);
      for (const int row : {0, 1, 499}) {
        if (row > 0) {
          EXPECT_EQ(timing.pixels_by(row, 0), 0);
        }
        for (int column = 0; column < width; ++column) {
          const std::uint64_t arrival = timing.pixel_ps(column, row);
          ASSERT_EQ(timing.pixels_by(row, arrival), column + 1);
          if (arrival > 0) {
            ASSERT_EQ(timing.pixels_by(row, arrival - 1), column);
          }
        }
        EXPECT_EQ(timing.pixels_by(row, timing.frame_ps(1)), width);
      }
    }
  }
}

TEST(CameraTiming, RefusesAConfigurationWithProblems) {
  EXPECT_THROW(timing_of(6, 480, 25), std::invalid_argument);
  EXPECT_THROW(timing_of(640, 480, 0), std::invalid_argument);
}

}  // namespace
}  // namespace stereotlm::capture
