#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "tests/support/plain_board.h"
#include "tests/support/plain_capture_board.h"
#include "tests/support/plain_clock.h"
#include "tests/support/plain_core.h"
#include "tests/support/plain_load.h"
#include "tests/support/plain_pci_bus.h"
#include "tests/support/plain_trace.h"
#include "tests/support/random_board.h"

// The whole computer of contract section 3 as a plain loop over events: one pixel, one word and one cycle at
// a time, with the program of sw/driver/README.md. It shares no code with the models, which tests compare
// with it.
namespace stereotlm::test {

struct PlainComputerInput {
  PlainBoardInput board;
  PlainNumber frame_rate_hz;
  bool on_demand = false;
  bool capture_to_host = false;
  int host_frames = 3;
  int fifo_words = 140;
  int fifo_trigger_words = 32;
  PlainNumber pci_clock_mhz;
  int latency_timer_clocks = 64;
  int bridge_wait_clocks = 4;
  int memory_wait_clocks = 8;
  int pci_width_bits = 32;
  std::optional<PlainLoad> load;
  PlainNumber local_clock_mhz;
  int dma_burst_words = 32;
  int posted_words = 64;
  int frames = 1;
  std::function<PicturePair(std::uint64_t camera_frame)> pictures;
};

struct PlainDelivery {
  std::uint64_t camera_frame = 0;
  PlainTime begin_ps = 0;  // of the camera frame
  PlainTime host_ps = 0;   // when the program has handled the end of the read-back
  std::vector<std::uint8_t> disparity;
};

struct PlainComputerResult {
  struct Camera {
    std::uint64_t frames = 0;
    PlainCaptureBoard::Stats capture;
  };
  PlainCycleResult core;
  std::vector<PlainDelivery> deliveries;
  std::uint64_t pci_clocks = 0;
  std::uint64_t pci_busy_clocks = 0;
  std::vector<PlainPciBus::MasterStats> masters;  // host, left_capture, right_capture, bridge, and the load
  std::uint64_t posted_words = 0;
  std::uint64_t dma_words = 0;
  std::uint64_t local_clocks = 0;
  std::uint64_t local_busy_clocks = 0;
  std::array<Camera, 2> cameras;  // left, right
  // Of each bus by their ends, of each queue by time.
  std::vector<PlainBusBurst> pci_bursts;
  std::vector<PlainBusBurst> local_bursts;
  std::vector<PlainLevel> posted_levels;
  std::array<std::vector<PlainLevel>, 2> fifo_levels;  // left, right
};

// From time 0 to the delivery of `frames` frames. Throws std::runtime_error if the frames never come.
PlainComputerResult run_plain_computer(const PlainComputerInput& input);

}  // namespace stereotlm::test
