#include "tests/integration/rtl/rtl_board.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "models/fpga/register_map.h"
#include "platform/config/buffer_layout.h"

namespace stereotlm::test {
namespace {

constexpr int kResetCycles = 100;

// The number of an arbitration policy in bank_arbiter.v.
std::uint32_t policy_of(const std::string& name) {
  const std::vector<std::string> names = {"fixed_priority", "round_robin", "age"};
  return static_cast<std::uint32_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

}  // namespace

RtlBoard::RtlBoard(const platform::BoardConfig& board, const platform::Tables& tables, RtlCore& core)
    : board_(board), buffers_(platform::buffer_bases(board)), core_(core) {
  const auto banks = platform::ssram_configs(board);
  for (std::size_t bank = 0; bank < banks.size(); ++bank) {
    banks_.push_back({std::vector<std::uint32_t>(banks[bank].words)});
    inputs_.turnaround[bank] = static_cast<std::uint32_t>(banks[bank].turnaround_cycles);
    inputs_.latency_2[bank] = memory::read_latency_cycles(banks[bank]) == 2;
  }
  inputs_.policy = policy_of(board.fpga.arbiter.policy);
  for (std::size_t place = 0; place < board.fpga.arbiter.priority.size(); ++place)
    inputs_.priority_list |= static_cast<std::uint32_t>(board.fpga.arbiter.priority[place]) << 3 * place;
  const auto load_table = [this](std::uint32_t base, const std::vector<std::uint32_t>& entries) {
    for (std::size_t word = 0; word < entries.size(); ++word) word_at(base, word) = entries[word];
  };
  if (tables.left) load_table(*buffers_.left_lut, tables.left->entries);
  if (tables.right) load_table(*buffers_.right_lut, tables.right->entries);
  inputs_.reset = true;
  for (int cycle = 0; cycle < kResetCycles; ++cycle) step();
  inputs_.reset = false;
  inputs_.bases = buffers_.of_frame(0);
  inputs_.start = true;
  step();
  inputs_.start = false;
}

kernels::GrayImage RtlBoard::run_frame(const host::StereoPair& pair, bool last, std::uint64_t most_cycles,
                                       const Observer& observer) {
  const std::uint64_t frame = frame_cycles_.size();
  const fpga::FrameBases bases = buffers_.of_frame(frame);
  load(bases[2], pair.left.pixels);
  load(bases[3], pair.right.pixels);
  const int latency = board_.fpga.pipeline_latency_cycles;
  inputs_.bases = buffers_.of_frame(frame + 1);
  inputs_.starts_at_end = latency == 0 && !last;
  for (std::uint64_t cycles = 1;; ++cycles) {
    if (cycles > most_cycles)
      throw std::runtime_error("the frame has not ended after " + std::to_string(most_cycles) + " cycles");
    const RtlOutputs& outputs = step();
    observer(frame, outputs);
    if (!outputs.ends) continue;
    frame_cycles_.push_back(cycles + static_cast<std::uint64_t>(latency));
    break;
  }
  for (int left = latency; left > 0; --left) {
    inputs_.start = left == 1 && !last;
    step();
  }
  inputs_.start = false;
  kernels::GrayImage disparity(board_.image.width, board_.image.height);
  for (std::size_t pixel = 0; pixel < disparity.pixels.size(); ++pixel)
    disparity.pixels[pixel] = static_cast<std::uint8_t>(word_at(bases[4], pixel / 4) >> 8 * (pixel % 4));
  return disparity;
}

std::uint32_t& RtlBoard::word_at(std::uint32_t base, std::size_t word) {
  return banks_.at(fpga::registers::bank_of(base)).words.at(fpga::registers::first_word_of(base) + word);
}

void RtlBoard::load(std::uint32_t base, const std::vector<std::uint8_t>& pixels) {
  for (std::size_t pixel = 0; pixel < pixels.size(); ++pixel) {
    std::uint32_t& word = word_at(base, pixel / 4);
    const std::size_t shift = 8 * (pixel % 4);
    word = (word & ~(0xFFU << shift)) | std::uint32_t{pixels[pixel]} << shift;
  }
}

// Runs a cycle. What it reads and writes has its effect at the end.
const RtlOutputs& RtlBoard::step() {
  for (std::size_t bank = 0; bank < banks_.size(); ++bank)
    inputs_.read_data[bank] = banks_[bank].coming[inputs_.latency_2[bank] ? 1 : 0];
  const RtlOutputs& outputs = core_.step(inputs_);
  for (std::size_t bank = 0; bank < kRtlBanks; ++bank) {
    const RtlOutputs::Bank& access = outputs.banks[bank];
    if (access.enable && bank >= banks_.size())
      throw std::runtime_error("access to bank " + std::to_string(bank) + ", which the board does not have");
    if (bank >= banks_.size()) continue;
    Bank& memory = banks_[bank];
    memory.coming = {kNothing, memory.coming[0]};
    if (!access.enable) continue;
    std::uint32_t& word = memory.words.at(access.address);
    access.write ? word = access.write_data : memory.coming[0] = word;
  }
  return outputs;
}

}  // namespace stereotlm::test
