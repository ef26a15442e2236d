#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "models/memory/arbitration_policies.h"
#include "platform/config/board_area.h"
#include "platform/config/board_yaml.h"
#include "tests/unit/platform/config/board_files.h"

namespace stereotlm::platform::testing {
namespace {

int any_int(int min, int max) { return *rc::gen::inRange(min, max + 1); }

double any_decimal(double min, double max) {
  const std::int64_t part = *rc::gen::inRange<std::int64_t>(0, std::int64_t{1} << 53);
  return min + (max - min) * static_cast<double>(part) / 0x1p53;
}

double any_microseconds(double max) {
  return any_int(0, 2) == 0 ? *rc::gen::element(0.0, 0.1, 1e-6, 2e-5, 5e-324, 2.2250738585072014e-308, max)
                            : any_decimal(0, max);
}

std::vector<BankConfig> any_banks() {
  std::vector<std::string> names = {"off",   "null", "yes", "True", "No",  "on",
                                    "false", "y",    "n-1", "Z_",   "None"};
  for (int i = 0; i < 53; ++i) names.push_back("bank" + std::to_string(i));
  std::vector<BankConfig> banks;
  const int count = any_int(1, 64);
  const int first = any_int(0, 63);
  for (int i = 0; i < count; ++i) {
    BankConfig bank;
    bank.name = names[static_cast<std::size_t>(first + i) % names.size()];
    bank.words = *rc::gen::element(18000000, 18000001, 1 << 26);  // any allocation fits
    const int kind = any_int(0, static_cast<int>(memory::kBankTraits.size()) - 1);
    const memory::BankTraits& traits = memory::kBankTraits[static_cast<std::size_t>(kind)];
    bank.kind = traits.kind;
    if (traits.has_turnaround) bank.turnaround_cycles = any_int(1, 16);
    if (traits.kind == memory::BankKind::kSdram) {
      memory::SdramTiming& timing = bank.sdram.emplace();
      timing = {any_int(1, 8),  16 << any_int(0, 12),  1 << any_int(0, 3), any_int(0, 63),
                any_int(0, 63), any_int(600, 1000000), any_int(1, 255)};
      if (any_int(0, 2) == 0) timing.refresh_interval_cycles.reset();
    }
    if (any_int(0, 3) == 0) bank.standby_mw = any_int(0, 10'000'000) / 1e3;
    if (any_int(0, 3) == 0) bank.access_pj = any_int(0, 1'000'000);
    if (bank.sdram && any_int(0, 1) == 0) bank.row_pj = any_int(0, 1'000'000);
    if (bank.sdram && any_int(0, 1) == 0) bank.refresh_pj = any_int(0, 1'000'000);
    banks.push_back(bank);
  }
  return banks;
}

kernels::FilterKernel any_kernel() {
  kernels::FilterKernel kernel;
  kernel.size = 3 + 2 * any_int(0, 14);
  const auto entries = static_cast<std::size_t>(kernel.size) * static_cast<std::size_t>(kernel.size);
  kernel.weights.assign(entries, 0);
  for (std::size_t i = 0; i + 1 < entries; i += 2) {
    kernel.weights[i] = any_int(-32767, 32767);
    kernel.weights[i + 1] = -kernel.weights[i];
  }
  kernel.shift = any_int(0, 31);
  return kernel;
}

void set_optional_keys(BoardConfig& board) {
  auto& left_lut = board.allocation.left_lut;
  auto& right_lut = board.allocation.right_lut;
  if (left_lut && right_lut && any_int(0, 1) == 1) {
    right_lut = left_lut;
    board.fpga.joint_tables = true;
  }
  if (!left_lut && !right_lut && any_int(0, 1) == 1) {
    board.image = {4 * any_int(513, 2048), any_int(1, 64)};
    if (any_int(0, 1) == 1) board.image = {4 * any_int(1, 16), any_int(2049, 8192)};
  }
  board.fpga.pixel_cache = static_cast<fpga::PixelCache>(any_int(0, 1));
  MatcherConfig& matcher = board.matcher;
  if (any_int(0, 1) == 1) matcher.units = any_int(1, matcher.disparities);
  if (matcher.fetch == fpga::Fetch::kColumn)
    matcher.rows = any_int(1, std::min(16, board.fpga.result_fifo_words));
  if (matcher.fetch == fpga::Fetch::kColumn)
    board.fpga.lanes = any_int(1, std::min(16, matcher.window + matcher.rows - 1));
  using kernels::CostKind;
  matcher.cost = {*rc::gen::element(CostKind::kSad, CostKind::kSsd, CostKind::kZncc, CostKind::kCensus), 0};
  if (matcher.cost.kind == CostKind::kCensus) matcher.cost.census_size = 3 + 2 * any_int(0, 2);
}

BoardConfig any_board() {
  BoardConfig board;
  board.name = *rc::gen::element<std::string>("x", "7", "1e3", "off", "null", "größe", "a: b", "# no",
                                              "\"q\\", " ", "0x1F", "true", "- a", "{", "2003-09-01");
  board.image = {4 * any_int(1, 512), any_int(1, 2048)};
  board.cameras = {any_decimal(0.1, 1000), static_cast<CameraTrigger>(any_int(0, 1))};
  board.capture.destination = static_cast<CaptureDestination>(any_int(0, 1));
  board.capture.host_frames = any_int(1, 64);
  board.capture.fifo_words = any_int(1, 4096);
  board.capture.fifo_trigger_words = any_int(1, board.capture.fifo_words);
  board.pci = {any_decimal(1, 1000), any_int(0, 255),    any_int(0, 255),
               any_int(0, 255),      32 * any_int(1, 2), std::nullopt};
  if (any_int(0, 1) == 1) {
    board.pci.load =
        PciLoadConfig{any_int(1, 1024), any_microseconds(1e9), any_microseconds(1e9), any_microseconds(1e6)};
  }
  board.bridge = {any_decimal(1, 1000), any_int(1, 1024), any_int(1, 4096)};
  board.fpga.clock_mhz = any_decimal(1, 1000);
  const auto& policies = memory::arbitration_policies();
  const int policy = any_int(0, static_cast<int>(policies.size()) - 1);
  board.fpga.arbiter.policy = policies[static_cast<std::size_t>(policy)].name;
  auto& priority = board.fpga.arbiter.priority;
  for (std::size_t i = 0; i < priority.size(); ++i) {
    std::swap(priority[i], priority[static_cast<std::size_t>(any_int(0, 5))]);
  }
  board.fpga.lane_fifo_slots = any_int(1, 64);
  board.fpga.result_fifo_words = any_int(1, 64);
  board.fpga.result_delay_cycles = any_int(0, 64);
  board.fpga.pipeline_latency_cycles = any_int(0, 1024);
  board.banks = any_banks();
  const auto any_bank = [&board] {
    return board.banks[static_cast<std::size_t>(any_int(0, static_cast<int>(board.banks.size()) - 1))].name;
  };
  // Striped over banks of one read latency.
  const auto any_buffer = [&] {
    const std::vector<memory::SsramBankConfig> banks = ssram_configs(board);
    std::vector<std::string> stripe;
    const int latency = memory::read_latency_cycles(*rc::gen::elementOf(banks));
    for (std::size_t bank = 0; bank < banks.size() && stripe.size() < 16; ++bank) {
      if (memory::read_latency_cycles(banks[bank]) == latency) stripe.push_back(board.banks[bank].name);
    }
    return stripe.size() < 2 || any_int(0, 1) == 0 ? BufferBanks(any_bank()) : BufferBanks(stripe);
  };
  const auto any_list = [&](int length) {
    return std::vector<BufferBanks>(static_cast<std::size_t>(length), any_buffer());
  };
  const int images = any_int(1, 3);
  board.allocation = {any_list(images), any_list(images), any_list(any_int(1, 3)), std::nullopt,
                      std::nullopt};
  if (any_int(0, 1) == 1) board.allocation.left_lut = any_buffer();
  if (any_int(0, 1) == 1) board.allocation.right_lut = any_buffer();
  board.matcher.window = 3 + 2 * any_int(0, 14);
  board.matcher.disparities = any_int(1, 254);
  board.matcher.fetch = static_cast<fpga::Fetch>(any_int(0, 1));
  board.matcher.lr_tolerance = std::nullopt;
  if (any_int(0, 2) == 0) board.matcher.filter = std::nullopt;
  if (any_int(0, 2) == 0) board.matcher.filter = any_kernel();
  if (any_int(0, 2) > 0) board.matcher.lr_tolerance = any_int(0, 253);
  set_optional_keys(board);
  if (pins_of(board) <= area::find_package("ff1517")->user_pins && any_int(0, 1) == 1)
    board.fpga.package = "ff1517";
  return board;
}

RC_GTEST_PROP(BoardRoundTrip, AnyBoardReadsBackEqual, ()) {
  const BoardConfig board = any_board();
  RC_ASSERT(problems(board) == std::vector<std::string>{});
  const std::string text = to_yaml(board);
  RC_LOG() << text;
  RC_ASSERT(refusal_of(text) == "");
  const BoardConfig again = load_text(text);
  RC_ASSERT(again == board);
  RC_ASSERT(to_yaml(again) == text);
}

TEST(BoardRoundTrip, QuotesOffAndNone) {
  const std::string text =
      to_yaml(load_board("fpl2003", {"matcher.filter=none", "matcher.lr_tolerance=off",
                                     "allocation.left_lut=none", "allocation.right_lut=none"}));
  EXPECT_NE(text.find("  filter: \"none\"\n"), std::string::npos);
  EXPECT_NE(text.find("  lr_tolerance: \"off\"\n"), std::string::npos);
  EXPECT_NE(text.find("  left_lut: \"none\"\n  right_lut: \"none\"\n"), std::string::npos);
}

TEST(BoardRoundTrip, WritesALoadInFullAndNoneNotAtAll) {
  EXPECT_EQ(to_yaml(load_board("fpl2003", {"pci.load=none"})).find("load"), std::string::npos);
  EXPECT_NE(to_yaml(load_board("fpl2003", {"pci.load={burst_words: 32, interval_us: 0.00001}"}))
                .find("  memory_wait_clocks: 8\n"
                      "  load:\n"
                      "    burst_words: 32\n"
                      "    interval_us: 0.00001\n"
                      "    first_us: 0\n"
                      "    access_us: 0\n"
                      "bridge:\n"),
            std::string::npos);
}

TEST(BoardRoundTrip, WritesOptionalKeysOnlyWhereTheyHaveAnEffect) {
  const std::string usual = to_yaml(load_board("fpl2003"));
  for (const char* const name :
       {"package", "tables", "pixel_cache", "lanes", "result_delay_cycles", "units", "rows", "cost"})
    EXPECT_EQ(usual.find(std::string("  ") + name + ":"), std::string::npos) << name;
  EXPECT_EQ(to_yaml(load_board("fpl2003", {"fpga.tables=separate", "fpga.pixel_cache=none", "fpga.lanes=1",
                                           "fpga.result_delay_cycles=0", "matcher.units=all",
                                           "matcher.rows=1", "matcher.cost=sad"})),
            usual);
  EXPECT_NE(
      to_yaml(load_board("fpl2003", {"fpga.package=ff1517"})).find("  device: xc2v6000\n  package: ff1517\n"),
      std::string::npos);
  const std::string text = to_yaml(
      load_board("fpl2003", {"fpga.tables=joint", "allocation.right_lut=bank6", "fpga.pixel_cache=word",
                             "fpga.lanes=4", "fpga.result_delay_cycles=16", "ssram.banks.bank6.words=614400",
                             "matcher.units=40", "matcher.rows=4", "matcher.cost={census: 5}"}));
  EXPECT_NE(text.find("  pipeline_latency_cycles: 16\n  tables: joint\n  pixel_cache: word\n  lanes: 4\n  "
                      "result_delay_cycles: 16\nssram:"),
            std::string::npos);
  EXPECT_NE(text.find("  lr_tolerance: 0\n  units: 40\n  rows: 4\n  cost: {census: 5}\n"), std::string::npos);
  EXPECT_NE(to_yaml(load_board("fpl2003", {"matcher.cost=zncc"})).find("  cost: zncc\n"), std::string::npos);
}

TEST(BoardRoundTrip, ListsTheValuesOfAllKeys) {
  using Values = std::map<std::string, decltype(BoardValue::value)>;
  const auto values = [](const std::vector<std::string>& sets) {
    Values found;
    for (const BoardValue& value : values_of(load_board("fpl2003", sets))) found[value.path] = value.value;
    return found;
  };
  Values usual = values({});
  EXPECT_EQ(usual.at("matcher.units"), Values::mapped_type("all"));
  EXPECT_EQ(usual.at("matcher.rows"), Values::mapped_type(std::int64_t{1}));
  EXPECT_EQ(usual.at("matcher.cost"), Values::mapped_type("sad"));
  EXPECT_EQ(usual.at("fpga.tables"), Values::mapped_type("separate"));
  EXPECT_EQ(usual.at("fpga.pixel_cache"), Values::mapped_type("none"));
  usual["matcher.units"] = std::int64_t{40};
  usual["matcher.cost"] = "{census: 5}";
  EXPECT_EQ(values({"matcher.units=40", "matcher.cost={census: 5}"}), usual);
}

TEST(BoardRoundTrip, WritesTheShortestDecimals) {
  const std::string text =
      to_yaml(load_board("fpl2003", {"fpga.clock_mhz=40.000", "cameras.frame_rate_hz=29.970"}));
  EXPECT_NE(text.find("  clock_mhz: 40\n"), std::string::npos);
  EXPECT_NE(text.find("  frame_rate_hz: 29.97\n"), std::string::npos);
}

// A board file is a board or is refused, whatever was done to it.
RC_GTEST_PROP(BoardRoundTrip, ADamagedFileIsABoardOrIsRefused, ()) {
  std::string text(preset_text("fpl2003"));
  const int changes = any_int(1, 6);
  const std::string bytes = "{}[]:,-?&*!|>'\"%@`#~ \n\t\r0159azäé\x04\x7F\xFF.=<";
  for (int i = 0; i < changes; ++i) {
    const auto at = static_cast<std::size_t>(any_int(0, static_cast<int>(text.size()) - 1));
    const char byte = bytes[static_cast<std::size_t>(any_int(0, static_cast<int>(bytes.size()) - 1))];
    switch (any_int(0, 3)) {
      case 0:
        text[at] = byte;
        break;
      case 1:
        text.insert(at, 1, byte);
        break;
      case 2:
        text.erase(at, static_cast<std::size_t>(any_int(1, 40)));
        break;
      default:
        text.insert(at, text.substr(static_cast<std::size_t>(any_int(0, static_cast<int>(at))), 30));
    }
    if (text.empty()) text = " ";
  }
  const std::string refusal = refusal_of(text);  // any exception but BoardError fails the property
  RC_ASSERT(refusal.empty() || refusal.find("board.yaml:") == 0);
}

}  // namespace
}  // namespace stereotlm::platform::testing
