#include "tests/support/board_of_random.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

namespace stereotlm::test {
namespace {

memory::Port port_of(PlainPort plain) {
  memory::Port port = 0;
  while (std::string(fpga::kPortGroups[port].name) != name_of(plain)) ++port;
  return port;
}

memory::BankKind kind_of(PlainBankKind kind) {
  using memory::BankKind;
  static constexpr std::array<BankKind, 5> kKinds = {BankKind::kZbtPipelined, BankKind::kZbtFlowThrough,
                                                     BankKind::kSyncBurst, BankKind::kQdr, BankKind::kSdram};
  return kKinds[static_cast<std::size_t>(kind)];
}

double value_of(const PlainNumber& number) {
  return static_cast<double>(number.numerator) / static_cast<double>(number.denominator);
}

double us_of(PlainTime ps) { return static_cast<double>(ps) / 1e6; }

std::string bank_name(int bank) { return "bank" + std::to_string(bank); }

platform::BufferBanks banks_of(const PlainBuffer& buffer) {
  std::vector<std::string> names;
  for (const int bank : buffer.banks) names.push_back(bank_name(bank));
  return platform::BufferBanks(names);
}

std::vector<platform::BufferBanks> banks_of(const std::vector<PlainBuffer>& list) {
  std::vector<platform::BufferBanks> all;
  for (const PlainBuffer& buffer : list) all.push_back(banks_of(buffer));
  return all;
}

std::optional<platform::BufferBanks> banks_of(const std::optional<PlainBuffer>& buffer) {
  return buffer ? std::optional(banks_of(*buffer)) : std::nullopt;
}

memory::SdramTiming timing_of(const PlainSdram& sdram) {
  memory::SdramTiming timing;
  timing.cas_latency = sdram.cas_latency;
  timing.row_words = sdram.row_words;
  timing.internal_banks = sdram.internal_banks;
  timing.activate_cycles = sdram.activate_cycles;
  timing.precharge_cycles = sdram.precharge_cycles;
  timing.refresh_cycles = sdram.refresh_cycles;
  timing.refresh_interval_cycles.reset();
  if (sdram.refresh_interval_cycles != 0) timing.refresh_interval_cycles = sdram.refresh_interval_cycles;
  return timing;
}

std::vector<platform::BankConfig> bank_configs(const PlainCycleInput& input) {
  std::vector<platform::BankConfig> banks;
  for (const PlainBank& bank : input.banks) {
    const bool turns = bank.kind == PlainBankKind::kSyncBurst;
    banks.push_back({bank_name(static_cast<int>(banks.size())), 0, kind_of(bank.kind),
                     turns ? bank.turnaround_cycles : 0});
    if (bank.kind == PlainBankKind::kSdram) banks.back().sdram = timing_of(bank.sdram);
    if (!bank.energy) continue;
    banks.back().standby_mw = bank.energy->standby_uw / 1e3;
    banks.back().access_pj = bank.energy->access_pj;
    if (bank.kind != PlainBankKind::kSdram) continue;
    banks.back().row_pj = bank.energy->row_pj;
    banks.back().refresh_pj = bank.energy->refresh_pj;
  }
  const auto add = [&](const PlainBuffer& buffer, int row_words) {
    for (std::size_t part = 0; part < buffer.banks.size(); ++part)
      banks[static_cast<std::size_t>(buffer.banks[part])].words +=
          row_words * plain_rows(buffer.banks.size(), part, input.height);
  };
  for (const auto* list : {&input.left_image, &input.right_image, &input.disparity}) {
    for (const PlainBuffer& buffer : *list) add(buffer, input.width / 4);
  }
  if (input.left_lut) add(*input.left_lut, input.width);
  if (input.right_lut && !input.joint_tables) add(*input.right_lut, input.width);
  for (platform::BankConfig& bank : banks) bank.words = std::max(bank.words, 1);
  return banks;
}

std::optional<kernels::RectificationTable> table_of(
    const PlainCycleInput& input, const std::optional<PlainBuffer>& buffer,
    const std::optional<std::vector<std::uint32_t>>& entries) {
  if (!buffer) return std::nullopt;
  if (!entries) throw std::invalid_argument("board_tables: a side with a bank for its table has no entries");
  return kernels::RectificationTable{input.width, input.height, *entries};
}

// A cost that looks as far ahead. The timing depends on nothing else of it.
kernels::MatchingCost cost_of_half(int half) {
  if (half == 0) return {};
  return {kernels::CostKind::kCensus, 2 * half + 1};
}

kernels::MatchingCost cost_of(const ReferenceCost& cost) {
  using kernels::CostKind;
  static constexpr std::array<CostKind, 4> kKinds = {CostKind::kSad, CostKind::kSsd, CostKind::kZncc,
                                                     CostKind::kCensus};
  return {kKinds[static_cast<std::size_t>(cost.kind)], cost.census_size};
}

kernels::GrayImage gray_image(const RandomBoard& board, const std::vector<std::uint8_t>& pixels) {
  kernels::GrayImage image(board.width, board.height);
  if (image.pixels.size() != pixels.size()) {
    throw std::invalid_argument("stereo_pair: " + std::to_string(pixels.size()) + " pixels for " +
                                std::to_string(board.width) + " x " + std::to_string(board.height));
  }
  image.pixels = pixels;
  return image;
}

}  // namespace

platform::BoardConfig board_config(const PlainCycleInput& input) {
  platform::BoardConfig board;
  board.name = "plain";
  board.image = {input.width, input.height};
  board.fpga.arbiter.policy = name_of(input.arbitration);
  std::transform(input.priority.begin(), input.priority.end(), board.fpga.arbiter.priority.begin(), port_of);
  board.fpga.lanes = input.lanes;
  board.fpga.lane_fifo_slots = input.lane_fifo_slots;
  board.fpga.result_fifo_words = input.result_fifo_words;
  board.fpga.result_delay_cycles = input.result_delay_cycles;
  board.fpga.pipeline_latency_cycles = input.pipeline_latency_cycles;
  board.banks = bank_configs(input);
  board.allocation.left_image = banks_of(input.left_image);
  board.allocation.right_image = banks_of(input.right_image);
  board.allocation.disparity = banks_of(input.disparity);
  board.allocation.left_lut = banks_of(input.left_lut);
  board.allocation.right_lut = banks_of(input.right_lut);
  board.matcher.window = input.window;
  board.matcher.disparities = input.disparities;
  board.matcher.filter.reset();
  if (input.filter_half > 0) {
    kernels::FilterKernel kernel{2 * input.filter_half + 1, {}, 2};
    kernel.weights.resize(static_cast<std::size_t>(kernel.size) * static_cast<std::size_t>(kernel.size));
    kernel.weights.front() = 3;
    kernel.weights.back() = -3;
    board.matcher.filter = kernel;
  }
  if (input.units != 0) board.matcher.units = input.units;
  board.matcher.rows = input.rows;
  board.matcher.cost = cost_of_half(input.cost_half);
  board.fpga.joint_tables = input.joint_tables;
  board.fpga.pixel_cache = input.word_cache ? fpga::PixelCache::kWord : fpga::PixelCache::kNone;
  board.matcher.fetch = input.fetch == PlainFetch::kColumn ? fpga::Fetch::kColumn : fpga::Fetch::kLineBuffer;
  return board;
}

platform::Tables board_tables(const PlainCycleInput& input) {
  return {table_of(input, input.left_lut, input.left_table),
          table_of(input, input.right_lut, input.right_table)};
}

platform::BoardConfig board_config(const RandomBoard& board) {
  platform::BoardConfig config = board_config(cycle_input(board));
  config.name = "random-" + std::to_string(board.seed);
  if (board.filter)
    config.matcher.filter =
        kernels::FilterKernel{board.filter->size, board.filter->weights, board.filter->shift};
  config.matcher.lr_tolerance = board.lr_tolerance;
  config.fpga.clock_mhz = value_of(board.clock_mhz);
  config.matcher.cost = cost_of(board.cost);
  return config;
}

host::StereoPair stereo_pair(const RandomBoard& board, int frame) {
  return stereo_pair(board, board.pictures_of_frame(frame));
}

host::StereoPair stereo_pair(const RandomBoard& board, const PicturePair& pictures) {
  return {gray_image(board, pictures.left), gray_image(board, pictures.right)};
}

platform::BoardConfig board_config(const RandomComputer& computer) {
  const PlainComputerInput& input = computer.input;
  platform::BoardConfig board = board_config(computer.board);
  board.cameras.frame_rate_hz = value_of(input.frame_rate_hz);
  board.cameras.trigger =
      input.on_demand ? platform::CameraTrigger::kOnDemand : platform::CameraTrigger::kFreeRunning;
  board.capture.destination = input.capture_to_host ? platform::CaptureDestination::kHostMemory
                                                    : platform::CaptureDestination::kBoard;
  board.capture.host_frames = input.host_frames;
  board.capture.fifo_words = input.fifo_words;
  board.capture.fifo_trigger_words = input.fifo_trigger_words;
  board.pci.clock_mhz = value_of(input.pci_clock_mhz);
  board.pci.latency_timer_clocks = input.latency_timer_clocks;
  board.pci.bridge_wait_clocks = input.bridge_wait_clocks;
  board.pci.memory_wait_clocks = input.memory_wait_clocks;
  board.pci.width_bits = input.pci_width_bits;
  if (input.load) {
    board.pci.load = platform::PciLoadConfig{input.load->burst_words, us_of(input.load->interval_ps),
                                             us_of(input.load->first_ps), us_of(input.load->access_ps)};
  }
  board.bridge.local_clock_mhz = value_of(input.local_clock_mhz);
  board.bridge.dma_burst_words = input.dma_burst_words;
  board.bridge.posted_words = input.posted_words;
  board.fpga.clock_mhz = value_of(input.board.clock_mhz);
  return board;
}

std::string energy_text(const platform::Statistics& run) {
  std::string text;
  for (const platform::BankStatistics& bank : run.banks) {
    if (const auto& energy = bank.energy)
      text += fmt::format("{} {} {} {} {}\n", bank.name, energy->accesses, energy->rows_opened.value_or(0),
                          energy->refreshes.value_or(0), energy->energy_pj);
  }
  for (const platform::BufferStatistics& buffer : run.energy.buffers)
    text += fmt::format("{} {}\n", buffer.name, buffer.bytes);
  return text + fmt::format("all {} {}\n", run.energy.time_ps, run.energy.memory_pj);
}

}  // namespace stereotlm::test
