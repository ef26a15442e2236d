#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <tuple>

#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"
#include "tests/unit/platform/config/board_files.h"

namespace stereotlm::platform::testing {
namespace {

const std::string kBase = "extends: fpl2003\n";

// A board with these banks alone, all buffers of a 4x1 image (1 word each, tables 4) in `bank`.
std::string banks_board(const std::string& ssram, const std::string& bank = "a") {
  return kBase + "ssram: {" + ssram + "}\nimage: {width: 4, height: 1}\n" +
         fmt::format(
             "allocation: {{left_image: {0}, right_image: {0}, disparity: {0}, left_lut: {0}, right_lut: "
             "{0}}}\n",
             bank);
}

std::string board_with_load(const std::string& load) { return kBase + "pci: {load: " + load + "}\n"; }
std::string matcher_board(const std::string& keys) { return kBase + "matcher: {" + keys + "}\n"; }
std::string priority_board(const std::string& ports) { return kBase + "fpga: {priority: [" + ports + "]}\n"; }
std::string cost_board(const std::string& cost) { return matcher_board("cost: " + cost); }
std::string kernel_board(const std::string& kernel, const std::string& shift = "0") {
  return matcher_board("filter: {kernel: " + kernel + ", shift: " + shift + "}");
}

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
  const auto ring = [](const std::string& destination, int pairs, int width, int height) {
    return kBase + fmt::format("capture: {{destination: {}, host_frames: {}}}\n", destination, pairs) +
           fmt::format("image: {{width: {}, height: {}}}\n", width, height) +
           "ssram: {default: {words: 67108864}, banks: {a: {}}}\n"
           "allocation: {left_image: a, right_image: a, disparity: a, left_lut: none, right_lut: none}\n";
  };
  const std::string end = " pixels, because the ring in host memory may have 1024 MiB";
  expect_refusals({{ring("host_memory", 8, 8192, 8192), ""},
                   {ring("host_memory", 9, 8192, 8192),
                    "board.yaml:2:50: capture.host_frames = 9: at most 8 pairs of 8192x8192" + end},
                   {ring("board", 64, 8192, 8192), ""},
                   {ring("host_memory", 64, 4096, 2048), ""},
                   {ring("host_memory", 64, 4096, 2049),
                    "board.yaml:2:50: capture.host_frames = 64: at most 63 pairs of 4096x2049" + end}});
}

TEST(BoardBanks, TakeTheirWordsTurnaroundAndKind) {
  const std::string words = "1..67108864";
  for (const std::string value : {"0", "67108865", "99999999999999999999"}) {
    expect_refusals({{banks_board("default: {words: " + value + "}, banks: {a: {words: 100}}"),
                      fmt::format("board.yaml:2:26: ssram.default.words = {}: {}", value, words)},
                     {banks_board("banks: {a: {words: " + value + "}}"),
                      fmt::format("board.yaml:2:28: ssram.banks.a.words = {}: {}", value, words)}});
  }
  expect_refusals({{banks_board("default: {words: 1}, banks: {a: {words: 67108864}, b: {}}"), ""},
                   {banks_board("banks: {a: {words: 0x64}}"),
                    "board.yaml:2:28: ssram.banks.a.words = 0x64: not an integer (decimal digits, not in "
                    "quotes); " +
                        words}});
  for (const std::string value : {"zbt", "[sync_burst]", "0"}) {
    const std::string rule =
        " = " + value + ": must be one of zbt_pipelined, zbt_flow_through, sync_burst, qdr or sdram";
    expect_refusals(
        {{banks_board("default: {kind: " + value + "}, banks: {a: {}}"),
          "board.yaml:2:25: ssram.default.kind" + rule},
         {banks_board("banks: {a: {kind: " + value + "}}"), "board.yaml:2:27: ssram.banks.a.kind" + rule}});
  }
  for (const std::string value : {"1", "16"})
    expect_refusals({{banks_board("banks: {a: {kind: sync_burst, turnaround_cycles: " + value + "}}"), ""}});
  for (const std::string value : {"0", "17"}) {
    const std::string rule = ".turnaround_cycles = " + value + ": 1..16";
    expect_refusals(
        {{banks_board("banks: {a: {kind: sync_burst, turnaround_cycles: " + value + "}}"),
          "board.yaml:2:58: ssram.banks.a" + rule},
         {banks_board("default: {kind: sync_burst, turnaround_cycles: " + value + "}, banks: {a: {}}"),
          "board.yaml:2:56: ssram.default" + rule}});
  }
}

TEST(BoardBanks, RequireATurnaroundOnlyWhereTheKindIsSyncBurst) {
  const std::string missing =
      ".turnaround_cycles: missing: 1..16; required where the kind is sync_burst, refused beside another";
  const std::string other = ".turnaround_cycles = 2: only where the kind is sync_burst, and it is ";
  const std::string burst = "default: {kind: sync_burst}, ";
  expect_refusals(
      {{banks_board("banks: {a: {kind: sync_burst}}"), "board.yaml:2:17: ssram.banks.a" + missing},
       {banks_board(burst + "banks: {a: {}, b: {}}"), "board.yaml:2:9: ssram.default" + missing},
       {banks_board(burst + "banks: {a: {turnaround_cycles: 1}}"), ""},
       {banks_board(burst + "banks: {a: {kind: zbt_pipelined}}"), ""},
       {banks_board("default: {kind: sync_burst, turnaround_cycles: 4}, banks: {a: {kind: sync_burst}}"), ""},
       {banks_board("banks: {a: {kind: zbt_pipelined, turnaround_cycles: 2}}"),
        "board.yaml:2:61: ssram.banks.a" + other + "zbt_pipelined"},
       {banks_board("banks: {a: {kind: qdr, turnaround_cycles: 2}}"),
        "board.yaml:2:51: ssram.banks.a" + other + "qdr"},
       {banks_board("default: {turnaround_cycles: 2}, banks: {a: {}}"),
        "board.yaml:2:38: ssram.default" + other + "zbt_pipelined"},
       {banks_board("banks: {a: {turnaround_cycles: 17}}"),
        "board.yaml:2:40: ssram.banks.a.turnaround_cycles = 17: 1..16"}});
}

TEST(BoardBanks, IgnoreATurnaroundOfAnEntryWhoseKindHasNone) {
  EXPECT_EQ(load_text(banks_board("banks: {a: {turnaround_cycles: 2}}")).banks[0].turnaround_cycles, 0);
  EXPECT_EQ(load_board("fpl2003", {"ssram.banks.bank3.turnaround_cycles=2"}), load_board("fpl2003"));
  EXPECT_EQ(
      load_board("fpl2003-syncburst", {"ssram.banks.bank3.turnaround_cycles=3"}).banks[3].turnaround_cycles,
      3);
  const BoardConfig inherits = load_text(banks_board(
      "default: {kind: sync_burst, turnaround_cycles: 5}, banks: {a: {kind: zbt_flow_through}, b: {}}"));
  EXPECT_EQ(inherits.banks[0].turnaround_cycles, 0);
  EXPECT_EQ(inherits.banks[1].turnaround_cycles, 5);
}

const std::string kSdram =
    "kind: sdram, cas_latency: 2, row_words: 256, internal_banks: 4, activate_cycles: 1, precharge_cycles: "
    "1, ";
const std::string kRefresh = "refresh_interval_cycles: 625, refresh_cycles: 3";

TEST(BoardBanks, OfSdramHaveItsTiming) {
  const BoardConfig board = load_text(banks_board("default: {" + kSdram + kRefresh +
                                                  "}, banks: {a: {}, b: {cas_latency: 3}, c: {kind: qdr}}"));
  EXPECT_EQ(board.banks[0].sdram, memory::SdramTiming{});
  EXPECT_EQ(board.banks[1].sdram->cas_latency, 3);
  EXPECT_EQ(board.banks[2].sdram, std::nullopt);
  const BoardConfig off = load_text(banks_board("banks: {a: {" + kSdram + "refresh_interval_cycles: off}}"));
  EXPECT_EQ(off.banks[0].sdram->refresh_interval_cycles, std::nullopt);
  const auto with = [](const std::string& key, const std::string& value) {
    std::string timing = kSdram + kRefresh;
    const std::size_t first = timing.find(key) + key.size() + 2;
    return banks_board("banks: {a: {" + timing.replace(first, timing.find(',', first) - first, value) + "}}");
  };
  const auto refusal = [](const std::string& key, const std::string& value, const std::string& rule) {
    return "ssram.banks.a." + key + " = " + value + ": " + rule;
  };
  const auto beyond = [&](const std::string& key, const std::vector<std::string>& values,
                          const std::string& rule) {
    for (const std::string& value : values) {
      const std::string found = refusal_of(with(key, value));
      EXPECT_EQ(found.substr(found.find(": ") + 2), refusal(key, value, rule));
    }
  };
  beyond("cas_latency", {"0", "9"}, "1..8");
  beyond("row_words", {"8", "96", "131072"}, "16..65536, a power of two");
  beyond("internal_banks", {"0", "3", "16"}, "1..8, a power of two");
  beyond("activate_cycles", {"-1", "64"}, "0..63");
  beyond("precharge_cycles", {"64"}, "0..63");
  beyond("refresh_interval_cycles", {"63", "1000001", "0"}, "64..1000000 or off");
  beyond("refresh_cycles", {"0", "256"}, "1..255");
}

TEST(BoardBanks, RequireTheTimingOfSdramOnlyWhereTheKindIsSdram) {
  const std::string required = "; required where the kind is sdram, refused beside another";
  const std::string of_refresh =
      "; required where the kind is sdram and refreshes, refused beside off or another kind";
  expect_refusals(
      {{banks_board("banks: {a: {" + kSdram + "refresh_interval_cycles: 625}}"),
        "board.yaml:2:17: ssram.banks.a.refresh_cycles: missing: 1..255" + of_refresh},
       {banks_board("default: {" + kSdram + "refresh_interval_cycles: 625}, banks: {a: {}}"),
        "board.yaml:2:9: ssram.default.refresh_cycles: missing: 1..255" + of_refresh},
       {banks_board("banks: {a: {" + kSdram + "refresh_cycles: 3}}"),
        "board.yaml:2:17: ssram.banks.a.refresh_interval_cycles: missing: 64..1000000 or off" + required},
       {banks_board("banks: {a: {kind: qdr, cas_latency: 2}}"),
        "board.yaml:2:45: ssram.banks.a.cas_latency = 2: only where the kind is sdram, and it is qdr"},
       {banks_board("banks: {a: {kind: qdr, refresh_interval_cycles: off}}"),
        "board.yaml:2:57: ssram.banks.a.refresh_interval_cycles = off: only where the kind is sdram, and it "
        "is qdr"},
       {banks_board("banks: {a: {" + kSdram + "turnaround_cycles: 2, " + kRefresh + "}}"),
        "board.yaml:2:145: ssram.banks.a.turnaround_cycles = 2: only where the kind is sync_burst, and it is "
        "sdram"},
       {banks_board("banks: {a: {" + kSdram + "refresh_interval_cycles: off, refresh_cycles: 3}}"),
        "board.yaml:2:172: ssram.banks.a.refresh_cycles = 3: only with a refresh, and "
        "refresh_interval_cycles is off"},
       {banks_board("banks: {a: {cas_latency: 3}}"), ""}});
}

TEST(BoardBanks, TakeWhatTheyGiveElseTheDefaultElseWhatTheirKindTakes) {
  const BoardConfig board = load_text(
      banks_board("default: {" + kSdram + kRefresh +
                  ", energy: {access_pj: 5, row_pj: 6}}, banks: {a: {}, b: {energy: "
                  "{access_pj: 0, standby_mw: 0.125}}, c: {kind: qdr, energy: {access_pj: 1000000}}}"));
  const std::vector<std::tuple<double, int, int, int>> expected = {
      {181.5, 5, 6, 61215}, {0.125, 0, 6, 61215}, {360, 1000000, 0, 0}};
  for (std::size_t bank = 0; bank < expected.size(); ++bank) {
    const auto [standby_mw, access_pj, row_pj, refresh_pj] = energy_of(board.banks[bank]);
    EXPECT_EQ(std::tuple(standby_mw, access_pj, row_pj, refresh_pj), expected[bank]);
  }
  EXPECT_EQ(load_text(to_yaml(board)), board);
}

TEST(BoardBanks, RefuseEnergiesBeyondTheirRulesAndOfAnotherKind) {
  const auto refused = [](const std::string& energy, const std::string& message) -> Refusal {
    return {banks_board("banks: {a: {kind: qdr, energy: " + energy + "}}"),
            "board.yaml:2:" + message.substr(0, 2) + ": ssram.banks.a.energy" + message.substr(2)};
  };
  expect_refusals({refused("{access_pj: 1000001}", "52.access_pj = 1000001: 0..1000000"),
                   refused("{standby_mw: 10000.001}", "53.standby_mw = 10000.001: 0..10000"),
                   refused("{row_pj: 1}", "49.row_pj = 1: only where the kind is sdram, and it is qdr"),
                   refused("{acess_pj: 1}",
                           "41.acess_pj = 1: unknown key; nearest known key: "
                           "ssram.banks.a.energy.access_pj")});
}

TEST(BoardBanks, OfSdramGrantAnAccessBetweenTwoRefreshes) {
  const auto text = [](int activate, int interval, int refresh) {
    return banks_board(
        fmt::format("banks: {{a: {{kind: sdram, cas_latency: 2, row_words: 16, internal_banks: "
                    "1, activate_cycles: {}, precharge_cycles: 0, refresh_interval_cycles: {}, "
                    "refresh_cycles: {}}}}}",
                    activate, interval, refresh));
  };
  const std::string end = ", or no access might ever be granted: a refresh, and the opening of two rows";
  expect_refusals(
      {{text(40, 100, 20), ""},
       {text(40, 99, 20), "board.yaml:2:151: ssram.banks.a.refresh_interval_cycles = 99: at least 100" + end},
       {text(0, 101, 100), ""},
       {text(0, 100, 100),
        "board.yaml:2:150: ssram.banks.a.refresh_interval_cycles = 100: at least 101" + end}});
}

TEST(BoardStripes, NameTwoToSixteenDifferentBanksOfOneReadLatency) {
  const auto in = [](const std::string& value) { return kBase + "allocation: {disparity: " + value + "}\n"; };
  const BoardConfig board = load_text(in("[{rows: [bank4, bank5]}, bank6]"));
  EXPECT_EQ(board.allocation.disparity,
            (std::vector<BufferBanks>{BufferBanks(std::vector<std::string>{"bank4", "bank5"}), "bank6"}));
  EXPECT_EQ(load_text(in("{rows: [bank4, bank5]}")), load_text(in("[{rows: [bank4, bank5]}]")));
  const std::string rule = "a stripe {rows: [..]} has 2..16 different banks";
  expect_refusals(
      {{in("{rows: [bank4]}"), "board.yaml:2:32: allocation.disparity = [bank4]: " + rule},
       {in("{rows: bank4}"), "board.yaml:2:32: allocation.disparity = bank4: " + rule},
       {in("{rows: [bank4, bank5, bank4]}"),
        "board.yaml:2:47: allocation.disparity = bank4: twice in one stripe; " + rule},
       {in("{rows: [bank4, bank9]}"),
        "board.yaml:2:40: allocation.disparity = bank9: not a bank of this board; nearest: bank0"},
       {in("{rows: [bank4, bank5]}"),
        "--set ssram.banks.bank5: allocation.disparity[0].rows[1] = bank5: its read latency is 1, that of "
        "bank4 is 2; all banks of a stripe need one",
        {"ssram.banks.bank5={kind: zbt_flow_through}"}}});
}

TEST(BoardStripes, HoldTheirRowsInTurn) {
  const BoardConfig board = load_board(
      "fpl2003", {"image={width: 8, height: 5}", "allocation.left_lut={rows: [bank0, bank6, bank5]}",
                  "allocation.right_lut={rows: [bank1, bank2, bank3, bank4, bank5, bank6, bank7]}"});
  std::vector<std::string> parts;
  for (const PlacedBuffer& buffer : buffers(board)) {
    if (buffer.parts > 1)
      parts.push_back(fmt::format("{} in {}: {}..{}", buffer.label(), buffer.bank,
                                  buffer.range.first % (1U << 28U) / 4, buffer.range.end % (1U << 28U) / 4));
  }
  EXPECT_THAT(parts, ::testing::ElementsAre(
                         "left_lut.rows[0] in bank0: 10..26", "left_lut.rows[1] in bank6: 0..16",
                         "left_lut.rows[2] in bank5: 10..18", "right_lut.rows[0] in bank1: 10..18",
                         "right_lut.rows[1] in bank2: 10..18", "right_lut.rows[2] in bank3: 10..18",
                         "right_lut.rows[3] in bank4: 10..18", "right_lut.rows[4] in bank5: 18..26",
                         "right_lut.rows[5] in bank6: 16..16", "right_lut.rows[6] in bank7: 0..0"));
}

TEST(BoardBanks, AreOneToSixtyFour) {
  std::string banks = "a: {}";
  for (int i = 1; i < 64; ++i) banks += fmt::format(", b{}: {{}}", i);
  EXPECT_EQ(load_text(banks_board("banks: {" + banks + "}")).banks.size(), 64U);
  const std::string refusal = refusal_of(banks_board("banks: {" + banks + ", b64: {}}"));
  EXPECT_EQ(refusal.substr(0, 31), "board.yaml:2:16: ssram.banks = ");
  EXPECT_NE(refusal.find("65 banks; a map of 1..64 banks"), std::string::npos);
  expect_refusals(
      {{banks_board("banks: {}"), "board.yaml:2:16: ssram.banks = {}: 0 banks; a map of 1..64 banks"}});
}

TEST(BoardBanks, HaveValidNamesAndKnownKeysOnce) {
  for (const std::string name : {"a", "Z9_-", "null-", "true", "\"null\"", "off"})
    expect_refusals({{banks_board("banks: {" + name + ": {}}", name), ""}});
  for (const std::string name : {"9a", "_a", "-a", "none", "ä", "a b", "~", "null", "a/b", "[a]", "7"}) {
    expect_refusals({{banks_board("banks: {a: {}, " + name + ": {}}"),
                      "board.yaml:2:24: ssram.banks." + name +
                          " = {}: a bank's name is [A-Za-z][A-Za-z0-9_-]*, and not none"}});
  }
  expect_refusals({{banks_board("banks: {a: {}, b: {}, a: {words: 5}}"),
                    "board.yaml:2:31: ssram.banks.a = {words: 5}: repeated key, first at 2:17"},
                   {banks_board("banks: {a: {}, b}"),
                    "board.yaml:2:24: ssram.banks.b = (nothing): a map of words, kind, turnaround_cycles, "
                    "cas_latency, row_words, internal_banks, activate_cycles, precharge_cycles, "
                    "refresh_interval_cycles, refresh_cycles, energy"},
                   {banks_board("banks: {a: {wrods: 5}}"),
                    "board.yaml:2:21: ssram.banks.a.wrods = 5: unknown key; nearest known key: "
                    "ssram.banks.a.words"}});
}

TEST(BoardBanks, HoldTheirBuffers) {
  const std::string need =
      " words missing, its buffers (left_image[0], right_image[0], disparity[0], left_lut, right_lut) need "
      "11";
  const std::string hint =
      "; set fpga.tables to joint, or give the bank more words, or one of the tables another bank";
  expect_refusals(
      {{banks_board("banks: {a: {words: 11}}"), ""},
       {banks_board("banks: {a: {words: 10}}"), "board.yaml:2:28: ssram.banks.a.words = 10: 1" + need + hint},
       {banks_board("banks: {a: {words: 7}}"), "board.yaml:2:28: ssram.banks.a.words = 7: 4" + need + hint},
       // One table more or less does not decide.
       {banks_board("banks: {a: {words: 6}}"), "board.yaml:2:28: ssram.banks.a.words = 6: 5" + need},
       {banks_board("default: {words: 1}, banks: {a: {}}"),
        "board.yaml:2:26: ssram.banks.a.words = 1: 10" + need}});
}

TEST(BoardAllocation, NamesBanksOfTheBoard) {
  const std::string list = "a bank, a stripe {rows: [..]} of 2..16 banks, or a list of 1 to 3 of them";
  expect_refusals(
      {{kBase + "allocation: {disparity: [bank4, bonk5], left_lut: bank66, right_image: [x, none]}\n",
        "board.yaml:2:33: allocation.disparity = bonk5: not a bank of this board; nearest: bank5\n"
        "board.yaml:2:51: allocation.left_lut = bank66: not a bank of this board; nearest: bank6\n"
        "board.yaml:2:73: allocation.right_image = x: not a bank of this board\n"
        "board.yaml:2:76: allocation.right_image = none: not a bank of this board"},
       {kBase + "allocation: {disparity: [bank4, [bank5], null]}\n",
        "board.yaml:2:33: allocation.disparity = [bank5]: " + list +
            "\n"
            "board.yaml:2:42: allocation.disparity = null: " +
            list}});
  const std::string head = kBase + "allocation: ";
  EXPECT_EQ(
      load_text(head + "{left_image: bank0, right_image: bank2, disparity: bank4, left_lut: bank6}"),
      load_text(head + "{left_image: [bank0], right_image: [bank2], disparity: [bank4], left_lut: [bank6]}"));
}

TEST(BoardPriority, NamesEachPortOnce) {
  const std::string five = "host, result, left_pixel, right_pixel, left_lut";
  expect_refusals({{priority_board(five),
                    "board.yaml:2:18: fpga.priority = [" + five + "]: each port once; right_lut missing"},
                   {priority_board(five + ", right_lut, host"),
                    "board.yaml:2:79: fpga.priority = host: repeated; each port once"},
                   {priority_board(five + ", lut"),
                    "board.yaml:2:68: fpga.priority = lut: must be one of left_lut, right_lut, left_pixel, "
                    "right_pixel, result or host"},
                   {priority_board(five + ", left_lut"),
                    "board.yaml:2:68: fpga.priority = left_lut: repeated; each port once"}});
  EXPECT_EQ(refusal_of(priority_board("")).substr(0, 68),
            "board.yaml:2:18: fpga.priority = []: each port once; left_lut, right");
  const auto priority = load_text(priority_board("right_lut, " + five)).fpga.arbiter.priority;
  EXPECT_EQ(priority[0], fpga::lut_group(fpga::Side::kRight));
  EXPECT_EQ(priority[1], fpga::kHostGroup);
  EXPECT_EQ(priority[5], fpga::lut_group(fpga::Side::kLeft));
}

TEST(BoardLoad, IsNoneOrAMapOfItsWordsAndTimes) {
  BoardConfig expected;
  EXPECT_EQ(load_text(board_with_load("none")), expected);
  EXPECT_EQ(load_text(board_with_load("{burst_words: 8, interval_us: 10}"), {"pci.load=none"}), expected);
  expected.pci.load = PciLoadConfig{8, 10, 0.5, 0.25};
  EXPECT_EQ(load_text(board_with_load("{first_us: 0.5, burst_words: 8, access_us: 0.25, interval_us: 10}")),
            expected);
  expected.pci.load = PciLoadConfig{9, 10, 0, 0};
  EXPECT_EQ(load_text(board_with_load("{burst_words: 8, interval_us: 10}"), {"pci.load.burst_words=9"}),
            expected);
  expect_refusals(
      {{board_with_load("{}"),
        "board.yaml:2:7: pci.load.burst_words: missing: 1..1024\n"
        "board.yaml:2:7: pci.load.interval_us: missing: 0..1000000000"},
       {board_with_load("{burst_words: 8, interval_us: 10, burst_wrods: 9, interval_us: 11}"),
        "board.yaml:2:47: pci.load.burst_wrods = 9: unknown key; nearest known key: pci.load.burst_words\n"
        "board.yaml:2:63: pci.load.interval_us = 11: repeated key, first at 2:30"},
       {board_with_load("&a {burst_words: 8}"),
        "board.yaml:2:13: pci.load = {burst_words: 8}: anchors and aliases are not allowed in a board"},
       {kBase + "pci: {load: none, load: none}\n",
        "board.yaml:2:19: pci.load = none: repeated key, first at 2:7"}});
}

TEST(BoardImage, IsLargerThan2048OnlyWithoutTables) {
  const auto text = [](int width, int height, const std::string& allocation) {
    return kBase +
           fmt::format("image: {{width: {}, height: {}}}\nallocation: {{{}}}\n", width, height, allocation);
  };
  const std::string width = "board.yaml:2:16: image.width = 2052: at most 2048 with a look-up table; set ";
  const std::string height = "board.yaml:2:27: image.height = 2049: at most 2048 with a look-up table; set ";
  const std::string both = "allocation.left_lut and allocation.right_lut";
  const std::string end = " to none, or a smaller image";
  const std::string none = "left_lut: none, right_lut: none";
  expect_refusals({{text(2052, 1, ""), width + both + end},
                   {text(2052, 480, ""), width + both + end},  // and not that banks are too small
                   {text(4, 2049, ""), height + both + end},
                   {text(2052, 1, "left_lut: none"), width + "allocation.right_lut" + end},
                   {text(4, 2049, "right_lut: none"), height + "allocation.left_lut" + end},
                   {text(8192, 4, none), ""},
                   {text(4, 8192, none), ""},
                   {text(2048, 4, ""), ""},
                   {text(4, 2048, ""), ""}});
}

TEST(BoardUnits, AreAtMostTheDisparities) {
  EXPECT_EQ(load_text(matcher_board("disparities: 16, units: 16")).matcher.units, 16);
  EXPECT_EQ(load_text(matcher_board("disparities: 16, units: all")).matcher.units, std::nullopt);
  expect_refusals({{matcher_board("disparities: 16, units: 17"),
                    "board.yaml:2:35: matcher.units = 17: 1..disparities, which is 16, or all"},
                   {matcher_board("units: 40"),
                    "--set matcher.disparities: matcher.units = 40: 1..disparities, which is 39, or all",
                    {"matcher.disparities=39"}}});
}

TEST(BoardRows, AreOneBehindALineBufferAndHaveAPlaceInTheResultQueueEach) {
  const std::string end = ", a word for each of the rows that are computed at once; or fewer matcher.rows";
  const auto queue = [](int rows, int words) {
    return matcher_board(fmt::format("rows: {}", rows)) +
           fmt::format("fpga: {{result_fifo_words: {}}}\n", words);
  };
  expect_refusals(
      {{matcher_board("fetch: line_buffer, rows: 1"), ""},
       {matcher_board("fetch: line_buffer, rows: 2"),
        "board.yaml:2:37: matcher.rows = 2: must be 1 where matcher.fetch is line_buffer; with column it may "
        "be 1..16"},
       {queue(16, 16), ""},
       {queue(9, 8), "board.yaml:3:27: fpga.result_fifo_words = 8: at least 9" + end},
       {kBase, "--set matcher.rows: fpga.result_fifo_words = 8: at least 16" + end, {"matcher.rows=16"}}});
}

// 13 banks of 61 pins, 60 of the rest: 853. ff1152 has 824, ff1517 1104.
TEST(BoardPins, DoNotExceedThePackage) {
  std::string banks = "ssram: {banks: {";
  for (int bank = 0; bank < 13; ++bank)
    banks += fmt::format("{}bank{}: {{kind: zbt_pipelined, words: 524288}}", bank == 0 ? "" : ", ", bank);
  banks += "}}\nallocation: {disparity: {rows: [bank8, bank9, bank10, bank11, bank12, bank4, bank5]}}\n";
  const auto in = [&](const std::string& fpga) { return kBase + "fpga: {" + fpga + "}\n" + banks; };
  EXPECT_EQ(load_text(in("package: ff1517")).fpga.package, "ff1517");
  EXPECT_EQ(load_text(in("device: xc2v6000")).fpga.package, "");
  expect_refusals(
      {{in("package: ff1152"),
        "board.yaml:2:17: fpga.package = ff1152: 29 pins missing: the board needs 853, and it has 824"},
       {kBase + "fpga: {device: xc2v8000, package: ff1152}\n",
        "board.yaml:2:35: fpga.package = ff1152: only where fpga.device is xc2v6000, and it is "
        "xc2v8000"}});
}

TEST(BoardLanes, DivideAColumnOfSlots) {
  const auto lanes = [](int count, const std::string& matcher) {
    return matcher_board(matcher) + fmt::format("fpga: {{lanes: {}}}\n", count);
  };
  EXPECT_EQ(load_text(kBase).fpga.lanes, 1);
  EXPECT_EQ(load_text(lanes(7, "window: 7")).fpga.lanes, 7);
  EXPECT_EQ(load_text(lanes(16, "window: 9, rows: 8")).fpga.lanes, 16);
  const std::string column = ", the slots of a column (matcher.window + matcher.rows - 1)";
  expect_refusals(
      {{lanes(1, "fetch: line_buffer"), ""},
       {lanes(2, "fetch: line_buffer"),
        "board.yaml:3:15: fpga.lanes = 2: must be 1 where matcher.fetch is line_buffer; with column it may "
        "be 1..16"},
       {lanes(8, "window: 7"), "board.yaml:3:15: fpga.lanes = 8: at most 7" + column},
       {lanes(8, "window: 7, rows: 2"), ""},
       {lanes(9, "window: 7, rows: 2"), "board.yaml:3:15: fpga.lanes = 9: at most 8" + column},
       {lanes(17, "window: 31"), "board.yaml:3:15: fpga.lanes = 17: 1..16"}});
}

TEST(BoardTables, AreInOneBankIfTheyAreJoint) {
  const auto text = [](const std::string& left, const std::string& right) {
    return kBase +
           fmt::format("fpga: {{tables: joint}}\nallocation: {{left_lut: {}, right_lut: {}}}\n", left, right);
  };
  EXPECT_TRUE(load_text(text("bank6", "bank6")).fpga.joint_tables);
  const std::string end = ", because fpga.tables is joint; or set fpga.tables to separate";
  const std::string left = "must be bank6, the bank of left_lut" + end;
  expect_refusals(
      {{text("bank6", "bank7"), "board.yaml:3:42: allocation.right_lut = bank7: " + left},
       {text("bank6", "none"), "board.yaml:3:42: allocation.right_lut = none: " + left},
       {text("none", "bank7"),
        "board.yaml:3:24: allocation.left_lut = none: must be bank7, the bank of right_lut" + end},
       {text("none", "none"),
        "board.yaml:3:24: allocation.left_lut = none: must be a bank, and right_lut the same bank" + end},
       {kBase, "--set fpga.tables: allocation.right_lut = bank7: " + left, {"fpga.tables=joint"}}});
}

TEST(BoardCost, IsAWordOrACensusOfItsSize) {
  using kernels::CostKind;
  using kernels::MatchingCost;
  EXPECT_EQ(load_text(cost_board("ssd")).matcher.cost, (MatchingCost{CostKind::kSsd, 0}));
  EXPECT_EQ(load_text(cost_board("zncc")).matcher.cost, (MatchingCost{CostKind::kZncc, 0}));
  EXPECT_EQ(load_board("fpl2003", {"matcher.cost.census=5"}).matcher.cost,
            (MatchingCost{CostKind::kCensus, 5}));
  EXPECT_EQ(load_text(cost_board("{census: 5}"), {"matcher.cost=sad"}), load_board("fpl2003"));
  const std::string missing = "board.yaml:2:11: matcher.cost.census: missing: 3, 5 or 7";
  const std::string census = "matcher.cost.census = ";
  expect_refusals(
      {{cost_board("{census:5}"),
        "board.yaml:2:18: matcher.cost.census:5 = (nothing): a blank is missing after the colon: census: 5"},
       // Neither another key nor a colon at the end is a forgotten blank.
       {cost_board("{ssd:5}"),
        missing +
            "\nboard.yaml:2:18: matcher.cost.ssd:5 = (nothing): unknown key; keys of matcher.cost: census"},
       {cost_board("{census:5: 3}"), missing + "\nboard.yaml:2:18: matcher.cost.census:5 = 3: unknown key; "
                                               "nearest known key: matcher.cost.census"},
       {cost_board("{census: 1}"), "board.yaml:2:26: " + census + "1: 3, 5 or 7"},
       {cost_board("{census: 4}"), "board.yaml:2:26: " + census + "4: 3, 5 or 7"},
       {cost_board("{census: 9}"), "board.yaml:2:26: " + census + "9: 3, 5 or 7"},
       {cost_board("{census: \"5\"}"),
        "board.yaml:2:26: " + census + "\"5\": not an integer (decimal digits, not in quotes); 3, 5 or 7"},
       {cost_board("{}"), missing},
       {cost_board("{census: 5, ssd: 1}"),
        "board.yaml:2:29: matcher.cost.ssd = 1: unknown key; keys of matcher.cost: census"},
       {cost_board("{census: 5, census: 7}"),
        "board.yaml:2:29: " + census + "7: repeated key, first at 2:18"},
       {cost_board("sad"),
        "--set matcher.cost.census: " + census + "5: matcher.cost is not a map here; set it as a whole",
        {"matcher.cost.census=5"}}});
}

TEST(BoardFilter, HasAnOddNumberOfRowsFromTheTop) {
  const BoardConfig board = load_text(kernel_board("[[1, 2, 3], [4, -45, 6], [7, 8, 14]]", "31"));
  ASSERT_TRUE(board.matcher.filter);
  EXPECT_EQ(board.matcher.filter->size, 3);
  EXPECT_EQ(board.matcher.filter->shift, 31);
  EXPECT_EQ(board.matcher.filter->weight(2, 0), 3);
  EXPECT_EQ(board.matcher.filter->weight(0, 2), 7);
  for (const int m : {3, 5, 31}) expect_refusals({{kernel_board(square_kernel(m)), ""}});
  const std::string rule = ": a square list of lists, 3..31, odd rows, entries -32768..32767, sum 0";
  for (const int m : {1, 2, 4, 30, 32, 33}) {
    const std::string refusal = refusal_of(kernel_board(square_kernel(m)));
    EXPECT_EQ(refusal.substr(0, 41), "board.yaml:2:28: matcher.filter.kernel = ") << m;
    EXPECT_NE(refusal.find(rule), std::string::npos) << refusal;
  }
  for (const std::string value : {"log7", "null", "{}", "[]"})
    expect_refusals({{kernel_board(value), "board.yaml:2:28: matcher.filter.kernel = " + value + rule}});
}

TEST(BoardFilter, IsSquareWithEntriesAndAShiftUpToBothLimitsAndTheSumZero) {
  const std::string kernel = "matcher.filter.kernel = ";
  const std::string zeros = "[[0, 0, 0], [0, 0, 0], [0, 0, 0]]";
  expect_refusals(
      {{kernel_board("[[0, 0, 0], [0, 0], 5]"),
        "board.yaml:2:40: " + kernel + "[0, 0]: a row of 3 entries, as many as there are rows\n" +
            "board.yaml:2:48: " + kernel + "5: a row of 3 entries, as many as there are rows"},
       {kernel_board("[[-32768, 32767, 1], [0, 0, 0], [0, 0, 0]]"), ""},
       {kernel_board("[[-32769, 32768, 1.5], [0, 0, 0], [0, 0, 0]]"),
        "board.yaml:2:30: " + kernel + "-32769: entries -32768..32767\n" + "board.yaml:2:38: " + kernel +
            "32768: entries -32768..32767\n" + "board.yaml:2:45: " + kernel +
            "1.5: not an integer (decimal digits, not in quotes); entries -32768..32767"},
       {kernel_board("[[1, 0, 0], [0, 0, 0], [0, 0, 2]]"),
        "board.yaml:2:28: " + kernel +
            "[[1, 0, 0], [0, 0, 0], [0, 0, 2]]: the entries' sum must be 0, not 3"},
       {kernel_board(zeros, "0"), ""},
       {kernel_board(zeros, "31"), ""},
       {kernel_board(zeros, "-1"), "board.yaml:2:70: matcher.filter.shift = -1: 0..31"},
       {kernel_board(zeros, "32"), "board.yaml:2:70: matcher.filter.shift = 32: 0..31"},
       {kernel_board(zeros, "'6'"),
        "board.yaml:2:70: matcher.filter.shift = \"6\": not an integer (decimal "
        "digits, not in quotes); 0..31"},
       {kernel_board(zeros, "1, sift: 2"),
        "board.yaml:2:73: matcher.filter.sift = 2: unknown key; nearest known key: matcher.filter.shift"}});
}

}  // namespace
}  // namespace stereotlm::platform::testing
