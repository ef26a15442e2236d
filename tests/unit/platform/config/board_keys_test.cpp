#include "platform/config/board_keys.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "tests/unit/platform/config/board_files.h"

namespace stereotlm::platform::testing {
namespace {

TEST(NearestKey, IsNamedWhereItCanBeMeant) {
  const std::vector<std::pair<std::string, std::string>> meant = {
      {"imge.width", "image.width"},
      {"image.widht", "image.width"},
      {"widht", "image.width"},
      {"image.clock_mhz", "pci.clock_mhz"},
      {"pci.lode", "pci.load"},
      {"image_width", "image.width"},
      {"matcher.filter.sift", "matcher.filter.shift"},
      {"matcher.windows", "matcher.window"},
      {"ssram.banks.b.wrods", "ssram.banks.b.words"},
      {"ssram.default.kin", "ssram.default.kind"},
      {"alocation", "allocation"},
      {"fpga.clock", "fpga.clock_mhz"},
      {"latency_timer", "pci.latency_timer_clocks"},
      {"matcher.unit", "matcher.units"},
      {"matcher.cots", "matcher.cost"},
      {"cost", "matcher.cost"},
      {"matcher.cost.cencus", "matcher.cost.census"},
      {"fpga.table", "fpga.tables"},
  };
  for (const auto& [typed, key] : meant)
    EXPECT_EQ(unknown_key_text(typed), "unknown key; nearest known key: " + key) << typed;
  const std::string of_image = "image: width, height";
  const std::string of_cameras = "cameras: frame_rate_hz, trigger";
  const std::pair<std::string, std::string> in_section[] = {
      {"image.x", of_image},
      {"image.", of_image},
      {"image.size.x", of_image},
      {"camera.fps", of_cameras},
      {"cameras.fps", of_cameras},
      {"matcher.filter.x", "matcher.filter: kernel, shift"},
      {"matcher.cost.x", "matcher.cost: census"},
  };
  for (const auto& [typed, keys] : in_section)
    EXPECT_EQ(unknown_key_text(typed), "unknown key; keys of " + keys) << typed;
  for (const std::string typed : {"x", "", "größe", "<<"})
    EXPECT_EQ(unknown_key_text(typed), "unknown key, and no known key is near") << typed;
}

TEST(NearestWord, IsNamedWhereItCanBeMeant) {
  const std::vector<std::string> words = {"bank0", "bank1", "left_bank", "a"};
  EXPECT_EQ(nearest_text("bank9", words), "; nearest: bank0");
  EXPECT_EQ(nearest_text("bakn1", words), "; nearest: bank1");
  EXPECT_EQ(nearest_text("lft_bnk", words), "; nearest: left_bank");
  for (const std::string typed : {"x", "", "none", "memory"})
    EXPECT_EQ(nearest_text(typed, words), "") << typed;
  EXPECT_EQ(nearest_text("x", {}), "");
}

// One key: values at and inside its limits, values beyond them, and the rule as messages give it.
struct KeyCase {
  std::string path;
  std::vector<std::string> accepted;
  std::vector<std::string> refused;
  std::string rule;
  std::vector<std::string> mistyped = {};
};

const std::vector<std::string> kNoInteger = {"0x10", "1e3",  "1_000", "\"7\"", "+7",    "7.0", "seven",
                                             "[7]",  "{}",   "~",     "null",  "'7'",   "-",   "7a",
                                             "true", ".inf", ".nan",  "0o7",   "1 000", "0b1"};
const std::vector<std::string> kNoDecimal = {"0x10", "1e3", "1_000", "\"7\"", "+7",   "7.",   ".5",
                                             "fast", "[7]", "{}",    "null",  ".inf", ".nan", "-.inf"};
const std::string kTooLong = "99999999999999999999999999999999999999";

KeyCase integer_case(const std::string& path, int min, int max) {
  return {path,
          {std::to_string(min), std::to_string(max), "00" + std::to_string(max)},
          {std::to_string(min - 1), std::to_string(max + 1), "4294967297", kTooLong, '-' + kTooLong},
          fmt::format("{}..{}", min, max),
          kNoInteger};
}

KeyCase decimal_case(const std::string& path, const std::string& min, const std::string& below,
                     const std::string& above) {
  return {path,
          {min, "1000", "1000.000", "33.333", "29.97"},
          {below, above, "0", "-1", kTooLong, std::string(400, '9'), "0." + std::string(400, '0') + '1'},
          fmt::format("{}..1000", min),
          kNoDecimal};
}

KeyCase microseconds_case(const std::string& path, const std::string& max) {
  return {path,
          {"0", "0.0", "0.000001", "10", max, max + ".000", "0." + std::string(400, '0') + '1'},
          {"-1", "-0.000001", max + ".001", kTooLong, std::string(400, '9')},
          "0.." + max,
          kNoDecimal};
}

std::vector<KeyCase> key_cases() {
  const std::string one = "a bank, a stripe {rows: [..]} of 2..16 banks, or ";
  const std::string list = one + "a list of 1 to 3 of them";
  const std::string images = list + "; left_image and right_image equally long";
  KeyCase width = integer_case("image.width", 4, 2048);  // beyond: BoardImage of board_rules_test.cpp
  width.refused = {"3", "0", "-4", "641", "642", "643", "8191", "8193", "8196", kTooLong};
  width.rule = "4..8192, a multiple of 4";
  KeyCase window = integer_case("matcher.window", 3, 31);
  window.refused = {"1", "2", "4", "30", "32", "33", "-7", kTooLong};
  window.rule = "3..31, odd";
  KeyCase tolerance = integer_case("matcher.lr_tolerance", 0, 253);
  tolerance.accepted.insert(tolerance.accepted.end(), {"off", "\"off\"", "'off'", "-0"});
  tolerance.rule = "0..253 or off";
  KeyCase units{"matcher.units",
                {"1", "80", "0080", "all", "\"all\"", "'all'"},
                {"0", "-1", "255", kTooLong},
                "1..254 or all",
                kNoInteger};
  units.mistyped.insert(units.mistyped.end(), {"false", "none", "All"});
  KeyCase rows = integer_case("matcher.rows", 1, 16);
  rows.accepted = {"1", "8", "08"};  // more: BoardRows of board_rules_test.cpp
  KeyCase lanes = integer_case("fpga.lanes", 1, 16);
  lanes.accepted = {"1", "7", "07"};  // more: BoardLanes of board_rules_test.cpp
  tolerance.mistyped.insert(tolerance.mistyped.end(), {"false", "none", "Off"});
  return {
      {"name",
       {"x", "\"7\"", "off", "'null'", "two words", "größe", "7a", "e3", "0xg", "1e", "1.2.3", "2003-09-01",
        "_1"},
       {"7", "1.5", "0x10", "true", "False", "null", "~", "\"\"", "[a]", "{a: b}", ".inf", "-.Inf", "+.NaN",
        "1e3", ".5e-3", "+7", "1_000", "1.", "0O17"},
       "a text of one or more characters without control characters; quoted if it could be read as a number, "
       "a truth value or null"},
      width,
      {"image.height", {"1", "480", "2048"}, {"0", "-1", "8193", kTooLong}, "1..8192", kNoInteger},
      decimal_case("cameras.frame_rate_hz", "0.1", "0.0999", "1000.0001"),
      {"cameras.trigger",
       {"free_running", "on_demand", "\"on_demand\""},
       {"off", "none", "on-demand", "[on_demand]", "null", "1", "On_demand"},
       "free_running or on_demand"},
      {"capture.destination", {"board", "host_memory"}, {"host", "null", "{}"}, "board or host_memory"},
      integer_case("capture.host_frames", 1, 64),
      {"capture.fifo_words", {"32", "4096"}, {"0", "-1", "4097", kTooLong}, "1..4096", kNoInteger},
      {"capture.fifo_trigger_words",
       {"1", "140"},
       {"0", "-1", "4097", kTooLong},
       "1..fifo_words",
       kNoInteger},
      decimal_case("pci.clock_mhz", "1", "0.999", "1000.001"),
      integer_case("pci.latency_timer_clocks", 0, 255),
      integer_case("pci.bridge_wait_clocks", 0, 255),
      integer_case("pci.memory_wait_clocks", 0, 255),
      {"pci.width_bits",
       {"32", "64", "064"},
       {"0", "-32", "31", "33", "48", "63", "65", "96", kTooLong},
       "32..64, a multiple of 32",
       kNoInteger},
      {"pci.load",
       {"none", "\"none\"", "'none'", "{burst_words: 8, interval_us: 10}",
        "{access_us: 1, first_us: 2.5, interval_us: 0, burst_words: 1024}"},
       {"off", "false", "null", "~", "[]", "[none]", "7", "None"},
       "none or a map of burst_words, interval_us, first_us, access_us"},
      integer_case("pci.load.burst_words", 1, 1024),
      microseconds_case("pci.load.interval_us", "1000000000"),
      microseconds_case("pci.load.first_us", "1000000000"),
      microseconds_case("pci.load.access_us", "1000000"),
      decimal_case("bridge.local_clock_mhz", "1", "0.999", "1000.001"),
      integer_case("bridge.dma_burst_words", 1, 1024),
      integer_case("bridge.posted_words", 1, 4096),
      {"fpga.device",
       {"xc2v6000", "\"xc2v6000\"", "xc2v1000", "xc2v8000"},
       {"xc4vlx25", "XC2V6000", "null", "[xc2v6000]"},
       "xc2v1000, xc2v1500, xc2v2000, xc2v3000, xc2v4000, xc2v6000 or xc2v8000"},
      {"fpga.package", {"ff1152", "\"ff1517\""}, {"ff896", "FF1152", "null", "[ff1152]"}, "ff1152 or ff1517"},
      decimal_case("fpga.clock_mhz", "1", "0.999", "1000.001"),
      {"fpga.arbitration",
       {"fixed_priority", "round_robin", "age"},
       {"lottery", "null", "[round_robin]"},
       "fixed_priority, round_robin or age"},
      {"fpga.priority",
       {"[right_lut, left_lut, right_pixel, left_pixel, result, host]"},
       {"host", "{}", "null", "5"},
       "a list that names each port once: left_lut, right_lut, left_pixel, right_pixel, result, "
       "host"},
      integer_case("fpga.lane_fifo_slots", 1, 64),
      integer_case("fpga.result_fifo_words", 1, 64),
      integer_case("fpga.pipeline_latency_cycles", 0, 1024),
      {"fpga.tables",
       {"separate", "\"separate\""},
       {"separated", "null", "[joint]", "true", "Joint"},
       "separate or joint"},
      {"fpga.pixel_cache",
       {"none", "\"none\"", "word", "'word'"},
       {"line", "off", "null", "[word]", "1", "None"},
       "none or word"},
      lanes,
      integer_case("fpga.result_delay_cycles", 0, 64),
      {"allocation.left_image",
       {"[bank0, bank1]", "[bank7, bank7]", "['bank0', bank2]"},
       {"[]", "[bank0, bank1, bank2, bank3]", "null", "{bank0: bank1}"},
       images},
      {"allocation.right_image",
       {"[bank0, bank1]"},
       {"[]", "[bank0, bank1, bank2, bank3]", "~", "{}"},
       images},
      {"allocation.disparity",
       {"bank4", "[bank4]", "[bank4, bank4, bank5]"},
       {"[]", "[bank0, bank1, bank2, bank3]", "null", "{}"},
       list},
      {"allocation.left_lut",
       {"none", "\"none\"", "bank6", "[bank6]", "[none]"},
       {"null", "[]", "[bank6, bank7]", "{}"},
       one + "none"},
      {"allocation.right_lut", {"none", "bank7"}, {"~", "[]", "[bank6, bank7]", "{}"}, one + "none"},
      window,
      integer_case("matcher.disparities", 1, 254),
      {"matcher.filter",
       {"none", "\"none\"", "log7", "{kernel: [[0, 0, 0], [1, -2, 1], [0, 0, 0]], shift: 0}"},
       {"log9", "off", "false", "null", "[]", "7"},
       "none, log7 or a map of kernel, shift"},
      {"matcher.fetch", {"column", "line_buffer"}, {"columns", "null", "[column]"}, "column or line_buffer"},
      tolerance,
      units,
      rows,
      {"matcher.cost",
       {"sad", "ssd", "zncc", "\"zncc\"", "{census: 3}", "{census: 5}", "{'census': 7}"},
       {"census", "ncc", "null", "~", "[sad]", "[]", "5", "Sad"},
       "sad, ssd, zncc, {census: 3}, {census: 5} or {census: 7}"},
  };
}

class BoardKeys : public ::testing::TestWithParam<KeyCase> {};

TEST_P(BoardKeys, TakeTheirValuesUpToBothLimits) {
  for (const std::string& value : GetParam().accepted) {
    const ChangedBoard board = board_with(GetParam().path, value);
    EXPECT_EQ(refusal_of(board.text), "") << value;
    EXPECT_EQ(refusal_of(block_board(), {GetParam().path + '=' + value}), "") << value;
  }
}

TEST_P(BoardKeys, RefuseAValueBeyondTheirRuleAtItsPlace) {
  const KeyCase& key = GetParam();
  for (const std::string& value : key.refused) {
    const ChangedBoard board = board_with(key.path, value);
    const std::string shown = value.size() > 60 ? value.substr(0, 57) + "..." : value;
    const bool is_word = key.rule == listed(board_key(key.path).rule.words) || key.path == "matcher.cost";
    const std::string text =
        fmt::format("{} = {}: {}{}", key.path, shown, is_word ? "must be one of " : "", key.rule);
    EXPECT_EQ(refusal_of(board.text), board.place + ": " + text);
    EXPECT_EQ(refusal_of(block_board(), {key.path + '=' + value}),
              fmt::format("--set {}: {}", key.path, text));
  }
}

TEST_P(BoardKeys, RefuseWhatIsNoNumberAtItsPlace) {
  const KeyCase& key = GetParam();
  const bool is_decimal = key.rule.find("..1000") != std::string::npos && key.mistyped == kNoDecimal;
  const std::string type = is_decimal ? "not a decimal number (such as 29.97, not in quotes)"
                                      : "not an integer (decimal digits, not in quotes)";
  for (const std::string& value : key.mistyped) {
    const ChangedBoard board = board_with(key.path, value);
    const std::string shown = value == "'7'" ? "\"7\"" : value;
    const std::string place = value == "-" ? "" : board.place;  // `-` begins a list: no YAML here
    const std::string refusal = refusal_of(board.text);
    if (place.empty()) {
      EXPECT_NE(refusal.find("not YAML"), std::string::npos) << refusal;
    } else {
      EXPECT_EQ(refusal, fmt::format("{}: {} = {}: {}; {}", place, key.path, shown, type, key.rule));
    }
  }
}

std::string case_name(const ::testing::TestParamInfo<KeyCase>& key) {
  std::string name = key.param.path;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, BoardKeys, ::testing::ValuesIn(key_cases()), case_name);

TEST(BoardKeysTable, ListsEveryKeyOfTheCasesAndOfBanksFiltersAndCosts) {
  std::set<std::string> expected = {"extends",
                                    "matcher.filter.kernel",
                                    "matcher.filter.shift",
                                    "matcher.cost.census",
                                    "ssram.default.words",
                                    "ssram.default.kind",
                                    "ssram.default.turnaround_cycles",
                                    "ssram.banks.NAME.words",
                                    "ssram.banks.NAME.kind",
                                    "ssram.banks.NAME.turnaround_cycles"};
  for (const char* const name :
       {"cas_latency", "row_words", "internal_banks", "activate_cycles", "precharge_cycles",
        "refresh_interval_cycles", "refresh_cycles", "energy.standby_mw", "energy.access_pj", "energy.row_pj",
        "energy.refresh_pj"}) {
    for (const std::string of : {"ssram.default.", "ssram.banks.NAME."}) expected.insert(of + name);
  }
  for (const KeyCase& key : key_cases()) expected.insert(key.path);
  std::set<std::string> listed;
  for (const Key& key : keys()) {
    EXPECT_FALSE(key.meaning.empty()) << key.path;
    EXPECT_FALSE(key.rule.text.empty()) << key.path;
    EXPECT_TRUE(listed.insert(key.path).second) << key.path;
  }
  EXPECT_EQ(listed, expected);
}

TEST(BoardKeysTable, SaysWhichKeysMayBeMissing) {
  for (const Key& key : board_keys()) {
    if (!has_value(key) || key.path.find("pci.load.") == 0) continue;
    EXPECT_EQ(key.is_optional, key.meaning.find("optional, without it") != std::string::npos) << key.path;
    std::string text = board_with(key.path, "DROP").text;
    const std::size_t value = text.find("DROP");
    const std::size_t begin = text.rfind('\n', value) + 1;  // npos + 1 is 0
    text.erase(begin, text.find('\n', value) + 1 - begin);
    const std::string missing = fmt::format(": {}: missing: {}", key.path, key.rule.text);
    EXPECT_EQ(refusal_of(text).find(missing) == std::string::npos, key.is_optional) << key.path;
  }
}

TEST(BankText, TellsABankFromAPartOfTheModelOfTheSameName) {
  for (const char* name : {"bank0", "bank17"}) EXPECT_EQ(bank_text(name), name);
  for (const std::string name : {"matcher", "pci", "bank", "bank_pci", "bank0b", "Bank0", "frame0"})
    EXPECT_EQ(bank_text(name), "bank " + name);
}

}  // namespace
}  // namespace stereotlm::platform::testing
