#include "sw/report/chart/memory_chart.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <tuple>

#include "sw/report/chart/chart_text.h"
#include "tests/unit/sw/report/chart/random_chart.h"

namespace stereotlm::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(MemoryChart, HasAnIdForEachElement) {
  const std::string svg = memory_chart_svg({}, ChartExtent::kComputer);
  for (const char* id :
       {"bank-bank0", "port-left_lut", "stage-matcher", "stage-lr_check", "part-pci", "part-host_memory",
        "edge-left_lut-bank6", "edge-local_bus-host", "flow-left_pixel-left_lane"})
    EXPECT_THAT(svg, HasSubstr(std::string("id=\"") + id + '"'));
  EXPECT_THAT(svg, HasSubstr("data-from=\"port-left_lut\" data-to=\"bank-bank6\" data-peak=\"160\">"));
}

TEST(MemoryChart, HasTheWholeNumberOfEachLinkOfARun) {
  test::SplitMix64 random(7);
  ChartTraffic traffic = random_chart_traffic({}, ChartExtent::kBoard, random);
  traffic.megabytes_per_second["edge-left_lut-bank6"] = 158.9636822785;
  const std::string svg = memory_chart_svg({}, traffic);
  EXPECT_THAT(svg, HasSubstr("data-peak=\"160\" data-mbps=\"158.9636822785\">"));
  EXPECT_THAT(svg, HasSubstr(">159.0</text>"));
  EXPECT_THAT(
      svg, HasSubstr("left_lut - bank6: 159.0 of 160 MB/s (99.4 %)\nmean while the core works on a frame"));
  EXPECT_THAT(svg, Not(HasSubstr("part-pci")));
}

TEST(MemoryChart, ColoursABankAndItsBarByHowBusyItIs) {
  test::SplitMix64 random(7);
  ChartTraffic traffic = random_chart_traffic({}, ChartExtent::kBoard, random);
  for (const auto& [percent, colour, width] :
       {std::tuple(99.8, "load4", "147.7"), std::tuple(50.0, "load3", "74"),
        std::tuple(24.9, "load1", "36.85"), std::tuple(0.0, "load0", "0")}) {
    traffic.busy_percent["bank-bank0"] = percent;
    std::string svg = memory_chart_svg({}, traffic);
    svg.erase(0, svg.find("id=\"bank-bank0\""));
    svg.erase(svg.find("</g>"));
    const std::string fill = std::string("class=\"fill-") + colour + '"';
    EXPECT_THAT(svg, HasSubstr("rx=\"4\" " + fill)) << percent;
    EXPECT_THAT(svg, HasSubstr(" fill-opacity=\"0.2\"/>")) << "the whole bank";
    EXPECT_THAT(svg, HasSubstr(std::string("width=\"") + width + "\" height=\"8\" rx=\"2\" " + fill))
        << "of 148";
    EXPECT_THAT(svg, HasSubstr(">busy " + measured(percent) + " %</text>"));
    EXPECT_THAT(svg, HasSubstr("rx=\"0\" class=\"fill-used stroke-memory\"")) << "words";
  }
}

TEST(MemoryChart, ShowsNamesAsText) {
  platform::BoardConfig board;
  board.name = "<script>alert(\"1\")</script>";
  const std::string bank = "\"><script>'&";
  board.banks[6].name = bank;
  board.allocation.left_lut = bank;
  const std::string svg = memory_chart_svg(board, ChartExtent::kBoard);
  EXPECT_THAT(svg, Not(HasSubstr("<script")));
  EXPECT_THAT(svg, HasSubstr(">&lt;script&gt;alert(&quot;1&quot;)&lt;/script&gt;</text>"));
  EXPECT_THAT(svg, HasSubstr("id=\"edge-left_lut-&quot;&gt;&lt;script&gt;&#39;&amp;\""));
}

// A viewer without CSS variables takes the attributes, and one that has them either theme.
TEST(MemoryChart, HasEachColourAsAttributeAndAsVariableOfBothThemes) {
  const std::string svg = memory_chart_svg({}, ChartExtent::kComputer);
  EXPECT_THAT(svg, HasSubstr("class=\"fill-memory stroke-line\" fill=\"#f1ebfb\" stroke=\"#59636e\""));
  const std::string rules = svg.substr(0, svg.find("</style>"));
  const auto count = [&rules](const std::string& text) {
    int found = 0;
    for (std::size_t at = rules.find(text); at != std::string::npos; at = rules.find(text, at + 1)) ++found;
    return found;
  };
  EXPECT_EQ(count("--mc-memory: #f1ebfb;"), 2) << "light, and print";
  EXPECT_EQ(count("--mc-memory: #2c2440;"), 2) << "dark, and forced dark";
  EXPECT_EQ(count("fill: var(--mc-memory)"), 1);
  EXPECT_EQ(rules.find("var("), rules.find("@supports (color: var(") + 18)
      << "only where variables are known";
}

}  // namespace
}  // namespace stereotlm::report
