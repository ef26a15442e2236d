#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "platform/config/board_yaml.h"
#include "tests/unit/platform/config/board_files.h"

namespace stereotlm::platform::testing {
namespace {

using Names = std::vector<std::string>;

TEST(BoardSet, ReplacesAValueOfAPresetOrAFile) {
  BoardConfig expected;
  expected.name = "mine";
  expected.image.width = 320;
  expected.allocation.disparity = {"bank0", "bank0"};
  expected.banks[0].kind = memory::BankKind::kZbtFlowThrough;
  const Names sets = {"name=mine", "image.width=320", "allocation.disparity=[bank0, bank0]",
                      "ssram.banks.bank0.kind=zbt_flow_through"};
  EXPECT_EQ(load_board("fpl2003", sets), expected);
  EXPECT_EQ(load_text("extends: fpl2003\nimage: {width: 640}\n", sets), expected);
  for (BankConfig& bank : expected.banks) bank.words = load_text(block_board()).banks[0].words;
  expected.pci.load = load_text(block_board()).pci.load;
  EXPECT_EQ(load_text(block_board(), sets), expected);
}

TEST(BoardSet, ReplacesTheWholeValue) {
  EXPECT_EQ(load_board("fpl2003", {"image={width: 320, height: 240}"}).image.width, 320);
  EXPECT_EQ(refusal_of_board("fpl2003", {"image={width: 320}"}),
            "--set image: image.height: missing: 1..8192");
  EXPECT_EQ(refusal_of(block_board(), {"image={width: 320}"}), "--set image: image.height: missing: 1..8192");
  EXPECT_EQ(load_board("fpl2003", {"ssram.banks={a: {}, b: {words: 9}}", "allocation.left_image=a",
                                   "allocation.right_image=a", "allocation.disparity=a",
                                   "allocation.left_lut=none", "allocation.right_lut=none"})
                .banks.size(),
            2U);
  EXPECT_EQ(refusal_of_board("fpl2003", {"matcher.filter={shift: 3}"}),
            "--set matcher.filter: matcher.filter.kernel: missing: a square list of lists, 3..31, odd rows, "
            "entries -32768..32767, sum 0");
}

TEST(BoardSet, AddsValuesThatTheBoardDoesNotHave) {
  const BoardConfig board = load_board("fpl2003", {"ssram.banks.bank9={}", "ssram.banks.bank8.words=1"});
  ASSERT_EQ(board.banks.size(), 10U);
  EXPECT_EQ(board.banks[8].name, "bank9");
  EXPECT_EQ(board.banks[9].name, "bank8");
  EXPECT_EQ(board.banks[9].words, 1);
  EXPECT_EQ(load_board("fpl2003", {"ssram.default.kind=sync_burst", "ssram.default.turnaround_cycles=3"})
                .banks[7]
                .turnaround_cycles,
            3);
  EXPECT_EQ(load_board("fpl2003", {"pci.load={burst_words: 32, interval_us: 10}"}).pci.load,
            (PciLoadConfig{32, 10, 0, 0}));
  EXPECT_EQ(load_board("fpl2003", {"pci.load.burst_words=8", "pci.load.interval_us=10"}).pci.load,
            (PciLoadConfig{8, 10, 0, 0}));
  EXPECT_EQ(refusal_of_board("fpl2003", {"pci.load.burst_words=8"}),
            "--set pci.load.burst_words: pci.load.interval_us: missing: 0..1000000000");
  std::string text = block_board();
  const std::size_t image = text.find("image:");
  text.erase(image, text.find("cameras:") - image);
  EXPECT_EQ(load_text(text, {"image.width=8", "image.height=9"}).image.height, 9);
  EXPECT_EQ(refusal_of(text, {"image.width=8"}), "--set image.width: image.height: missing: 1..8192");
}

TEST(BoardSet, IsAppliedInOrder) {
  EXPECT_EQ(load_board("fpl2003", {"image.width=8", "image={width: 320, height: 240}"}).image.width, 320);
  EXPECT_EQ(load_board("fpl2003", {"image={width: 320, height: 240}", "image.width=8"}).image.width, 8);
  EXPECT_EQ(load_board("fpl2003", {"matcher.filter={kernel: [[0, 0, 0], [1, -2, 1], [0, 0, 0]], shift: 0}",
                                   "matcher.filter.shift=5"})
                .matcher.filter->shift,
            5);
}

TEST(BoardSet, NamesAProblemOfSeveralElementsOfAListOnce) {
  EXPECT_EQ(
      refusal_of_board("fpl2003", {"allocation.disparity=[bank9, bankx, bank9]"}),
      "--set allocation.disparity: allocation.disparity = bank9: not a bank of this board; nearest: bank0\n"
      "--set allocation.disparity: allocation.disparity = bankx: not a bank of this board; nearest: bank0");
}

TEST(BoardSet, IsCheckedOnceAtTheEnd) {
  EXPECT_EQ(
      load_board("fpl2003", {"capture.fifo_words=8", "capture.fifo_trigger_words=8"}).capture.fifo_words, 8);
  EXPECT_EQ(load_text("extends: fpl2003\nimage: {width: 3}\n", {"image.width=4"}).image.width, 4);
  EXPECT_EQ(refusal_of("extends: fpl2003\nimage: {height: 0}\n", {"image.width=3", "pci.clock_mhz=0"}),
            "board.yaml:2:17: image.height = 0: 1..8192\n"
            "--set image.width: image.width = 3: 4..8192, a multiple of 4\n"
            "--set pci.clock_mhz: pci.clock_mhz = 0: 1..1000");
}

TEST(BoardSet, IsNamedWhereItBreaksARuleWithOtherValues) {
  EXPECT_EQ(refusal_of(block_board(), {"capture.fifo_words=31"}),
            "--set capture.fifo_words: capture.fifo_trigger_words = 32: 1..fifo_words, which is 31");
  EXPECT_EQ(
      refusal_of_board("fpl2003", {"allocation.left_lut=bank9"}),
      "--set allocation.left_lut: allocation.left_lut = bank9: not a bank of this board; nearest: bank0");
  EXPECT_EQ(
      refusal_of_board("fpl2003", {"allocation.left_lut=bank7"}),
      "--set allocation.left_lut: ssram.banks.bank7.words = 524288: 90112 words missing, its buffers "
      "(left_lut, right_lut) need 614400; set fpga.tables to joint, or give the bank more words, or one of "
      "the tables another bank");
  EXPECT_EQ(refusal_of_board("two-banks", {"fpga.tables=separate"}).substr(0, 77),
            "--set fpga.tables: ssram.banks.bank0.words = 524288: 90112 words missing, its");
  EXPECT_EQ(
      refusal_of_board("fpl2003", {"image.width=2052"}),
      "--set image.width: image.width = 2052: at most 2048 with a look-up table; set allocation.left_lut and "
      "allocation.right_lut to none, or a smaller image");
  EXPECT_EQ(refusal_of_board("fpl2003", {"allocation.left_image=bank0"}),
            "--set allocation.left_image: allocation.right_image = [bank2, bank3]: must be as long as "
            "left_image, which is "
            "[bank0]");
  EXPECT_EQ(refusal_of_board("fpl2003", {"ssram.default.kind=sync_burst"}),
            "--set ssram.default.kind: ssram.default.turnaround_cycles: missing: 1..16; required where the "
            "kind is sync_burst, refused beside another");
  EXPECT_EQ(
      refusal_of_board("fpl2003", {"ssram.banks.bank3.kind=sync_burst"}),
      "--set ssram.banks.bank3.kind: ssram.banks.bank3.turnaround_cycles: missing: 1..16; required where "
      "the kind is sync_burst, refused beside another");
  EXPECT_EQ(
      refusal_of_board("fpl2003-syncburst", {"ssram.default={words: 524288, kind: sync_burst}"}),
      "--set ssram.default: ssram.default.turnaround_cycles: missing: 1..16; required where the kind is "
      "sync_burst, refused beside another");
  EXPECT_EQ(
      refusal_of_board("fpl2003-syncburst", {"ssram.default.kind=zbt_flow_through"}),
      "--set ssram.default.kind: ssram.default.turnaround_cycles = 2: only where the kind is sync_burst, and "
      "it is zbt_flow_through");
}

TEST(BoardSet, RefusesExtendsBadBankNamesAndTheSamePathTwice) {
  EXPECT_EQ(
      refusal_of_board("fpl2003", {"extends=fpl2003", "ssram.banks.9={}", "image.width=4", "image.width=4"}),
      "--set extends: extends = fpl2003: extends can only be given in the board file\n"
      "--set ssram.banks.9: ssram.banks.9 = {}: a bank's name is [A-Za-z][A-Za-z0-9_-]*, and not none\n"
      "--set image.width: image.width = 4: the same path was set before");
}

TEST(BoardSet, NamesTheNearestKeyForAnUnknownPath) {
  EXPECT_EQ(refusal_of_board("fpl2003", {"imge.width=4", "=4", "image..width=4", " image.width=4"}),
            "--set imge.width: imge.width = 4: unknown key; nearest known key: image.width\n"
            "--set :  = 4: unknown key, and no known key is near\n"
            "--set image..width: image..width = 4: unknown key; nearest known key: image.width\n"
            "--set  image.width:  image.width = 4: unknown key; nearest known key: image.width");
}

TEST(BoardSet, DoesNotAddressElementsOfAList) {
  EXPECT_EQ(
      refusal_of_board("fpl2003", {"allocation.disparity.0=bank1", "allocation.disparity[0]=bank1"}),
      "--set allocation.disparity.0: allocation.disparity.0 = bank1: allocation.disparity has no keys below "
      "it\n"
      "--set allocation.disparity[0]: allocation.disparity[0] = bank1: unknown key; nearest known key: "
      "allocation.disparity");
}

TEST(BoardSet, RefusesAPathBelowAValueThatIsNoMap) {
  EXPECT_EQ(
      refusal_of_board("fpl2003", {"matcher.filter.shift=5"}),
      "--set matcher.filter.shift: matcher.filter.shift = 5: matcher.filter is not a map here; set it as a "
      "whole");
  EXPECT_EQ(
      refusal_of("extends: fpl2003\npci: {load: none}\n", {"pci.load.burst_words=8"}),
      "--set pci.load.burst_words: pci.load.burst_words = 8: pci.load is not a map here; set it as a whole");
  EXPECT_EQ(refusal_of("extends: fpl2003\nimage: 5\n", {"image.width=4"}),
            "board.yaml:2:8: image = 5: a map of width, height\n"
            "--set image.width: image.width = 4: image is not a map here; set it as a whole");
}

TEST(BoardSet, NeedsAPathAndAValue) {
  EXPECT_EQ(refusal_of_board("fpl2003", {"image.width"}),
            "--set image.width: image.width = (nothing): --set needs path=value");
  EXPECT_EQ(refusal_of_board("fpl2003", {""}), "--set :  = (nothing): --set needs path=value");
}

TEST(BoardSet, TakesOneFlowValue) {
  const std::string rule = ": one YAML flow value, such as 3, [a, b] or {a: 1}";
  for (const std::string value : {"", " ", "bank0, bank1", "width: 3", "# comment"}) {
    EXPECT_EQ(refusal_of_board("fpl2003", {"image=" + value}),
              fmt::format("--set image: image = {}{}", value, rule));
  }
  EXPECT_EQ(refusal_of_board("fpl2003", {"image.width=[1"}),
            "--set image.width: image.width = [1: not YAML: found the end, expected a comma or the ] of a "
            "list that began with [");
  EXPECT_NE(refusal_of_board("fpl2003", {"image.width=4] , [5"}), "");
  EXPECT_NE(refusal_of_board("fpl2003", {"image.width=4]\n---\n[5"}), "");
  EXPECT_NE(refusal_of_board("fpl2003", {"image=- 3"}), "");
  EXPECT_EQ(refusal_of_board("fpl2003", {"name=\xFF"}).substr(0, 13), "--set name: n");
  EXPECT_EQ(load_board("fpl2003", {"name=a=b"}).name, "a=b");
  EXPECT_EQ(load_board("fpl2003", {"matcher.lr_tolerance=off", "matcher.filter=none"}).matcher.lr_tolerance,
            std::nullopt);
}

}  // namespace
}  // namespace stereotlm::platform::testing
