#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "models/fpga/stereo_core.h"
#include "models/host/frame_source.h"
#include "platform/config/tables.h"

namespace stereotlm::bench {

// A run of a board in a child process, because SystemC elaborates once per process. It works when it is told
// to, and sleeps in between. Every failure of the child, an identity of contract section 6 that does not hold
// included, is a std::runtime_error here.
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
    double seconds = 0;        // of the last run_frames()
    std::uint64_t frames = 0;  // and the rest: of all frames so far
    std::uint64_t cycles = 0;  // sum of frame_cycles
    std::uint64_t accesses = 0;
    std::uint64_t stalls = 0;  // stall cycles of all ports
  };

  // `pair` is for every frame. Returns when the board can begin. To be made in sc_main.
  BoardProcess(const Setting& setting, const host::StereoPair& pair);
  ~BoardProcess();
  BoardProcess(const BoardProcess&) = delete;
  BoardProcess& operator=(const BoardProcess&) = delete;

  const Count& count() const { return count_; }
  // Simulates until at least so many more frames are done.
  void run_frames(std::uint32_t frames);

 private:
  void read_count();

  pid_t child_ = -1;
  int orders_ = -1;  // to the child: a number of frames
  int counts_ = -1;  // from the child
  Count count_;
};

}  // namespace stereotlm::bench
