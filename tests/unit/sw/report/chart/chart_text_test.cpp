#include "sw/report/chart/chart_text.h"

#include <gtest/gtest.h>

namespace stereotlm::report {
namespace {

TEST(ChartText, IsAsWideAsItsLetters) {
  EXPECT_DOUBLE_EQ(text_width("", 10, false), 0);
  EXPECT_DOUBLE_EQ(text_width(" ~", 10, false), 3.18 + 8.38);
  EXPECT_DOUBLE_EQ(text_width("Wi", 100, false), 98.9 + 27.8);
  EXPECT_DOUBLE_EQ(text_width("Wi", 100, true), 110.3 + 34.3);
  EXPECT_DOUBLE_EQ(text_width("\u6F22\U0001F642", 10, false), 25) << "two characters, seven bytes";
}

TEST(ChartText, StaysWholeIfItFitsExactly) {
  const double width = text_width("bank0123", 13, true);
  EXPECT_EQ(fitted("bank0123", 13, true, width), "bank0123");
  EXPECT_NE(fitted("bank0123", 13, true, width - 0.01), "bank0123");
}

TEST(ChartText, KeepsBeginningAndEndIfItDoesNotFit) {
  EXPECT_EQ(fitted("aaaaaaaaaaaaaaaaaaaab", 10, false, 40), "aa\u2026ab");
  EXPECT_EQ(fitted("\u6F22\u6F22\u6F22\u6F22\u6F22\u6F22", 10, false, 40), "\u6F22\u2026\u6F22")
      << "whole characters";
  EXPECT_EQ(fitted("aaaa", 10, false, 0), "\u2026");
  for (double width = 14; width < 200; width += 7)
    EXPECT_LE(text_width(fitted("a-bank-with-a-long-name", 11, true, width), 11, true), width);
}

TEST(ChartText, IsTextInXmlWhateverItIs) {
  EXPECT_EQ(xml_text("<script>\"a\" & 'b'</script>"),
            "&lt;script&gt;&quot;a&quot; &amp; &#39;b&#39;&lt;/script&gt;");
  EXPECT_EQ(xml_text("\u6F22 \U0001F642"), "\u6F22 \U0001F642");
  EXPECT_EQ(xml_text("]]>"), "]]&gt;");
  EXPECT_EQ(xml_text("a\uFFFEb\uFFFF"), "a\uFFFDb\uFFFD");
}

TEST(ChartText, HasNumbersOfAtMostTwoDecimals) {
  EXPECT_EQ(short_number(160), "160");
  EXPECT_EQ(short_number(100), "100");
  EXPECT_EQ(short_number(133.332), "133.33");
  EXPECT_EQ(short_number(5.7), "5.7");
  EXPECT_EQ(short_number(0), "0");
  EXPECT_EQ(short_number(0.005), "0.01");
  EXPECT_EQ(short_number(0.0049), "<0.01");
}

TEST(ChartText, HasMeasuredFiguresOfOneDecimal) {
  EXPECT_EQ(measured(0), "0");
  EXPECT_EQ(measured(0.0499), "<0.1");
  EXPECT_EQ(measured(0.05), "0.1");
  EXPECT_EQ(measured(7.7), "7.7");
  EXPECT_EQ(measured(160), "160.0");
  EXPECT_EQ(rate_text(18.5959), "18.60");
  EXPECT_EQ(rate_text(99.99), "99.99");
  EXPECT_EQ(rate_text(100), "100.0");
}

TEST(ChartText, GroupsCountsFrom10000On) {
  EXPECT_EQ(grouped(0), "0");
  EXPECT_EQ(grouped(9999), "9999");
  EXPECT_EQ(grouped(10000), "10,000");
  EXPECT_EQ(grouped(307200), "307,200");
  EXPECT_EQ(grouped(67108864), "67,108,864");
}

}  // namespace
}  // namespace stereotlm::report
