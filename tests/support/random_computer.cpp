#include "tests/support/random_computer.h"

#include <algorithm>
#include <vector>

namespace stereotlm::test {
namespace {

template <typename Value>
Value one_of(SplitMix64& random, const std::vector<Value>& values) {
  return values[static_cast<std::size_t>(random.between(0, static_cast<int>(values.size()) - 1))];
}

// A number of low..high with four decimals: clocks of such frequencies never come back into phase.
std::string odd_number(SplitMix64& random, int low, int high) {
  const std::string decimals = std::to_string(10'000 + random.between(0, 9999)).substr(1);
  return std::to_string(random.between(low, high - 1)) + '.' + decimals;
}

std::string usual_or_odd(SplitMix64& random, const std::vector<std::string>& usual, int low, int high) {
  return random.chance(70) ? one_of(random, usual) : odd_number(random, low, high);
}

PlainTime ps_of_us(const std::string& us) {
  const PlainNumber number = plain_number(us);
  return static_cast<PlainTime>(number.numerator * 1'000'000 / number.denominator);
}

}  // namespace

RandomComputer make_random_computer(std::uint64_t seed) {
  RandomComputer computer;
  computer.board = make_random_board(seed);
  SplitMix64 random(seed + 1'000'000);
  computer.frame_rate_hz = usual_or_odd(random, {"1000", "500", "299.7", "99.9"}, 100, 1000);
  computer.on_demand = random.chance(25);
  computer.capture_to_host = random.chance(40);
  computer.host_frames = random.between(1, 4);
  computer.fifo_words = one_of<int>(random, {1, 2, 3, 16, 140, 4096});
  computer.fifo_trigger_words = random.between(1, std::min(computer.fifo_words, 32));
  computer.pci_clock_mhz = usual_or_odd(random, {"33.333", "33.333", "40", "66", "10", "133.7"}, 5, 150);
  computer.latency_timer_clocks = one_of<int>(random, {0, 1, 5, 16, 64, 255});
  computer.bridge_wait_clocks = one_of<int>(random, {0, 1, 4, 4, 40});
  computer.memory_wait_clocks = one_of<int>(random, {0, 1, 8, 8, 40});
  computer.local_clock_mhz = usual_or_odd(random, {"40", "40", "10", "66.6", "160"}, 5, 170);
  computer.dma_burst_words = one_of<int>(random, {1, 2, 7, 32, 1024});
  computer.posted_words = one_of<int>(random, {1, 2, 5, 64, 4096});
  computer.fpga_clock_mhz = usual_or_odd(random, {"40", "40", "12.5", "100"}, 12, 120);
  computer.frames = random.between(1, 8);
  if (random.chance(30)) {
    computer.load = RandomComputer::Load{
        one_of<int>(random, {1, 32, 500}), one_of<std::string>(random, {"0", "5", "100"}),
        one_of<std::string>(random, {"0", "777.7"}), one_of<std::string>(random, {"0", "0", "1", "60"})};
  }
  return computer;
}

PicturePair camera_pictures(const RandomBoard& board, std::uint64_t frame) {
  SplitMix64 random(board.seed * 1'000'003 + frame);
  PicturePair pair;
  const int pixels = board.width * board.height;
  for (int pixel = 0; pixel < pixels; ++pixel)
    pair.left.push_back(static_cast<std::uint8_t>(random.next() >> 56U));
  // The right picture is the left one, two columns on, with some noise: it has matches.
  for (int pixel = 0; pixel < pixels; ++pixel) {
    const auto from = static_cast<std::size_t>(std::min(pixel + 2, pixels - 1));
    pair.right.push_back(random.chance(10) ? static_cast<std::uint8_t>(random.next() >> 56U)
                                           : pair.left[from]);
  }
  return pair;
}

PlainComputerInput plain_input(const RandomComputer& computer) {
  PlainComputerInput input;
  input.board = {cycle_input(computer.board), plain_number(computer.fpga_clock_mhz), computer.board.filter,
                 computer.board.lr_tolerance};
  input.frame_rate_hz = plain_number(computer.frame_rate_hz);
  input.on_demand = computer.on_demand;
  input.capture_to_host = computer.capture_to_host;
  input.host_frames = computer.host_frames;
  input.fifo_words = computer.fifo_words;
  input.fifo_trigger_words = computer.fifo_trigger_words;
  input.pci_clock_mhz = plain_number(computer.pci_clock_mhz);
  input.latency_timer_clocks = computer.latency_timer_clocks;
  input.bridge_wait_clocks = computer.bridge_wait_clocks;
  input.memory_wait_clocks = computer.memory_wait_clocks;
  if (computer.load) {
    input.load = PlainLoad{computer.load->burst_words, ps_of_us(computer.load->first_us),
                           ps_of_us(computer.load->interval_us), ps_of_us(computer.load->access_us)};
  }
  input.local_clock_mhz = plain_number(computer.local_clock_mhz);
  input.dma_burst_words = computer.dma_burst_words;
  input.posted_words = computer.posted_words;
  input.frames = computer.frames;
  input.pictures = [board = computer.board](std::uint64_t frame) { return camera_pictures(board, frame); };
  return input;
}

}  // namespace stereotlm::test
