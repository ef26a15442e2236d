#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/fpga/stereo_core.h"
#include "models/host/frame_source.h"
#include "platform/config/tables.h"
#include "sw/process/child.h"

namespace stereotlm::bench {

// Runs a board in a child process, because SystemC elaborates once per process. The child simulates on order
// and sleeps in between. Throws std::runtime_error if the child fails, or if an identity of contract section
// 6 does not hold.
class BoardProcess {
 public:
  struct Setting {
    std::string board;
    std::vector<std::string> sets;
    const platform::Tables* tables = nullptr;  // null: identity
    bool camera = false;                       // the whole computer
    fpga::Fidelity fidelity = fpga::Fidelity::kCycle;
  };
  struct Count {
    double start_seconds = 0;  // board file, modules, elaboration, tables into their banks
    double seconds = 0;        // duration of the last run_frames()
    // Sums over all frames so far.
    std::uint64_t frames = 0;
    std::uint64_t cycles = 0;  // FPGA cycles
    std::uint64_t accesses = 0;
    std::uint64_t stalls = 0;  // stall cycles of all ports
  };

  // Every frame shows `pair`. Returns when the board is ready. Must be constructed in sc_main.
  BoardProcess(const Setting& setting, const host::StereoPair& pair);

  const Count& count() const { return count_; }
  // Simulates until at least `frames` more frames are done.
  void run_frames(std::uint32_t frames);

 private:
  void receive_count();

  process::Pipe orders_;  // to the child: numbers of frames
  process::Child child_;
  Count count_;
};

}  // namespace stereotlm::bench
