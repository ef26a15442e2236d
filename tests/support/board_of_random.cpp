#include "tests/support/board_of_random.h"

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
  static constexpr std::array<BankKind, 4> kKinds = {BankKind::kZbtPipelined, BankKind::kZbtFlowThrough,
                                                     BankKind::kSyncBurst, BankKind::kQdr};
  return kKinds[static_cast<std::size_t>(kind)];
}

double value_of(const PlainNumber& number) {
  return static_cast<double>(number.numerator) / static_cast<double>(number.denominator);
}

double us_of(PlainTime ps) { return static_cast<double>(ps) / 1e6; }

std::string bank_name(int bank) { return "bank" + std::to_string(bank); }

// The bank of a buffer without stripes.
int bank_of(const PlainBuffer& buffer) { return buffer.banks.front(); }

std::vector<std::string> bank_names(const std::vector<PlainBuffer>& list) {
  std::vector<std::string> names;
  for (const PlainBuffer& buffer : list) names.push_back(bank_name(bank_of(buffer)));
  return names;
}

std::optional<std::string> bank_name(const std::optional<PlainBuffer>& buffer) {
  if (!buffer) return std::nullopt;
  return bank_name(bank_of(*buffer));
}

// The platform has no stripes and no SDRAM yet (section 8).
void refuse_section_8(const PlainCycleInput& input) {
  std::vector<PlainBuffer> buffers;
  for (const auto* list : {&input.left_image, &input.right_image, &input.disparity})
    buffers.insert(buffers.end(), list->begin(), list->end());
  for (const auto* table : {&input.left_lut, &input.right_lut}) {
    if (*table) buffers.push_back(**table);
  }
  const bool striped = std::any_of(buffers.begin(), buffers.end(),
                                   [](const PlainBuffer& buffer) { return buffer.banks.size() > 1; });
  const bool sdram = std::any_of(input.banks.begin(), input.banks.end(),
                                 [](const PlainBank& bank) { return bank.kind == PlainBankKind::kSdram; });
  if (striped || sdram)
    throw std::invalid_argument("board_config: stripes and sdram are not in the platform");
}

std::vector<platform::BankConfig> bank_configs(const PlainCycleInput& input) {
  std::vector<platform::BankConfig> banks;
  for (const PlainBank& bank : input.banks) {
    const bool turns = bank.kind == PlainBankKind::kSyncBurst;
    banks.push_back({bank_name(static_cast<int>(banks.size())), 0, kind_of(bank.kind),
                     turns ? bank.turnaround_cycles : 0});
  }
  const int table_words = input.width * input.height;
  const auto add = [&banks](int bank, int words) { banks[static_cast<std::size_t>(bank)].words += words; };
  for (const auto* list : {&input.left_image, &input.right_image, &input.disparity}) {
    for (const PlainBuffer& buffer : *list) add(bank_of(buffer), table_words / 4);
  }
  if (input.left_lut) add(bank_of(*input.left_lut), table_words);
  if (input.right_lut && !input.joint_tables) add(bank_of(*input.right_lut), table_words);
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
  refuse_section_8(input);
  platform::BoardConfig board;
  board.name = "plain";
  board.image = {input.width, input.height};
  board.fpga.arbiter.policy = name_of(input.arbitration);
  std::transform(input.priority.begin(), input.priority.end(), board.fpga.arbiter.priority.begin(), port_of);
  board.fpga.lanes = input.lanes;
  board.fpga.lane_fifo_slots = input.lane_fifo_slots;
  board.fpga.result_fifo_words = input.result_fifo_words;
  board.fpga.pipeline_latency_cycles = input.pipeline_latency_cycles;
  board.banks = bank_configs(input);
  board.allocation.left_image = bank_names(input.left_image);
  board.allocation.right_image = bank_names(input.right_image);
  board.allocation.disparity = bank_names(input.disparity);
  board.allocation.left_lut = bank_name(input.left_lut);
  board.allocation.right_lut = bank_name(input.right_lut);
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

}  // namespace stereotlm::test
