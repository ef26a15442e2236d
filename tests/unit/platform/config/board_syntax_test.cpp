#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>

#include "platform/config/board_yaml.h"
#include "tests/unit/platform/config/board_files.h"

namespace stereotlm::platform::testing {
namespace {

TEST(BoardSyntax, ReportsEveryProblemAtOnceInTheOrderOfTheFile) {
  const std::string text = R"(extends: fpl2003
image: {width: 641, height: 480, widht: 7, width: 640}
cameras: {frame_rate_hz: 1001, trigger: off}
fpga:
  device: xc2v600
  arbitration:
  priority: [host, result, left_pixel, right_pixel, left_lut, left_lut]
"größe": {ü: 1}
matcher: {filter: {kernel: [[1, 2, 3], [1, 2], [1, 40000, x]]}, fetch: columns, lr_tolerance: false}
<<: {x: 1}
[a, b]: 3
)";
  EXPECT_EQ(refusal_of(text),
            R"(board.yaml:2:16: image.width = 641: 4..8192, a multiple of 4
board.yaml:2:34: image.widht = 7: unknown key; nearest known key: image.width
board.yaml:2:44: image.width = 640: repeated key, first at 2:9
board.yaml:3:26: cameras.frame_rate_hz = 1001: 0.1..1000
board.yaml:3:41: cameras.trigger = off: must be one of free_running or on_demand
board.yaml:5:11: fpga.device = xc2v600: must be one of xc2v1000, xc2v1500, xc2v2000, xc2v3000, )"
            R"(xc2v4000, xc2v6000 or xc2v8000
board.yaml:6:3: fpga.arbitration = (nothing): must be one of fixed_priority, round_robin or age
board.yaml:7:63: fpga.priority = left_lut: repeated; each port once
board.yaml:8:1: größe = {ü: 1}: unknown key, and no known key is near
board.yaml:9:11: matcher.filter.shift: missing: 0..31
board.yaml:9:40: matcher.filter.kernel = [1, 2]: a row of 3 entries, as many as there are rows
board.yaml:9:52: matcher.filter.kernel = 40000: entries -32768..32767
board.yaml:9:59: matcher.filter.kernel = x: not an integer (decimal digits, not in quotes); )"
            R"(entries -32768..32767
board.yaml:9:72: matcher.fetch = columns: must be one of column or line_buffer
board.yaml:9:95: matcher.lr_tolerance = false: not an integer (decimal digits, not in quotes); 0..253 or off
board.yaml:10:1: << = {x: 1}: unknown key, and no known key is near
board.yaml:11:1: [a, b] = 3: unknown key, and no known key is near)");
}

TEST(BoardSyntax, CountsTheProblemsBeyondTwentyLines) {
  const auto refusal = [](int count) {
    std::string text = "extends: fpl2003\n";
    for (int i = 0; i < count; ++i) text += fmt::format("x{}: 1\n", i);
    return refusal_of(text);
  };
  const auto lines = [](const std::string& text) { return std::count(text.begin(), text.end(), '\n') + 1; };
  const auto last = [](const std::string& text) { return text.substr(text.rfind('\n') + 1); };
  EXPECT_EQ(lines(refusal(20)), 20);
  EXPECT_EQ(last(refusal(20)), "board.yaml:21:1: x19 = 1: unknown key, and no known key is near");
  EXPECT_EQ(lines(refusal(21)), 21);
  EXPECT_EQ(last(refusal(21)), "and 1 error more");
  EXPECT_EQ(last(refusal(1000)), "and 980 errors more");
}

TEST(BoardSyntax, CountsColumnsInCharacters) {
  EXPECT_EQ(refusal_of("{extends: fpl2003, name: größe, widht: 3}"),
            "board.yaml:1:33: widht = 3: unknown key; nearest known key: image.width");
}

TEST(BoardSyntax, ReportsAMissingKeyAtItsParentOrAtTheTop) {
  EXPECT_EQ(
      refusal_of("name: x\n"
                 "image: {width: 640}\n"
                 "cameras: {frame_rate_hz: 1, trigger: on_demand}\n"
                 "capture: {destination: board, host_frames: 3, fifo_words: 140, fifo_trigger_words: 32}\n"
                 "fpga: {}\n"
                 "ssram: {default: {}}\n"
                 "allocation: {left_image: b, right_image: b, disparity: b, left_lut: b, right_lut: b}\n"
                 "matcher: {window: 7, disparities: 80, filter: log7, fetch: column, lr_tolerance: 0}\n"),
      R"(board.yaml:1:1: pci: missing: a map of clock_mhz, latency_timer_clocks, bridge_wait_clocks, )"
      R"(memory_wait_clocks, width_bits, load
board.yaml:1:1: bridge: missing: a map of local_clock_mhz, dma_burst_words, posted_words
board.yaml:2:1: image.height: missing: 1..8192
board.yaml:5:1: fpga.device: missing: xc2v1000, xc2v1500, xc2v2000, xc2v3000, xc2v4000, xc2v6000 or xc2v8000
board.yaml:5:1: fpga.clock_mhz: missing: 1..1000
board.yaml:5:1: fpga.arbitration: missing: fixed_priority, round_robin or age
board.yaml:5:1: fpga.priority: missing: a list that names each port once: left_lut, right_lut, left_pixel, )"
      R"(right_pixel, result, host
board.yaml:5:1: fpga.lane_fifo_slots: missing: 1..64
board.yaml:5:1: fpga.result_fifo_words: missing: 1..64
board.yaml:5:1: fpga.pipeline_latency_cycles: missing: 0..1024
board.yaml:6:1: ssram.banks: missing: a map of 1..64 banks
board.yaml:6:9: ssram.default.words: missing: 1..67108864
board.yaml:6:9: ssram.default.kind: missing: zbt_pipelined, zbt_flow_through, sync_burst, qdr or sdram)");
}

TEST(BoardSyntax, RefusesASectionThatIsNoMap) {
  for (const std::string value : {"5", "[width]", "null", "wide"}) {
    EXPECT_EQ(refusal_of("extends: fpl2003\nimage: " + value),
              "board.yaml:2:8: image = " + value + ": a map of width, height");
  }
  EXPECT_EQ(refusal_of("extends: fpl2003\nssram: {banks: [bank0]}"),
            "board.yaml:2:16: ssram.banks = [bank0]: a map of 1..64 banks");
}

TEST(BoardSyntax, RefusesAFileThatIsNoMapOfKeys) {
  EXPECT_EQ(refusal_of(""), "board.yaml:1:1: empty: a board is a map of keys and values");
  EXPECT_EQ(refusal_of("# only a comment\n"), "board.yaml:1:1: empty: a board is a map of keys and values");
  const std::string rule =
      ": a map of name, image, cameras, capture, pci, bridge, fpga, ssram, allocation, matcher";
  EXPECT_EQ(refusal_of("- x\n"), "board.yaml:1:1: the board = [x]" + rule);
  EXPECT_EQ(refusal_of("\nfpl2003\n"), "board.yaml:2:1: the board = fpl2003" + rule);
  EXPECT_EQ(refusal_of("~"), "board.yaml:1:1: the board = ~" + rule);
}

TEST(BoardSyntax, ReportsOnlyTheFirstSyntaxErrorWithWhatIsExpected) {
  const std::map<std::string, std::string> refusals = {
      {"name: 7\nimage: [1, 2\n- 3}\nname: \"x\n",
       "3:4: not YAML: found \"}\", expected brackets in matching pairs"},
      {"name: \"x\n", "1:7: not YAML: the closing quote is missing"},
      {"name: 7\nimage: [1, 2\n",
       "3:1: not YAML: found the end, expected a comma or the ] of a list that began with ["},
      {"image: {width: 4, height\n",
       "2:1: not YAML: found the end, expected a comma or the } of a map that began with {"},
      {"image: {width: 4}}\n", "1:18: not YAML: found \"}\", expected brackets in matching pairs"},
      {"image:\n  width: 4\n height: 3\n",
       "3:2: not YAML: found \"height: 3\", expected a key that is indented as the one before it"},
      {"name: a: b\n",
       "1:8: not YAML: found \": b\", expected one key: value on each line; a text that holds a colon and a "
       "space stands in quotes"},
      {"name: @x # y\n",
       "1:7: not YAML: found \"@x # y\", expected a value; one that begins with this character stands in "
       "quotes"},
      {"image:\n\twidth: 3\n", "2:7: not YAML: found \": 3\", expected spaces for indentation, not tabs"},
      {"name: a\n\timage: 3\n",
       "2:1: not YAML: found \" image: 3\", expected spaces for indentation, not tabs"},
      {"name: \"\\q\"\n", "1:10: not YAML: unknown escape character: q"},
  };
  for (const auto& [text, refusal] : refusals) EXPECT_EQ(refusal_of(text), "board.yaml:" + refusal) << text;
}

TEST(BoardSyntax, RefusesAQuoteThatIsNotClosed) {
  for (const std::string text :
       {R"("x)", "'x", "\"x\n", "'x\n", "'x''\n", "\"x\\\"\n", "\"x\nimage: {width: 8}\n"}) {
    const std::string refusal = refusal_of("extends: fpl2003\nname: " + text);
    EXPECT_TRUE(refusal == "board.yaml:2:7: not YAML: the closing quote is missing" ||
                refusal.find("not YAML: illegal EOF in scalar") != std::string::npos)
        << text << refusal;
  }
  for (const std::string text : {R"("x")", "'x'", "'it''s'", R"("\"")", "''''", R"("\\")"}) {
    EXPECT_EQ(refusal_of("extends: fpl2003\nname: " + text), "") << text;
  }
}

TEST(BoardSyntax, RefusesASecondDocument) {
  EXPECT_EQ(refusal_of("---\nextends: fpl2003\n---\nname: x\n"), "board.yaml:3:1: one YAML document only");
  EXPECT_EQ(refusal_of("---\nextends: fpl2003\n...\n"), "");
}

TEST(BoardSyntax, RefusesTextThatIsNotUtf8) {
  EXPECT_EQ(refusal_of("extends: fpl2003\nname: gr\xF6\xDF"
                       "e\n"),
            "board.yaml:2:9: byte 0xF6: the text is not UTF-8");
  for (const std::string bad : {"\xC0\x80", "\xE0\x80\x80", "\xED\xA0\x80", "\xF0\x80\x80\x80",
                                "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xE2\x82", "\xFF"}) {
    EXPECT_EQ(refusal_of("# ü" + bad).substr(0, 19), "board.yaml:1:4: byt");
  }
  EXPECT_EQ(refusal_of(std::string("# \0", 3)),
            "board.yaml:1:3: control character 0x00: not allowed in YAML");
  EXPECT_EQ(refusal_of("# \x04"), "board.yaml:1:3: control character 0x04: not allowed in YAML");
  EXPECT_EQ(refusal_of("\xEF\xBB\xBF"
                       "extends: fpl2003\n"),
            "");
  EXPECT_EQ(refusal_of("\xEF\xBB\xBF"
                       "nmae: x\nextends: fpl2003\n")
                .substr(0, 32),
            "board.yaml:1:1: nmae = x: unknow");
}

TEST(BoardSyntax, ReadsLinesThatEndInCarriageReturnAndLineFeed) {
  EXPECT_EQ(refusal_of("extends: fpl2003\r\nname: x\r\nimage: {width: 3}\r\n"),
            "board.yaml:3:16: image.width = 3: 4..8192, a multiple of 4");
}

TEST(BoardSyntax, RefusesAnchorsAliasesAndTags) {
  EXPECT_EQ(refusal_of("extends: fpl2003\nimage: &a {width: 3}\npci: *a\n"),
            "board.yaml:2:8: image = {..}: anchors and aliases are not allowed in a board\n"
            "board.yaml:2:19: image.width = 3: 4..8192, a multiple of 4\n"
            "board.yaml:3:6: pci = (anchor or alias): anchors and aliases are not allowed in a board");
  EXPECT_EQ(refusal_of("extends: fpl2003\nimage: {width: !!int \"640\"}\n"),
            "board.yaml:2:16: image.width = 640: tags are not allowed in a board");
  EXPECT_EQ(refusal_of("extends: !x fpl2003\n"),
            "board.yaml:1:10: extends = fpl2003: tags are not allowed in a board");
}

TEST(BoardSyntax, RefusesDeepNestingWithoutHarm) {
  for (const std::string open : {"[", "{a: ", "- ", "? "}) {
    std::string text;
    for (int i = 0; i < 100000; ++i) text += open;
    const std::string refusal = refusal_of(text);
    EXPECT_NE(refusal.find("nested too deeply"), std::string::npos) << refusal.substr(0, 200);
  }
}

TEST(BoardSyntax, RefusesABoardThatCannotBeRead) {
  EXPECT_EQ(refusal_of_board("no/such.yaml", {}), "no/such.yaml: cannot be read: No such file or directory");
  EXPECT_EQ(refusal_of_board("/", {}), "/: a folder, not a board file");
  EXPECT_EQ(refusal_of_board("nowhere.yaml", {}), "nowhere.yaml: cannot be read: No such file or directory");
  EXPECT_EQ(refusal_of_board("/dev/zero", {}), "/dev/zero: larger than 1048576 bytes: not a board file");
}

TEST(BoardSyntax, NamesTheNearestPresetForAnUnknownOne) {
  EXPECT_EQ(
      refusal_of_board("fpl2003-qvg", {}),
      "fpl2003-qvg: not a preset, and not a path, which has a / or ends in .yaml; nearest: fpl2003-qvga; "
      "presets: fpl2003, fpl2003-no-calibration, fpl2003-line-buffer, fpl2003-qvga, fpl2003-syncburst, "
      "fpl2003-triple, four-rows, half-the-modules, two-banks, two-banks-four-rows, "
      "eight-banks-four-lanes, seven-banks-130, sdram, wvga-60hz or "
      "megapixel-pci64");
  EXPECT_NE(refusal_of_board("board.yml", {}).find("not a preset"), std::string::npos);
  EXPECT_NE(refusal_of_board("", {}).find("not a preset"), std::string::npos);
}

}  // namespace
}  // namespace stereotlm::platform::testing
