#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "platform/config/board_yaml.h"
#include "tests/unit/platform/config/board_files.h"

namespace stereotlm::platform::testing {
namespace {

const std::string kBase = "extends: fpl2003\n";

// A board with these banks alone, all buffers of a 4x1 image (1 word each, tables 4) in `bank`.
std::string banks_board(const std::string& ssram, const std::string& bank = "a") {
  return kBase + "ssram: " + ssram + "\nimage: {width: 4, height: 1}\n" +
         fmt::format(
             "allocation: {{left_image: {0}, right_image: {0}, disparity: {0}, left_lut: {0}, right_lut: "
             "{0}}}\n",
             bank);
}

std::string board_with_load(const std::string& load) { return kBase + "pci: {load: " + load + "}\n"; }

std::string kernel_board(const std::string& filter) { return kBase + "matcher: {filter: " + filter + "}\n"; }

// m rows of m entries of one value, the last entry balancing the sum.
std::string square_kernel(int m) {
  std::string rows;
  for (int row = 0; row < m; ++row) {
    rows += row == 0 ? "[" : ", [";
    for (int column = 0; column < m; ++column) {
      const bool is_last = row + 1 == m && column + 1 == m;
      rows += fmt::format("{}{}", column == 0 ? "" : ", ", is_last ? 1 - m * m : 1);
    }
    rows += ']';
  }
  return '[' + rows + ']';
}

TEST(BoardHostRing, HasAtMostAGibibyte) {
  const auto ring = [](const std::string& destination, int pairs, const std::string& size) {
    return refusal_of(
        kBase + fmt::format("capture: {{destination: {}, host_frames: {}}}\n", destination, pairs) +
        "image: {" + size + "}\n" +
        "ssram: {default: {words: 67108864}, banks: {a: {}}}\n"
        "allocation: {left_image: a, right_image: a, disparity: a, left_lut: none, right_lut: none}\n");
  };
  EXPECT_EQ(ring("host_memory", 8, "width: 8192, height: 8192"), "");
  EXPECT_EQ(
      ring("host_memory", 9, "width: 8192, height: 8192"),
      "board.yaml:2:50: capture.host_frames = 9: at most 8 pairs of 8192x8192 pixels, because the ring in "
      "host memory may have 1024 MiB");
  EXPECT_EQ(ring("board", 64, "width: 8192, height: 8192"), "");
  EXPECT_EQ(ring("host_memory", 64, "width: 4096, height: 2048"), "");
  EXPECT_EQ(
      ring("host_memory", 64, "width: 4096, height: 2049"),
      "board.yaml:2:50: capture.host_frames = 64: at most 63 pairs of 4096x2049 pixels, because the ring "
      "in host memory may have 1024 MiB");
}

TEST(BoardBanks, TakeTheirWordsUpToBothLimits) {
  const std::string rule = "1..67108864";
  for (const std::string value : {"0", "-1", "67108865", "4294967296", "99999999999999999999"}) {
    EXPECT_EQ(refusal_of(banks_board("{default: {words: " + value + "}, banks: {a: {words: 100}}}")),
              fmt::format("board.yaml:2:26: ssram.default.words = {}: {}", value, rule));
    EXPECT_EQ(refusal_of(banks_board("{banks: {a: {words: " + value + "}}}")),
              fmt::format("board.yaml:2:28: ssram.banks.a.words = {}: {}", value, rule));
  }
  EXPECT_EQ(refusal_of(banks_board("{default: {words: 1}, banks: {a: {words: 67108864}, b: {}}}")), "");
  EXPECT_EQ(
      refusal_of(banks_board("{banks: {a: {words: 0x64}}}")),
      "board.yaml:2:28: ssram.banks.a.words = 0x64: not an integer (decimal digits, not in quotes); " + rule);
}

TEST(BoardBanks, TakeAKnownKind) {
  for (const std::string value : {"zbt", "null", "[sync_burst]", "0"}) {
    const std::string rule =
        " = " + value + ": must be one of zbt_pipelined, zbt_flow_through, sync_burst or qdr";
    EXPECT_EQ(refusal_of(banks_board("{default: {kind: " + value + "}, banks: {a: {}}}")),
              "board.yaml:2:25: ssram.default.kind" + rule);
    EXPECT_EQ(refusal_of(banks_board("{banks: {a: {kind: " + value + "}}}")),
              "board.yaml:2:27: ssram.banks.a.kind" + rule);
  }
}

TEST(BoardBanks, TakeTheirTurnaroundUpToBothLimits) {
  for (const std::string value : {"1", "16"}) {
    EXPECT_EQ(refusal_of(banks_board("{banks: {a: {kind: sync_burst, turnaround_cycles: " + value + "}}}")),
              "");
  }
  for (const std::string value : {"0", "17", "-1", "99999999999999999999"}) {
    EXPECT_EQ(refusal_of(banks_board("{banks: {a: {kind: sync_burst, turnaround_cycles: " + value + "}}}")),
              "board.yaml:2:58: ssram.banks.a.turnaround_cycles = " + value + ": 1..16");
    EXPECT_EQ(refusal_of(banks_board("{default: {kind: sync_burst, turnaround_cycles: " + value +
                                     "}, banks: {a: {}}}")),
              "board.yaml:2:56: ssram.default.turnaround_cycles = " + value + ": 1..16");
  }
}

TEST(BoardBanks, RequireATurnaroundOnlyWhereTheKindIsSyncBurst) {
  const std::string rule =
      ".turnaround_cycles: missing: 1..16; required where the kind is sync_burst, refused beside another";
  EXPECT_EQ(refusal_of(banks_board("{banks: {a: {kind: sync_burst}}}")),
            "board.yaml:2:17: ssram.banks.a" + rule);
  EXPECT_EQ(refusal_of(banks_board("{default: {kind: sync_burst}, banks: {a: {}, b: {}}}")),
            "board.yaml:2:9: ssram.default" + rule);
  EXPECT_EQ(refusal_of(banks_board("{default: {kind: sync_burst}, banks: {a: {turnaround_cycles: 1}}}")), "");
  EXPECT_EQ(
      refusal_of(banks_board(
          "{default: {kind: sync_burst, turnaround_cycles: 4}, banks: {a: {}, b: {kind: sync_burst}}}")),
      "");
  EXPECT_EQ(refusal_of(banks_board("{default: {kind: sync_burst}, banks: {a: {kind: zbt_pipelined}}}")), "");
  const std::string other = " = 2: only where the kind is sync_burst, and it is zbt_pipelined";
  EXPECT_EQ(refusal_of(banks_board("{banks: {a: {kind: zbt_pipelined, turnaround_cycles: 2}}}")),
            "board.yaml:2:61: ssram.banks.a.turnaround_cycles" + other);
  EXPECT_EQ(refusal_of(banks_board("{banks: {a: {kind: qdr, turnaround_cycles: 2}}}")),
            "board.yaml:2:51: ssram.banks.a.turnaround_cycles = 2: only where the kind is sync_burst, and it "
            "is qdr");
  EXPECT_EQ(refusal_of(banks_board("{banks: {a: {kind: qdr}}}")), "");
  EXPECT_EQ(refusal_of(banks_board("{default: {turnaround_cycles: 2}, banks: {a: {}}}")),
            "board.yaml:2:38: ssram.default.turnaround_cycles" + other);
}

TEST(BoardBanks, IgnoreATurnaroundOfAnEntryWhoseKindHasNone) {
  const BoardConfig board = load_text(banks_board("{banks: {a: {turnaround_cycles: 2}}}"));
  EXPECT_EQ(board.banks[0].kind, memory::BankKind::kZbtPipelined);
  EXPECT_EQ(board.banks[0].turnaround_cycles, 0);
  EXPECT_EQ(refusal_of(banks_board("{banks: {a: {turnaround_cycles: 17}}}")),
            "board.yaml:2:40: ssram.banks.a.turnaround_cycles = 17: 1..16");
  EXPECT_EQ(load_board("fpl2003", {"ssram.banks.bank3.turnaround_cycles=2"}), load_board("fpl2003"));
  EXPECT_EQ(
      load_board("fpl2003-syncburst", {"ssram.banks.bank3.turnaround_cycles=3"}).banks[3].turnaround_cycles,
      3);
  const BoardConfig inherits = load_text(banks_board(
      "{default: {kind: sync_burst, turnaround_cycles: 5}, banks: {a: {kind: zbt_flow_through}, b: {}}}"));
  EXPECT_EQ(inherits.banks[0].turnaround_cycles, 0);
  EXPECT_EQ(inherits.banks[1].turnaround_cycles, 5);
}

TEST(BoardBanks, AreOneToSixtyFour) {
  std::string banks = "a: {}";
  for (int i = 1; i < 64; ++i) banks += fmt::format(", b{}: {{}}", i);
  EXPECT_EQ(load_text(banks_board("{banks: {" + banks + "}}")).banks.size(), 64U);
  const std::string refusal = refusal_of(banks_board("{banks: {" + banks + ", b64: {}}}"));
  EXPECT_EQ(refusal.substr(0, 31), "board.yaml:2:16: ssram.banks = ");
  EXPECT_NE(refusal.find("65 banks; a map of 1..64 banks"), std::string::npos);
  EXPECT_EQ(refusal_of(banks_board("{banks: {}}")),
            "board.yaml:2:16: ssram.banks = {}: 0 banks; a map of 1..64 banks");
}

TEST(BoardBanks, HaveValidNamesAndKnownKeysOnce) {
  for (const std::string name : {"a", "Z9_-", "null-", "true", "\"null\"", "off"}) {
    EXPECT_EQ(refusal_of(banks_board("{banks: {" + name + ": {}}}", name)), "") << name;
  }
  for (const std::string name : {"9a", "_a", "-a", "none", "ä", "a b", "~", "null", "a/b", "[a]", "7"}) {
    EXPECT_EQ(refusal_of(banks_board("{banks: {a: {}, " + name + ": {}}}")),
              "board.yaml:2:24: ssram.banks." + name +
                  " = {}: a bank's name is [A-Za-z][A-Za-z0-9_-]*, and not none");
  }
  EXPECT_EQ(refusal_of(banks_board("{banks: {a: {}, b: {}, a: {words: 5}}}")),
            "board.yaml:2:31: ssram.banks.a = {words: 5}: repeated key, first at 2:17");
  EXPECT_EQ(refusal_of(banks_board("{banks: {a: {}, b}}")),
            "board.yaml:2:24: ssram.banks.b = (nothing): a map of words, kind, turnaround_cycles");
  EXPECT_EQ(refusal_of(banks_board("{banks: {a: {depth: 5}}}")).substr(0, 51),
            "board.yaml:2:21: ssram.banks.a.depth = 5: unknown k");
}

const std::string kTablesHint =
    "; set fpga.tables to joint, or give the bank more words, or one of the tables another bank";

TEST(BoardBanks, HoldTheirBuffers) {
  EXPECT_EQ(refusal_of(banks_board("{banks: {a: {words: 11}}}")), "");
  EXPECT_EQ(refusal_of(banks_board("{banks: {a: {words: 10}}}")),
            "board.yaml:2:28: ssram.banks.a.words = 10: 1 words missing, its buffers (left_image[0], "
            "right_image[0], disparity[0], left_lut, right_lut) need 11" +
                kTablesHint);
  EXPECT_EQ(refusal_of(banks_board("{banks: {a: {words: 7}}}")),
            "board.yaml:2:28: ssram.banks.a.words = 7: 4 words missing, its buffers (left_image[0], "
            "right_image[0], disparity[0], left_lut, right_lut) need 11" +
                kTablesHint);
  // One table more or less does not decide.
  EXPECT_EQ(refusal_of(banks_board("{banks: {a: {words: 6}}}")),
            "board.yaml:2:28: ssram.banks.a.words = 6: 5 words missing, its buffers (left_image[0], "
            "right_image[0], disparity[0], left_lut, right_lut) need 11");
  EXPECT_EQ(refusal_of(banks_board("{default: {words: 1}, banks: {a: {}}}")),
            "board.yaml:2:26: ssram.banks.a.words = 1: 10 words missing, its buffers (left_image[0], "
            "right_image[0], disparity[0], left_lut, right_lut) need 11");
}

TEST(BoardAllocation, NamesBanksOfTheBoard) {
  EXPECT_EQ(refusal_of(kBase +
                       "allocation: {disparity: [bank4, bonk5], left_lut: bank66, right_image: [x, none]}\n"),
            "board.yaml:2:33: allocation.disparity = bonk5: not a bank of this board; nearest: bank5\n"
            "board.yaml:2:51: allocation.left_lut = bank66: not a bank of this board; nearest: bank6\n"
            "board.yaml:2:73: allocation.right_image = x: not a bank of this board\n"
            "board.yaml:2:76: allocation.right_image = none: not a bank of this board");
  EXPECT_EQ(refusal_of(kBase + "allocation: {disparity: [bank4, [bank5], null]}\n"),
            "board.yaml:2:33: allocation.disparity = [bank5]: a bank, or a list of 1 to 3 banks\n"
            "board.yaml:2:42: allocation.disparity = null: a bank, or a list of 1 to 3 banks");
}

TEST(BoardAllocation, TakesABankForAListOfOneBank) {
  const std::string head = kBase + "allocation: ";
  EXPECT_EQ(
      load_text(head + "{left_image: bank0, right_image: bank2, disparity: bank4, left_lut: bank6}"),
      load_text(head + "{left_image: [bank0], right_image: [bank2], disparity: [bank4], left_lut: [bank6]}"));
}

TEST(BoardPriority, NamesEachPortOnce) {
  const std::string head = kBase + "fpga: {priority: ";
  EXPECT_EQ(
      refusal_of(head + "[host, result, left_pixel, right_pixel, left_lut]}"),
      "board.yaml:2:18: fpga.priority = [host, result, left_pixel, right_pixel, left_lut]: each port once; "
      "right_lut missing");
  EXPECT_EQ(refusal_of(head + "[]}").substr(0, 68),
            "board.yaml:2:18: fpga.priority = []: each port once; left_lut, right");
  EXPECT_EQ(refusal_of(head + "[host, result, left_pixel, right_pixel, left_lut, right_lut, host]}"),
            "board.yaml:2:79: fpga.priority = host: repeated; each port once");
  EXPECT_EQ(refusal_of(head + "[host, result, left_pixel, right_pixel, left_lut, lut]}"),
            "board.yaml:2:68: fpga.priority = lut: must be one of left_lut, right_lut, left_pixel, "
            "right_pixel, result or host");
  const BoardConfig board = load_text(head + "[right_lut, host, result, left_pixel, right_pixel, left_lut]}");
  EXPECT_EQ(board.fpga.arbiter.priority[0], fpga::lut_port(fpga::Side::kRight));
  EXPECT_EQ(board.fpga.arbiter.priority[1], fpga::kHostPort);
  EXPECT_EQ(board.fpga.arbiter.priority[5], fpga::lut_port(fpga::Side::kLeft));
}

TEST(BoardLoad, IsNoneOrAMapOfItsWordsAndTimes) {
  EXPECT_EQ(load_board("fpl2003").pci.load, std::nullopt);
  EXPECT_EQ(load_text(board_with_load("none")), load_board("fpl2003"));
  EXPECT_EQ(load_text(board_with_load("{burst_words: 8, interval_us: 10}"), {"pci.load=none"}),
            load_board("fpl2003"));
  EXPECT_EQ(load_text(board_with_load("{first_us: 0.5, burst_words: 8, access_us: 0.25, interval_us: 10}"))
                .pci.load,
            (PciLoadConfig{8, 10, 0.5, 0.25}));
  EXPECT_EQ(
      load_text(board_with_load("{burst_words: 8, interval_us: 10}"), {"pci.load.burst_words=9"}).pci.load,
      (PciLoadConfig{9, 10, 0, 0}));
}

TEST(BoardLoad, RequiresItsWordsAndItsIntervalAndRefusesOtherKeys) {
  EXPECT_EQ(refusal_of(board_with_load("{}")),
            "board.yaml:2:7: pci.load.burst_words: missing: 1..1024\n"
            "board.yaml:2:7: pci.load.interval_us: missing: 0..1000000000");
  EXPECT_EQ(refusal_of(board_with_load("{burst_words: 8, first_us: 1}")),
            "board.yaml:2:7: pci.load.interval_us: missing: 0..1000000000");
  EXPECT_EQ(
      refusal_of(board_with_load("{burst_words: 8, interval_us: 10, burst_wrods: 9, interval_us: 11}")),
      "board.yaml:2:47: pci.load.burst_wrods = 9: unknown key; nearest known key: pci.load.burst_words\n"
      "board.yaml:2:63: pci.load.interval_us = 11: repeated key, first at 2:30");
  EXPECT_EQ(refusal_of(kBase + "pci: {lode: none}\n"),
            "board.yaml:2:7: pci.lode = none: unknown key; nearest known key: pci.load");
  EXPECT_EQ(refusal_of(kBase + "pci: {load: none, load: none}\n"),
            "board.yaml:2:19: pci.load = none: repeated key, first at 2:7");
}

constexpr const char* kNoTables = "allocation: {left_lut: none, right_lut: none}\n";

TEST(BoardImage, IsLargerThan2048OnlyWithoutTables) {
  const std::string width = "image: {width: 2052, height: 1}\n";
  const std::string height = "image: {width: 4, height: 2049}\n";
  const std::string both = "allocation.left_lut and allocation.right_lut";
  const std::string rule = " with a look-up table; set ";
  const std::string end = " to none, or a smaller image";
  EXPECT_EQ(refusal_of(kBase + width),
            "board.yaml:2:16: image.width = 2052: at most 2048" + rule + both + end);
  EXPECT_EQ(refusal_of(kBase + height),
            "board.yaml:2:27: image.height = 2049: at most 2048" + rule + both + end);
  EXPECT_EQ(refusal_of(kBase + width + "allocation: {left_lut: none}\n"),
            "board.yaml:2:16: image.width = 2052: at most 2048" + rule + "allocation.right_lut" + end);
  EXPECT_EQ(refusal_of(kBase + height + "allocation: {right_lut: none}\n"),
            "board.yaml:2:27: image.height = 2049: at most 2048" + rule + "allocation.left_lut" + end);
  for (const std::string size : {"{width: 2052, height: 1}", "{width: 4, height: 2049}",
                                 "{width: 8192, height: 4}", "{width: 4, height: 8192}"})
    EXPECT_EQ(refusal_of(kBase + "image: " + size + '\n' + kNoTables), "") << size;
  EXPECT_EQ(refusal_of(kBase + "image: {width: 2048, height: 4}\n"), "");
  EXPECT_EQ(refusal_of(kBase + "image: {width: 4, height: 2048}\n"), "");
}

TEST(BoardUnits, AreAtMostTheDisparities) {
  const std::string head = kBase + "matcher: {disparities: 16, units: ";
  EXPECT_EQ(load_text(head + "16}\n").matcher.units, 16);
  EXPECT_EQ(load_text(head + "1}\n").matcher.units, 1);
  EXPECT_EQ(load_text(head + "all}\n").matcher.units, std::nullopt);
  EXPECT_EQ(load_board("fpl2003").matcher.units, std::nullopt);
  EXPECT_EQ(refusal_of(head + "17}\n"),
            "board.yaml:2:35: matcher.units = 17: 1..disparities, which is 16, or all");
  EXPECT_EQ(refusal_of(kBase + "matcher: {units: 40}\n", {"matcher.disparities=39"}),
            "--set matcher.disparities: matcher.units = 40: 1..disparities, which is 39, or all");
}

TEST(BoardRows, AreOneBehindALineBuffer) {
  const std::string head = kBase + "matcher: {fetch: line_buffer, rows: ";
  EXPECT_EQ(refusal_of(head + "1}\n"), "");
  EXPECT_EQ(refusal_of(head + "2}\n"),
            "board.yaml:2:37: matcher.rows = 2: must be 1 where matcher.fetch is line_buffer; with column it "
            "may be 1..16");
  EXPECT_EQ(refusal_of(kBase + "matcher: {rows: 2}\n"), "");
}

TEST(BoardRows, HaveAPlaceInTheResultQueueEach) {
  const auto text = [](int rows, int words) {
    return fmt::format("extends: fpl2003\nmatcher: {{rows: {}}}\nfpga: {{result_fifo_words: {}}}\n", rows,
                       words);
  };
  EXPECT_EQ(refusal_of(text(16, 16)), "");
  EXPECT_EQ(refusal_of(text(9, 8)),
            "board.yaml:3:27: fpga.result_fifo_words = 8: at least 9, a word for each of the rows that are "
            "computed at once; or fewer matcher.rows");
  EXPECT_EQ(
      refusal_of_board("fpl2003", {"matcher.rows=16"}),
      "--set matcher.rows: fpga.result_fifo_words = 8: at least 16, a word for each of the rows that are "
      "computed at once; or fewer matcher.rows");
}

TEST(BoardTables, AreInOneBankIfTheyAreJoint) {
  const auto text = [](const std::string& left, const std::string& right) {
    return fmt::format(
        "extends: fpl2003\nfpga: {{tables: joint}}\nallocation: {{left_lut: {}, right_lut: {}}}\n", left,
        right);
  };
  const BoardConfig joint = load_text(text("bank6", "bank6"));
  EXPECT_TRUE(joint.fpga.joint_tables);
  EXPECT_FALSE(load_board("fpl2003").fpga.joint_tables);
  const std::string end = ", because fpga.tables is joint; or set fpga.tables to separate";
  EXPECT_EQ(refusal_of(text("bank6", "bank7")),
            "board.yaml:3:42: allocation.right_lut = bank7: must be bank6, the bank of left_lut" + end);
  EXPECT_EQ(refusal_of(text("bank6", "none")),
            "board.yaml:3:42: allocation.right_lut = none: must be bank6, the bank of left_lut" + end);
  EXPECT_EQ(refusal_of(text("none", "bank7")),
            "board.yaml:3:24: allocation.left_lut = none: must be bank7, the bank of right_lut" + end);
  EXPECT_EQ(refusal_of(text("none", "none")),
            "board.yaml:3:24: allocation.left_lut = none: must be a bank, and right_lut the same bank" + end);
  EXPECT_EQ(refusal_of_board("fpl2003", {"fpga.tables=joint"}),
            "--set fpga.tables: allocation.right_lut = bank7: must be bank6, the bank of left_lut" + end);
}

std::string cost_board(const std::string& cost) { return kBase + "matcher: {cost: " + cost + "}\n"; }

TEST(BoardCost, IsAWordOrACensusOfItsSize) {
  using kernels::CostKind;
  using kernels::MatchingCost;
  EXPECT_EQ(load_board("fpl2003").matcher.cost, MatchingCost());
  EXPECT_EQ(load_text(cost_board("ssd")).matcher.cost, (MatchingCost{CostKind::kSsd, 0}));
  EXPECT_EQ(load_text(cost_board("zncc")).matcher.cost, (MatchingCost{CostKind::kZncc, 0}));
  for (const int size : {3, 5, 7}) {
    EXPECT_EQ(load_text(cost_board(fmt::format("{{census: {}}}", size))).matcher.cost,
              (MatchingCost{CostKind::kCensus, size}));
  }
  EXPECT_EQ(load_board("fpl2003", {"matcher.cost.census=5"}).matcher.cost,
            (MatchingCost{CostKind::kCensus, 5}));
  EXPECT_EQ(load_text(cost_board("{census: 5}"), {"matcher.cost=sad"}), load_board("fpl2003"));
  EXPECT_EQ(load_text(cost_board("{census: 5}"), {"matcher.cost.census=7"}).matcher.cost.census_size, 7);
}

TEST(BoardCost, SaysHowACensusIsWritten) {
  EXPECT_EQ(refusal_of(cost_board("census")),
            "board.yaml:2:17: matcher.cost = census: must be one of sad, ssd, zncc, {census: 3}, {census: 5} "
            "or {census: 7}");
  EXPECT_EQ(
      refusal_of(cost_board("{census:5}")),
      "board.yaml:2:18: matcher.cost.census:5 = (nothing): a blank is missing after the colon: census: 5");
  // Neither another key nor a colon at the end is a forgotten blank.
  EXPECT_EQ(refusal_of(cost_board("{ssd:5}")),
            "board.yaml:2:11: matcher.cost.census: missing: 3, 5 or 7\n"
            "board.yaml:2:18: matcher.cost.ssd:5 = (nothing): unknown key, and no known key is near");
  EXPECT_EQ(
      refusal_of(cost_board("{census:5: 3}")),
      "board.yaml:2:11: matcher.cost.census: missing: 3, 5 or 7\n"
      "board.yaml:2:18: matcher.cost.census:5 = 3: unknown key; nearest known key: matcher.cost.census");
}

TEST(BoardCost, HasACensusOfAnOddSizeUpToBothLimits) {
  for (const std::string value : {"1", "2", "4", "6", "8", "9", "-3", "99999999999999999999"}) {
    EXPECT_EQ(refusal_of(cost_board("{census: " + value + "}")),
              "board.yaml:2:26: matcher.cost.census = " + value + ": 3, 5 or 7");
  }
  EXPECT_EQ(
      refusal_of(cost_board("{census: \"5\"}")),
      "board.yaml:2:26: matcher.cost.census = \"5\": not an integer (decimal digits, not in quotes); 3, 5 "
      "or 7");
  EXPECT_EQ(refusal_of(cost_board("{}")), "board.yaml:2:11: matcher.cost.census: missing: 3, 5 or 7");
  EXPECT_EQ(refusal_of(cost_board("{census: 5, ssd: 1}")),
            "board.yaml:2:29: matcher.cost.ssd = 1: unknown key, and no known key is near");
  EXPECT_EQ(refusal_of(cost_board("{census: 5, census: 7}")),
            "board.yaml:2:29: matcher.cost.census = 7: repeated key, first at 2:18");
  EXPECT_EQ(refusal_of(cost_board("sad"), {"matcher.cost.census=5"}),
            "--set matcher.cost.census: matcher.cost.census = 5: matcher.cost is not a map here; set it as a "
            "whole");
}

TEST(BoardFilter, HasRowsFromTheTop) {
  const BoardConfig board =
      load_text(kernel_board("{kernel: [[1, 2, 3], [4, -45, 6], [7, 8, 14]], shift: 31}"));
  ASSERT_TRUE(board.matcher.filter);
  EXPECT_EQ(board.matcher.filter->size, 3);
  EXPECT_EQ(board.matcher.filter->shift, 31);
  EXPECT_EQ(board.matcher.filter->weight(2, 0), 3);
  EXPECT_EQ(board.matcher.filter->weight(0, 2), 7);
}

TEST(BoardFilter, HasAnOddSizeUpToBothLimits) {
  for (const int m : {3, 5, 31}) {
    EXPECT_EQ(refusal_of(kernel_board(fmt::format("{{kernel: {}, shift: 0}}", square_kernel(m)))), "") << m;
  }
  for (const int m : {1, 2, 4, 30, 32, 33}) {
    const std::string refusal =
        refusal_of(kernel_board(fmt::format("{{kernel: {}, shift: 0}}", square_kernel(m))));
    EXPECT_EQ(refusal.substr(0, 41), "board.yaml:2:28: matcher.filter.kernel = ") << m;
    EXPECT_NE(refusal.find(": a square list of lists, 3..31, odd rows"), std::string::npos) << refusal;
  }
  for (const std::string value : {"log7", "null", "{}", "[]"}) {
    EXPECT_EQ(refusal_of(kernel_board("{kernel: " + value + ", shift: 0}")),
              "board.yaml:2:28: matcher.filter.kernel = " + value +
                  ": a square list of lists, 3..31, odd rows, entries -32768..32767, sum 0");
  }
}

TEST(BoardFilter, IsSquareWithEntriesUpToBothLimitsAndTheSumZero) {
  EXPECT_EQ(refusal_of(kernel_board("{kernel: [[0, 0, 0], [0, 0], 5], shift: 0}")),
            "board.yaml:2:40: matcher.filter.kernel = [0, 0]: a row of 3 entries, as many as there are rows\n"
            "board.yaml:2:48: matcher.filter.kernel = 5: a row of 3 entries, as many as there are rows");
  EXPECT_EQ(refusal_of(kernel_board("{kernel: [[-32768, 32767, 1], [0, 0, 0], [0, 0, 0]], shift: 0}")), "");
  EXPECT_EQ(
      refusal_of(kernel_board("{kernel: [[-32769, 32768, 1.5], [0, 0, 0], [0, 0, 0]], shift: 0}")),
      "board.yaml:2:30: matcher.filter.kernel = -32769: entries -32768..32767\n"
      "board.yaml:2:38: matcher.filter.kernel = 32768: entries -32768..32767\n"
      "board.yaml:2:45: matcher.filter.kernel = 1.5: not an integer (decimal digits, not in quotes); entries "
      "-32768..32767");
  EXPECT_EQ(
      refusal_of(kernel_board("{kernel: [[1, 0, 0], [0, 0, 0], [0, 0, 2]], shift: 0}")),
      "board.yaml:2:28: matcher.filter.kernel = [[1, 0, 0], [0, 0, 0], [0, 0, 2]]: the entries' sum must be "
      "0, not 3");
}

TEST(BoardFilter, HasAShiftUpToBothLimits) {
  const std::string head = "{kernel: [[0, 0, 0], [0, 0, 0], [0, 0, 0]], shift: ";
  for (const std::string value : {"0", "31"}) EXPECT_EQ(refusal_of(kernel_board(head + value + '}')), "");
  for (const std::string value : {"-1", "32", "99999999999999999999"}) {
    EXPECT_EQ(refusal_of(kernel_board(head + value + '}')),
              "board.yaml:2:70: matcher.filter.shift = " + value + ": 0..31");
  }
  EXPECT_EQ(
      refusal_of(kernel_board(head + "'6'}")),
      "board.yaml:2:70: matcher.filter.shift = \"6\": not an integer (decimal digits, not in quotes); 0..31");
  EXPECT_EQ(refusal_of(kernel_board(head + "1, sift: 2}")),
            "board.yaml:2:73: matcher.filter.sift = 2: unknown key; nearest known key: matcher.filter.shift");
}

}  // namespace
}  // namespace stereotlm::platform::testing
