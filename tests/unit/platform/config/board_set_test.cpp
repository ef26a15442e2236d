#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "platform/config/board_yaml.h"
#include "tests/unit/platform/config/board_files.h"

namespace stereotlm::platform::testing {
namespace {

using Names = std::vector<std::string>;

// Expects that a preset with these sets is refused with the message.
void expect_refused(const Names& sets, const std::string& message, const std::string& board = "fpl2003") {
  EXPECT_EQ(refusal_of_board(board, sets), message);
}

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
  expect_refused({"image={width: 320}"}, "--set image: image.height: missing: 1..8192");
  EXPECT_EQ(load_board("fpl2003", {"ssram.banks={a: {}, b: {words: 9}}", "allocation.left_image=a",
                                   "allocation.right_image=a", "allocation.disparity=a",
                                   "allocation.left_lut=none", "allocation.right_lut=none"})
                .banks.size(),
            2U);
  expect_refused({"matcher.filter={shift: 3}"},
                 "--set matcher.filter: matcher.filter.kernel: missing: a square list of lists, 3..31, odd "
                 "rows, entries -32768..32767, sum 0");
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
  EXPECT_EQ(load_board("fpl2003", {"pci.load.burst_words=8", "pci.load.interval_us=10"}),
            load_board("fpl2003", {"pci.load={burst_words: 8, interval_us: 10}"}));
  expect_refused({"pci.load.burst_words=8"},
                 "--set pci.load.burst_words: pci.load.interval_us: missing: 0..1000000000");
  std::string text = block_board();
  const std::size_t image = text.find("image:");
  text.erase(image, text.find("cameras:") - image);
  EXPECT_EQ(load_text(text, {"image.width=8", "image.height=9"}).image.height, 9);
  EXPECT_EQ(refusal_of(text, {"image.width=8"}), "--set image.width: image.height: missing: 1..8192");
}

TEST(BoardSet, IsAppliedInOrderAndCheckedOnceAtTheEnd) {
  EXPECT_EQ(load_board("fpl2003", {"image.width=8", "image={width: 320, height: 240}"}).image.width, 320);
  EXPECT_EQ(load_board("fpl2003", {"image={width: 320, height: 240}", "image.width=8"}).image.width, 8);
  EXPECT_EQ(
      load_board("fpl2003", {"capture.fifo_words=8", "capture.fifo_trigger_words=8"}).capture.fifo_words, 8);
  EXPECT_EQ(load_text("extends: fpl2003\nimage: {width: 3}\n", {"image.width=4"}).image.width, 4);
  EXPECT_EQ(refusal_of("extends: fpl2003\nimage: {height: 0}\n", {"image.width=3", "pci.clock_mhz=0"}),
            "board.yaml:2:17: image.height = 0: 1..8192\n"
            "--set image.width: image.width = 3: 4..8192, a multiple of 4\n"
            "--set pci.clock_mhz: pci.clock_mhz = 0: 1..1000");
}

TEST(BoardSet, IsNamedWhereItBreaksARuleWithOtherValues) {
  expect_refused({"allocation.left_lut=bank9"},
                 "--set allocation.left_lut: allocation.left_lut = bank9: not a bank of this board; nearest: "
                 "bank0");
  expect_refused({"allocation.left_lut=bank7"},
                 "--set allocation.left_lut: ssram.banks.bank7.words = 524288: 90112 words missing, its "
                 "buffers (left_lut, right_lut) need 614400; set fpga.tables to joint, or give the bank more "
                 "words, or one of the tables another bank");
  EXPECT_EQ(refusal_of_board("two-banks", {"fpga.tables=separate"}).substr(0, 77),
            "--set fpga.tables: ssram.banks.bank0.words = 524288: 90112 words missing, its");
  expect_refused({"allocation.left_image=bank0"},
                 "--set allocation.left_image: allocation.right_image = [bank2, bank3]: must be as long as "
                 "left_image, which is [bank0]");
  const std::string missing =
      "turnaround_cycles: missing: 1..16; required where the kind is sync_burst, refused beside another";
  expect_refused({"ssram.default.kind=sync_burst"}, "--set ssram.default.kind: ssram.default." + missing);
  expect_refused({"ssram.banks.bank3.kind=sync_burst"},
                 "--set ssram.banks.bank3.kind: ssram.banks.bank3." + missing);
  expect_refused({"ssram.default={words: 524288, kind: sync_burst}"},
                 "--set ssram.default: ssram.default." + missing, "fpl2003-syncburst");
  expect_refused({"ssram.default.kind=zbt_flow_through"},
                 "--set ssram.default.kind: ssram.default.turnaround_cycles = 2: only where the kind is "
                 "sync_burst, and it is zbt_flow_through",
                 "fpl2003-syncburst");
  // Two elements of a list have the same problem and the same place.
  expect_refused({"allocation.disparity=[bank9, bankx, bank9]"},
                 "--set allocation.disparity: allocation.disparity = bank9: not a bank of this board; "
                 "nearest: bank0\n"
                 "--set allocation.disparity: allocation.disparity = bankx: not a bank of this board; "
                 "nearest: bank0");
}

TEST(BoardSet, NamesWhatIsWrongWithItsPath) {
  const std::vector<std::pair<std::string, std::string>> refusals = {
      {"extends=fpl2003", "extends can only be given in the board file"},
      {"ssram.banks.9={}", "a bank's name is [A-Za-z][A-Za-z0-9_-]*, and not none"},
      {"imge.width=4", "unknown key; nearest known key: image.width"},
      {"=4", "unknown key, and no known key is near"},
      {"image..width=4", "unknown key; nearest known key: image.width"},
      {" image.width=4", "unknown key; nearest known key: image.width"},
      {"allocation.disparity.0=bank1", "allocation.disparity has no keys below it"},
      {"allocation.disparity[0]=bank1", "unknown key; nearest known key: allocation.disparity"},
      {"matcher.filter.shift=5", "matcher.filter is not a map here; set it as a whole"},
      {"image.width", "--set needs path=value"},
      {"", "--set needs path=value"}};
  for (const auto& [set, rule] : refusals) {
    const std::size_t equals = set.find('=');
    const std::string path = set.substr(0, equals);
    const std::string value = equals == std::string::npos ? "(nothing)" : set.substr(equals + 1);
    expect_refused({set}, fmt::format("--set {0}: {0} = {1}: {2}", path, value, rule));
  }
  expect_refused({"image.width=4", "image.width=4"},
                 "--set image.width: image.width = 4: the same path was set before");
  EXPECT_EQ(refusal_of("extends: fpl2003\nimage: 5\n", {"image.width=4"}),
            "board.yaml:2:8: image = 5: a map of width, height\n"
            "--set image.width: image.width = 4: image is not a map here; set it as a whole");
}

TEST(BoardSet, TakesOneFlowValue) {
  for (const std::string value : {"", " ", "bank0, bank1", "width: 3", "# comment"}) {
    expect_refused(
        {"image=" + value},
        fmt::format("--set image: image = {}: one YAML flow value, such as 3, [a, b] or {{a: 1}}", value));
  }
  expect_refused({"image.width=[1"},
                 "--set image.width: image.width = [1: not YAML: found the end, expected a comma or the ] of "
                 "a list that began with [");
  for (const std::string set : {"image.width=4] , [5", "image.width=4]\n---\n[5", "image=- 3"})
    EXPECT_NE(refusal_of_board("fpl2003", {set}), "") << set;
  EXPECT_EQ(refusal_of_board("fpl2003", {"name=\xFF"}).substr(0, 13), "--set name: n");
  EXPECT_EQ(load_board("fpl2003", {"name=a=b"}).name, "a=b");
  EXPECT_EQ(load_board("fpl2003", {"matcher.lr_tolerance=off"}).matcher.lr_tolerance, std::nullopt);
}

}  // namespace
}  // namespace stereotlm::platform::testing
