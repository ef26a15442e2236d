#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <vector>

#include "models/host/ideal_host.h"

namespace stereotlm::bench {

// A board with its ideal host in a child process, because SystemC elaborates once per process. It works on one
// frame at a time, when it is told to, and sleeps in between. Every failure of the child, an identity of
// contract section 6 that does not hold included, is a std::runtime_error here.
class BoardProcess {
 public:
  struct Count {
    double start_seconds = 0;  // board file, modules, elaboration, tables into their banks
    std::uint64_t frames = 0;  // and the rest: of all frames so far
    std::uint64_t cycles = 0;  // sum of frame_cycles
    std::uint64_t accesses = 0;
    std::uint64_t stalls = 0;  // stall cycles of all ports
  };

  // `pair` is for every frame. Returns when the tables are in their banks. To be made in sc_main.
  BoardProcess(const std::string& board, const std::vector<std::string>& sets, const host::StereoPair& pair);
  ~BoardProcess();
  BoardProcess(const BoardProcess&) = delete;
  BoardProcess& operator=(const BoardProcess&) = delete;

  const Count& count() const { return count_; }
  // Simulates one frame from its start strobe to its last cycle.
  void run_frame();

 private:
  void read_count();

  pid_t child_ = -1;
  int orders_ = -1;  // to the child: one byte, one frame
  int counts_ = -1;  // from the child
  Count count_;
};

}  // namespace stereotlm::bench
