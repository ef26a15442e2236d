#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace stereotlm::platform {

// The figures of one run, as `stats.json` lists them (contract section 6). Counters are sums over the frames
// and cover the counted cycles of contract section 2 only.
struct BankStatistics {
  std::string name;
  std::uint64_t reads = 0;
  std::uint64_t writes = 0;
  std::uint64_t busy_cycles = 0;
  std::uint64_t turnaround_cycles = 0;
  std::uint64_t idle_cycles = 0;
  std::uint64_t contended_cycles = 0;
  double utilization = 0;           // busy_cycles / cycles, 0..1
  double megabytes_per_second = 0;  // 10^6 bytes; 4 * (reads + writes) * clock_mhz / cycles
};

struct PortStatistics {
  std::string name;
  std::uint64_t grants = 0;
  std::uint64_t stall_cycles = 0;
  std::uint64_t passed_cycles = 0;
  std::uint64_t idle_cycles = 0;
  std::uint64_t blocked_cycles = 0;
  std::uint64_t starved_cycles = 0;
};

struct BlameRow {
  std::string port;  // the victim
  std::string bank;
  std::string by;  // the port that was granted, or "turnaround"
  std::uint64_t cycles = 0;
};

struct FramesPerSecond {
  double core = 0;
};

struct Bound {
  double core = 0;  // frames per second that no run of these frames can exceed
  std::string core_limited_by;
};

struct Statistics {
  std::string board;
  std::string fidelity;
  std::uint64_t frames = 0;
  std::uint64_t cycles = 0;                 // sum over frames of the counted cycles
  std::vector<std::uint64_t> frame_cycles;  // per processed frame
  FramesPerSecond frames_per_second;
  Bound bound;
  std::vector<BankStatistics> banks;  // in the order of the board file
  std::vector<PortStatistics> ports;  // in the order of memory::Port
  std::vector<BlameRow> blame;        // sorted by port, bank, by (turnaround last), without zero rows
  std::vector<std::string> failed;  // identities that do not hold, each with both sides; empty in a sound run
};

}  // namespace stereotlm::platform
