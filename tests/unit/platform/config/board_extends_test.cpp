#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "platform/config/board_yaml.h"
#include "tests/unit/platform/config/board_files.h"

namespace stereotlm::platform::testing {
namespace {

using Names = std::vector<std::string>;

TEST(BoardPresets, AreTheBoardsOfThisProject) {
  EXPECT_EQ(preset_names(), (Names{"fpl2003", "fpl2003-no-calibration", "fpl2003-line-buffer", "fpl2003-qvga",
                                   "fpl2003-syncburst", "fpl2003-triple", "four-rows", "half-the-modules",
                                   "two-banks", "two-banks-four-rows", "eight-banks-four-lanes",
                                   "seven-banks-130", "sdram", "wvga-60hz", "megapixel-pci64"}));
  for (const std::string& name : preset_names()) {
    EXPECT_EQ(load_board(name).name, name);
    EXPECT_NE(std::string(preset_text(name)).find("name: " + name + '\n'), std::string::npos);
  }
  EXPECT_THROW(preset_text("fpl2004"), std::out_of_range);
}

TEST(BoardPresets, AreTheDefaultBoardConfigWithAFewChanges) {
  EXPECT_EQ(load_board("fpl2003"), BoardConfig());
  const std::string line_buffer = "matcher.fetch=line_buffer";
  const Names triple = {"ssram.banks.bank8={}", "ssram.banks.bank9={}",
                        "allocation.left_image=[bank0, bank1, bank8]",
                        "allocation.right_image=[bank2, bank3, bank9]"};
  const std::vector<std::pair<std::string, Names>> presets = {
      {"fpl2003-no-calibration", {"allocation.left_lut=none", "allocation.right_lut=none"}},
      {"fpl2003-line-buffer", {line_buffer}},
      {"fpl2003-qvga", {"image={width: 320, height: 240}"}},
      {"fpl2003-syncburst", {"ssram.default={words: 524288, kind: sync_burst, turnaround_cycles: 2}"}},
      {"fpl2003-triple", triple},
      {"four-rows", {"matcher.rows=4"}},
      {"half-the-modules", {"matcher.units=40"}},
      {"wvga-60hz", {"image={width: 752, height: 480}", "cameras.frame_rate_hz=60", line_buffer}},
      {"megapixel-pci64",
       {"image={width: 1280, height: 960}", "cameras.frame_rate_hz=30", "pci.clock_mhz=66.667",
        "pci.width_bits=64", "ssram.default.words=2097152", line_buffer}}};
  for (const auto& [name, changes] : presets) {
    Names sets = changes;
    sets.push_back("name=" + name);
    EXPECT_EQ(load_board(name), load_board("fpl2003", sets)) << name;
  }
  BoardConfig two_banks;
  two_banks.name = "two-banks";
  two_banks.fpga.joint_tables = true;
  two_banks.fpga.pixel_cache = fpga::PixelCache::kWord;
  auto& priority = two_banks.fpga.arbiter.priority;
  std::rotate(priority.begin(), priority.begin() + 1, priority.end());  // the host comes last
  two_banks.banks.resize(2);
  const std::vector<BufferBanks> pictures = {"bank1", "bank1"};
  two_banks.allocation = {pictures, pictures, pictures, "bank0", "bank0"};
  EXPECT_EQ(load_board("two-banks"), two_banks);
  EXPECT_EQ(load_board("two-banks-four-rows"),
            load_board("two-banks", {"name=two-banks-four-rows", "matcher.rows=4"}));
}

TEST(BoardExtends, SuppliesWhatTheFileLeavesOutMapByMap) {
  EXPECT_EQ(load_text("extends: fpl2003-qvga").name, "fpl2003-qvga");
  BoardConfig expected = load_board("fpl2003-syncburst");
  expected.image.width = 320;
  for (BankConfig& bank : expected.banks) bank.turnaround_cycles = 3;
  EXPECT_EQ(
      load_text(
          "extends: fpl2003-syncburst\nimage: {width: 320}\nssram: {default: {turnaround_cycles: 3}}\n"),
      expected);
}

TEST(BoardExtends, TakesBanksFiltersAndListsWhole) {
  const BoardConfig board = load_text(
      "extends: fpl2003\n"
      "ssram: {banks: {z: {words: 2000000}, a: {}, m: {kind: zbt_flow_through}}}\n"
      "allocation: {left_image: z, right_image: [z], disparity: [a, m, z], left_lut: z, right_lut: none}\n");
  ASSERT_EQ(board.banks.size(), 3U);
  EXPECT_EQ(board.banks[0].name, "z");
  EXPECT_EQ(board.banks[0].words, 2000000);
  EXPECT_EQ(board.banks[1].name, "a");
  EXPECT_EQ(board.banks[1].words, 524288);
  EXPECT_EQ(board.banks[2].kind, memory::BankKind::kZbtFlowThrough);
  EXPECT_EQ(board.allocation.left_image, (std::vector<BufferBanks>{"z"}));
  EXPECT_EQ(board.allocation.disparity, (std::vector<BufferBanks>{"a", "m", "z"}));
  EXPECT_EQ(
      refusal_of("extends: fpl2003\nmatcher: {filter: {shift: 5}}\n"),
      "board.yaml:2:11: matcher.filter.kernel: missing: a square list of lists, 3..31, odd rows, entries "
      "-32768..32767, sum 0");
}

TEST(BoardExtends, NamesAPreset) {
  const std::string presets =
      "; presets: fpl2003, fpl2003-no-calibration, fpl2003-line-buffer, fpl2003-qvga, fpl2003-syncburst, "
      "fpl2003-triple, four-rows, half-the-modules, two-banks, two-banks-four-rows, "
      "eight-banks-four-lanes, seven-banks-130, sdram, wvga-60hz or "
      "megapixel-pci64";
  // Without its preset nothing is said about keys that it would have supplied.
  EXPECT_EQ(refusal_of("extends: fpl2003-tripel\nimage: {width: 5}\n"),
            "board.yaml:1:10: extends = fpl2003-tripel: not a preset; nearest: fpl2003-triple" + presets +
                "\nboard.yaml:2:16: image.width = 5: 4..8192, a multiple of 4");
  EXPECT_EQ(refusal_of("extends: ./fpl2003.yaml\n"),
            "board.yaml:1:10: extends = ./fpl2003.yaml: not a preset" + presets);
  for (const std::string value : {"null", "[fpl2003]", "{a: b}"}) {
    EXPECT_EQ(refusal_of("extends: " + value),
              fmt::format("board.yaml:1:10: extends = {}: not a preset{}", value, presets));
  }
}

TEST(BoardExtends, IsAdvisedForAFileThatLacksMostKeys) {
  const auto line = [](int missing) {
    return fmt::format(
        "board.yaml:1:1: {} of the 36 keys of a board are missing: begin the file with "
        "`extends: fpl2003`, which supplies them",
        missing);
  };
  EXPECT_EQ(refusal_of("image: {width: 640}\n"), line(35));
  EXPECT_EQ(refusal_of("matcher: {}\nssram: {banks: {a: {}}}\n"), line(35));
  EXPECT_EQ(refusal_of("extend: fpl2003\nimage: {width: 5}\n", {"fpga.clock_mhz=0"}),
            line(34) +
                "\nboard.yaml:1:1: extend = fpl2003: unknown key; nearest known key: extends\n"
                "board.yaml:2:16: image.width = 5: 4..8192, a multiple of 4\n"
                "--set fpga.clock_mhz: fpga.clock_mhz = 0: 1..1000");
  EXPECT_EQ(refusal_of("extends: fpl2003\nmatcher: {filter: {}}\n").find("of a board are missing"),
            std::string::npos);
}

TEST(BoardExtends, IsTheFirstKeyAndAppearsOnce) {
  EXPECT_EQ(refusal_of("name: x\nextends: fpl2003\n"),
            "board.yaml:2:1: extends = fpl2003: extends must be the first key");
  EXPECT_EQ(refusal_of("extends: fpl2003\nname: x\nextends: fpl2003\n"),
            "board.yaml:3:1: extends = fpl2003: repeated key");
  EXPECT_EQ(refusal_of("extends: fpl2003\nimage: {extends: fpl2003}\n").substr(0, 52),
            "board.yaml:2:9: image.extends = fpl2003: unknown key");
}

TEST(BoardExtends, PointsAtTheFilesValueWhereItBreaksARuleWithThePresets) {
  EXPECT_EQ(refusal_of("extends: fpl2003\ncapture: {fifo_words: 31}\n"),
            "board.yaml:2:23: capture.fifo_trigger_words = 32: 1..fifo_words, which is 31");
  EXPECT_EQ(refusal_of("extends: fpl2003\ncapture: {fifo_words: 32}\n"), "");
  EXPECT_EQ(refusal_of("extends: fpl2003\ncapture: {fifo_trigger_words: 141}\n"),
            "board.yaml:2:31: capture.fifo_trigger_words = 141: 1..fifo_words, which is 140");
  EXPECT_EQ(refusal_of("extends: fpl2003\nallocation: {left_image: bank0}\n"),
            "board.yaml:2:26: allocation.right_image = [bank2, bank3]: must be as long as left_image, which "
            "is [bank0]");
  EXPECT_EQ(
      refusal_of("extends: fpl2003\nimage: {width: 2048, height: 257}\n"),
      "board.yaml:2:16: ssram.banks.bank6.words = 524288: 2048 words missing, its buffers (left_lut) need "
      "526336\n"
      "board.yaml:2:16: ssram.banks.bank7.words = 524288: 2048 words missing, its buffers (right_lut) need "
      "526336");
  EXPECT_EQ(refusal_of("extends: fpl2003\nimage: {width: 2048, height: 256}\n"), "");
  EXPECT_EQ(
      refusal_of("extends: fpl2003\nssram: {banks: {bank0: {}}}\nallocation: {disparity: bank0}\n")
          .substr(0, 98),
      "board.yaml:2:16: allocation.left_image = bank1: not a bank of this board; nearest: bank0\nboard.yam");
  // The preset's turnaround_cycles is inherited, and has no effect.
  EXPECT_EQ(refusal_of("extends: fpl2003-syncburst\nssram:\n  default: {kind: zbt_pipelined}\n"), "");
}

}  // namespace
}  // namespace stereotlm::platform::testing
