#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "tests/support/plain_computer.h"
#include "tests/support/random_board.h"

// Random computers around the boards of random_board.h, for tests that compare the models with the plain
// computer. Every one is legal in contract section 4, and one seed gives the same everywhere.
namespace stereotlm::test {

// Fields are named after the keys of a board file. Clocks, rates and times are decimal numbers, as a file has
// them.
struct RandomComputer {
  struct Load {
    int burst_words = 0;
    std::string interval_us;
    std::string first_us;
    std::string access_us;
  };

  RandomBoard board;  // its frames and pictures are not used
  std::string frame_rate_hz;
  bool on_demand = false;
  bool capture_to_host = false;
  int host_frames = 0;
  int fifo_words = 0;
  int fifo_trigger_words = 0;
  std::string pci_clock_mhz;
  int latency_timer_clocks = 0;
  int bridge_wait_clocks = 0;
  int memory_wait_clocks = 0;
  std::optional<Load> load;
  std::string local_clock_mhz;
  int dma_burst_words = 0;
  int posted_words = 0;
  std::string fpga_clock_mhz;
  int frames = 0;  // to deliver, 1..8
};

RandomComputer make_random_computer(std::uint64_t seed);

// What its cameras see in a frame: noise, another one in each.
PicturePair camera_pictures(const RandomBoard& board, std::uint64_t frame);

// The computer as the reference takes it.
PlainComputerInput plain_input(const RandomComputer& computer);

}  // namespace stereotlm::test
