#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace stereotlm::platform {

// What a port does at a bank during the cycles of a strip of results: it is granted `count` of them, or waits
// for `count` of them. Plain data.
struct TraceRun {
  std::size_t strip = 0;          // 0: the fill, which comes before the first results
  std::uint64_t first_cycle = 0;  // since power-up; the first cycle of the strip
  std::uint64_t end_cycle = 0;    // the first one behind it
  std::size_t requester = 0;      // fpga::requester_name()
  std::size_t bank = 0;
  std::optional<std::size_t> by;  // who is to blame for the wait, as fpga::requester_name(); none: granted
  std::uint64_t count = 0;        // cycles
};

// The runs of one frame of the core, by strip, then by requester, bank and `by`, grants first.
struct FrameRuns {
  std::uint64_t frame = 0;
  std::uint64_t first_cycle = 0;  // since power-up
  std::uint64_t end_cycle = 0;    // the first one behind the last write
  std::vector<std::uint64_t> strip_ends;  // [strip]: the first cycle behind it
  std::vector<TraceRun> runs;
};

// A burst on the PCI bus or on the local bus. Times are since power-up.
struct BusBurst {
  enum class Bus : std::uint8_t { kPci, kLocal };

  Bus bus = Bus::kPci;
  const char* master = "";  // "left_capture", "bridge"; on the local bus "posted", "dma0", "dma1", "read"
  const char* target = "";  // "bridge", "host_memory", "bank3", "registers"
  bool write = false;
  std::uint64_t address = 0;     // on the bus
  std::uint64_t words = 0;       // transferred
  std::uint64_t request_ps = 0;  // the first clock that could be granted begins
  std::uint64_t address_ps = 0;  // the address clock begins
  std::uint64_t data_ps = 0;     // it ends; waits and data follow
  std::uint64_t end_ps = 0;      // the last data clock ends
};

// A queue holds this number of words from a time on.
struct QueueLevel {
  const char* queue = "";  // "left_capture", "right_capture", "posted"
  std::uint64_t time_ps = 0;
  std::uint64_t words = 0;
};

// Receives the bursts in the order of their ends, and the levels in the order of their times. Plain C++.
class BusObserver {
 public:
  virtual ~BusObserver() = default;
  virtual void burst(const BusBurst& burst) = 0;
  virtual void level(const QueueLevel& level) = 0;
};

}  // namespace stereotlm::platform
