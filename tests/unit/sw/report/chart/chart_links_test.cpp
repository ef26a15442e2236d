#include "sw/report/chart/chart_links.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "platform/config/board_yaml.h"

namespace stereotlm::report {
namespace {

using platform::load_board;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

std::vector<std::string> ids(const std::vector<ChartLink>& links) {
  std::vector<std::string> all;
  for (const ChartLink& link : links) all.push_back(link.id());
  return all;
}

ChartLink link_of(const platform::BoardConfig& board, const std::string& id) {
  for (const ChartLink& link : chart_links({board, true})) {
    if (link.id() == id) return link;
  }
  ADD_FAILURE() << id;
  return {};
}

TEST(ChartLinks, OfABoardAloneAreThoseOfItsPorts) {
  EXPECT_THAT(ids(chart_links({load_board("fpl2003")})),
              ElementsAre("edge-left_lut-bank6", "edge-right_lut-bank7", "edge-left_pixel-bank0",
                          "edge-left_pixel-bank1", "edge-right_pixel-bank2", "edge-right_pixel-bank3",
                          "edge-result-bank4", "edge-result-bank5"));
}

TEST(ChartLinks, OfAComputerHaveItsPartsAndTheHostsPortToo) {
  EXPECT_THAT(
      ids(chart_links({load_board("two-banks"), true})),
      ElementsAre("edge-left_camera-left_capture", "edge-right_camera-right_capture", "edge-left_capture-pci",
                  "edge-right_capture-pci", "edge-cpu-pci", "edge-pci-host_memory", "edge-pci-bridge",
                  "edge-bridge-pci", "edge-bridge-local_bus", "edge-local_bus-host", "edge-left_lut-bank0",
                  "edge-left_pixel-bank1", "edge-right_pixel-bank1", "edge-result-bank1", "edge-host-bank0",
                  "edge-host-bank1"));
}

TEST(ChartLinks, LeaveOutWhatABoardDoesNotHave) {
  const auto board = load_board("fpl2003-no-calibration", {"pci.load={burst_words: 8, interval_us: 1}"});
  const std::vector<std::string> all = ids(chart_links({board, true}));
  EXPECT_THAT(all, Contains("edge-load-pci"));
  EXPECT_THAT(all, Not(Contains(HasSubstr("_lut"))));
  EXPECT_THAT(all, Not(Contains(HasSubstr("bank6")))) << "a bank without buffers";
}

TEST(ChartLinks, PointWhereTheWordsGo) {
  const auto board = load_board("fpl2003");
  const auto directions = [&](const std::string& id) {
    const ChartLink link = link_of(board, id);
    return std::string(link.there ? "there" : "") + (link.back ? "back" : "");
  };
  EXPECT_EQ(directions("edge-left_lut-bank6"), "back");
  EXPECT_EQ(directions("edge-left_pixel-bank1"), "back");
  EXPECT_EQ(directions("edge-result-bank4"), "there");
  EXPECT_EQ(directions("edge-host-bank0"), "there");
  EXPECT_EQ(directions("edge-host-bank4"), "back");
  EXPECT_EQ(directions("edge-host-bank6"), "there");
  EXPECT_EQ(directions("edge-left_capture-pci"), "there");
  EXPECT_EQ(directions("edge-bridge-local_bus"), "thereback");
}

TEST(ChartLinks, HaveThePeaksOfTheirClocks) {
  const auto board =
      load_board("fpl2003", {"pci.clock_mhz=66.667", "pci.width_bits=64", "bridge.local_clock_mhz=50",
                             "fpga.clock_mhz=20", "ssram.banks.bank0.kind=qdr"});
  EXPECT_NEAR(link_of(board, "edge-left_camera-left_capture").peak, 12.27, 0.005);
  EXPECT_DOUBLE_EQ(link_of(board, "edge-right_capture-pci").peak, 8 * 66.667);
  EXPECT_DOUBLE_EQ(link_of(board, "edge-local_bus-host").peak, 200);
  EXPECT_DOUBLE_EQ(link_of(board, "edge-left_pixel-bank0").peak, 80) << "a port makes one access a cycle";
}

}  // namespace
}  // namespace stereotlm::report
