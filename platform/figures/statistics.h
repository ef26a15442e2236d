#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/area/area.h"

namespace stereotlm::platform {

// Of a bank (contract section 9): in the counted cycles; of a computer from power-up to the last delivery.
struct BankEnergyStatistics {
  std::uint64_t accesses = 0;
  std::optional<std::uint64_t> rows_opened = std::nullopt;  // of sdram only
  std::optional<std::uint64_t> refreshes = std::nullopt;    // of sdram only
  std::uint64_t energy_pj = 0;
  double energy_percent = 0;  // of all banks
};

// The accesses to a buffer, or to all of a list, in the same time.
struct BufferStatistics {
  std::string name;  // "left_image"
  std::uint64_t bytes = 0;
  double megabytes_per_frame = 0;  // 10^6 bytes
};

// What every text and document says of the energy.
inline constexpr const char* kEnergyIsOf = "the memories alone: no FPGA, PCI, pins, controllers";
struct EnergyStatistics {
  std::uint64_t time_ps = 0;  // that all this covers
  std::uint64_t memory_pj = 0;
  double memory_mj_per_frame = 0;
  double memory_mw = 0;
  double megabytes_per_frame = 0;         // of all buffers
  std::vector<BufferStatistics> buffers;  // in the order of Buffer; none of a table that is not there
};

// Statistics, at the end of this header, has the figures of one run, as `stats.json` lists them (contract
// section 6). Counters of banks and ports are sums over the frames, and cover only the counted cycles of
// contract section 2.
// BankStatistics has the counters of a bank.
struct BankStatistics {
  std::string name;                     // in the board file
  std::uint64_t reads = 0;              // granted reads
  std::uint64_t writes = 0;             // granted writes
  std::uint64_t busy_cycles = 0;        // with one or more accesses granted
  std::uint64_t turnaround_cycles = 0;  // without a grant because of turnaround
  std::uint64_t idle_cycles = 0;        // all other cycles
  std::uint64_t contended_cycles = 0;   // with two or more requests for one port of the bank
  double utilization = 0;               // busy_cycles / cycles, 0..1
  double megabytes_per_second = 0;      // 10^6 bytes per second: 4 * (reads + writes) * clock_mhz / cycles
  int ports = 1;                        // accesses that the bank can serve in a cycle
  std::optional<std::uint64_t> row_cycles = std::nullopt;      // of sdram only: rows were being opened
  std::optional<std::uint64_t> refresh_cycles = std::nullopt;  // of sdram only
  std::optional<BankEnergyStatistics> energy = std::nullopt;   // of a bank that holds a buffer
};

// The counters of a port. Each counted cycle is of one kind.
struct PortStatistics {
  std::string name;                  // "left_lut", "left_lut.0"
  std::uint64_t grants = 0;          // cycles with an access granted
  std::uint64_t stall_cycles = 0;    // cycles with a request that was not granted
  std::uint64_t passed_cycles = 0;   // cycles with a slot taken or handled without an access
  std::uint64_t idle_cycles = 0;     // cycles with nothing to do (contract section 2)
  std::uint64_t blocked_cycles = 0;  // cycles in which its lane could take no slot
  std::uint64_t starved_cycles = 0;  // all other cycles
};

// The stall cycles of a port at a bank with one cause.
struct BlameRow {
  std::string port;          // port that waits
  std::string bank;          // requested by the port
  std::string by;            // the port that was granted, or "turnaround", "row" or "refresh"
  std::uint64_t cycles = 0;  // more than 0
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

// What contract 7.12 proves of the rate in the long run, while captures lose no pixels, in frames per second.
struct ProvenRate {
  std::optional<double> exact;                 // nullopt where `least` and `most` differ
  std::optional<std::uint64_t> deliveries;     // of `exact`: so many
  std::optional<std::uint64_t> camera_frames;  // in so many
  double least = 0;
  double most = 0;
};

// The frame rates of a run.
struct FramesPerSecond {
  double core = 0;  // frames / the time that the core runs
  // The other rates belong to a whole computer; nullopt for a board without a computer.
  std::optional<double> system;      // deliveries / time of the last delivery
  std::optional<SteadyRate> steady;  // nullopt where fewer than 2 * L frames are delivered
  std::optional<ProvenRate> proven;  // nullopt where fewer than L frames are delivered, or pixels are lost
};

// Upper bounds for the rates of FramesPerSecond, and the resource that sets each of them. Those of a run are
// of the frames that the rates are of (contract section 6).
struct Bound {
  double core = 0;                // frames per second
  std::string core_limited_by;    // such as "port left_lut", "bank bank0"
  std::optional<double> system;   // frames per second, of whole pictures and whole turns of the lists
  std::string system_limited_by;  // such as "camera", "pci"; empty without a computer
};

// The counters of a PCI master.
struct PciMasterStatistics {
  std::string name;                // of kPciMasterNames
  std::uint64_t transactions = 0;  // bursts
  std::uint64_t words = 0;         // transferred words
  std::uint64_t wait_clocks = 0;   // clocks from each request to its address clock, summed
};

// The counters of a camera and its capture board.
struct CameraStatistics {
  std::string name;                      // "left" or "right"
  std::uint64_t frames = 0;              // frames that have begun
  std::uint64_t captured_frames = 0;     // frames taken by a capture
  std::uint64_t dropped_frames = 0;      // the sum of the three reasons below
  std::uint64_t dropped_pixels = 0;      // pixels lost because the capture board's FIFO was full
  std::uint64_t dropped_not_armed = 0;   // reason: the capture board was not armed
  std::uint64_t dropped_busy = 0;        // reason: the previous capture was running
  std::uint64_t dropped_by_partner = 0;  // reason: the other side could not start
};

// Of several values; each percentile is one of them.
struct Percentiles {
  double min = 0;  // the least value
  double p50 = 0;  // half of the values are not greater
  double p95 = 0;  // 95 % of the values are not greater
  double p99 = 0;  // 99 % of the values are not greater
  double max = 0;  // the greatest value
};

// The computer around the board, from time 0 to the last delivery.
struct ComputerStatistics {
  std::uint64_t pci_clocks = 0;                  // whole clocks since time 0
  std::uint64_t pci_busy_clocks = 0;             // address, wait and data clocks among them
  std::vector<PciMasterStatistics> pci_masters;  // in the order of PciMaster
  std::uint64_t posted_words = 0;                // words that masters wrote into the bridge
  std::uint64_t dma_words = 0;                   // words that the bridge's DMA moved
  std::uint64_t local_clocks = 0;                // whole clocks since time 0
  std::uint64_t local_busy_clocks = 0;           // local clocks other than idle ones
  std::vector<CameraStatistics> cameras;         // the left one, then the right one
  Percentiles capture_to_host_ms;                // time from the first pixel of a capture to its delivery
};

// The figures of one run.
struct Statistics {
  std::string board;                           // name of the board
  std::string fidelity;                        // "cycle" or "fast"
  std::uint64_t frames = 0;                    // finished frames
  std::uint64_t cycles = 0;                    // counted cycles, summed over the frames
  std::vector<std::uint64_t> frame_cycles;     // length of each frame, including the pipeline latency
  FramesPerSecond frames_per_second;           // rates of the core and of the computer
  Bound bound;                                 // of the rates
  std::vector<BankStatistics> banks;           // in the order of the board file
  std::vector<PortStatistics> ports;           // in the order of memory::Port
  std::vector<BlameRow> blame;                 // sorted by port, bank, by (ports first), without zero rows
  EnergyStatistics energy;                     // of the memories
  std::optional<ComputerStatistics> computer;  // nullopt: a board without a computer
  area::Area area;                             // area of the core
  std::vector<std::string> failed;  // identities that do not hold, each with both sides; empty in a valid run
};

// The pixels that captures lose in a run; 0 without a computer.
inline std::uint64_t lost_pixels(const Statistics& run) {
  std::uint64_t pixels = 0;
  if (run.computer) {
    for (const CameraStatistics& camera : run.computer->cameras) pixels += camera.dropped_pixels;
  }
  return pixels;
}

}  // namespace stereotlm::platform
