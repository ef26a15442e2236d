#include "calib/lut_file.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace stereotlm::calib {
namespace {

TEST(LutFile, IsLittleEndianRowByRow) {
  kernels::RectificationTable table = {
      2, 3, {0, kernels::make_entry(1, 2), 0, 0, 0, kernels::make_entry(0, 1)}};
  const std::string bytes = lut_bytes(table);
  ASSERT_EQ(bytes.size(), 24U);
  EXPECT_EQ(bytes.substr(4, 4), std::string("\x01\x00\x02\x80", 4));
  const kernels::RectificationTable again = parse_lut(bytes, 2, 3);
  EXPECT_EQ(again.entries, table.entries);
  EXPECT_EQ(again.width, 2);
  EXPECT_EQ(again.height, 3);
}

TEST(LutFile, IsRefusedWithAnotherSizeOrABrokenEntry) {
  EXPECT_THROW(parse_lut(std::string(23, '\0'), 2, 3), std::runtime_error);
  EXPECT_THROW(parse_lut(std::string(28, '\0'), 2, 3), std::runtime_error);
  std::string bytes(24, '\0');
  bytes[3] = '\x40';  // a bit that is not used
  EXPECT_THROW(parse_lut(bytes, 2, 3), std::runtime_error);
  bytes[3] = '\x80';
  bytes[0] = '\x02';  // column 2 of 2
  EXPECT_THROW(parse_lut(bytes, 2, 3), std::runtime_error);
}

}  // namespace
}  // namespace stereotlm::calib
