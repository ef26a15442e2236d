#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/area/area.h"

namespace stereotlm::platform {

// Statistics, at the end of this header, has the figures of one run, as `stats.json` lists them (contract
// section 6). Counters of banks and ports are sums over the frames, and cover only the counted cycles of
// contract section 2.
struct BankStatistics {
  std::string name;
  std::uint64_t reads = 0;
  std::uint64_t writes = 0;
  std::uint64_t busy_cycles = 0;
  std::uint64_t turnaround_cycles = 0;
  std::uint64_t idle_cycles = 0;
  std::uint64_t contended_cycles = 0;
  double utilization = 0;           // busy_cycles / cycles, 0..1
  double megabytes_per_second = 0;  // 10^6 bytes per second: 4 * (reads + writes) * clock_mhz / cycles
  int ports = 1;                    // accesses that the bank can serve in a cycle
  std::optional<std::uint64_t> row_cycles = std::nullopt;      // of sdram only: rows were being opened
  std::optional<std::uint64_t> refresh_cycles = std::nullopt;  // of sdram only
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
  std::string by;  // the port that was granted, or "turnaround", "row" or "refresh"
  std::uint64_t cycles = 0;
};

// The rate of a whole computer without its start-up. L is allocation_period_frames(). The first L deliveries
// are warm-up. The window has the last k * L of the other deliveries, for the greatest k.
struct SteadyRate {
  double frames_per_second = 0;  // frames of the window / time from the delivery before it to the last one
  // What the window leaves open: frames_per_second * (greatest - least latency) / time of the window. The
  // latencies are those of the window and of the delivery before it.
  double uncertainty = 0;
  std::uint64_t frames = 0;  // of the window
};

struct FramesPerSecond {
  double core = 0;  // frames / the time that the core runs
  // The other rates belong to a whole computer; nullopt for a board without a computer.
  std::optional<double> system;      // deliveries / time of the last delivery
  std::optional<SteadyRate> steady;  // nullopt where fewer than 2 * L frames are delivered
};

// Upper bounds for the rates `core` and `steady` of FramesPerSecond over whole turns of the allocation's
// lists, and the resource that sets each of them.
struct Bound {
  double core = 0;
  std::string core_limited_by;
  std::optional<double> system;
  std::string system_limited_by;
};

struct PciMasterStatistics {
  std::string name;
  std::uint64_t transactions = 0;
  std::uint64_t words = 0;
  std::uint64_t wait_clocks = 0;  // clocks from each request to its address clock, summed
};

struct CameraStatistics {
  std::string name;
  std::uint64_t frames = 0;              // frames that have begun
  std::uint64_t captured_frames = 0;     // frames taken by a capture
  std::uint64_t dropped_frames = 0;      // the sum of the three reasons below
  std::uint64_t dropped_pixels = 0;      // pixels lost because the capture board's FIFO was full
  std::uint64_t dropped_not_armed = 0;   // reason: the capture board was not armed
  std::uint64_t dropped_busy = 0;        // reason: the previous capture was running
  std::uint64_t dropped_by_partner = 0;  // reason: the other side could not start
};

struct Percentiles {
  double min = 0;
  double p50 = 0;
  double p95 = 0;
  double p99 = 0;
  double max = 0;
};

// The computer around the board, from time 0 to the last delivery.
struct ComputerStatistics {
  std::uint64_t pci_clocks = 0;
  std::uint64_t pci_busy_clocks = 0;  // address, wait and data clocks among them
  std::vector<PciMasterStatistics> pci_masters;
  std::uint64_t posted_words = 0;  // words that masters wrote into the bridge
  std::uint64_t dma_words = 0;     // words that the bridge's DMA moved
  std::uint64_t local_clocks = 0;
  std::uint64_t local_busy_clocks = 0;    // local clocks other than idle ones
  std::vector<CameraStatistics> cameras;  // left, right
  Percentiles capture_to_host_ms;         // time from the first pixel of a capture to its delivery
};

struct Statistics {
  std::string board;
  std::string fidelity;
  std::uint64_t frames = 0;
  std::uint64_t cycles = 0;                 // counted cycles, summed over the frames
  std::vector<std::uint64_t> frame_cycles;  // length of each frame, including the pipeline latency
  FramesPerSecond frames_per_second;
  Bound bound;
  std::vector<BankStatistics> banks;  // in the order of the board file
  std::vector<PortStatistics> ports;  // in the order of memory::Port
  std::vector<BlameRow> blame;        // sorted by port, bank, by (ports first), without zero rows
  std::optional<ComputerStatistics> computer;
  area::Area area;
  std::vector<std::string> failed;  // identities that do not hold, each with both sides; empty in a valid run
};

}  // namespace stereotlm::platform
