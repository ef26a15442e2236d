#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace stereotlm::platform {

// What a port does at a bank in the cycles of a strip of results: it is granted in `count` of these cycles,
// or waits in `count` of them. Plain data.
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
  std::uint64_t first_cycle = 0;          // since power-up
  std::uint64_t end_cycle = 0;            // the first one behind the last write
  std::vector<std::uint64_t> strip_ends;  // [strip]: the first cycle behind it
  std::vector<TraceRun> runs;
};

// A burst on the PCI bus or on the local bus. Times are since power-up, and each is the beginning of a clock
// of the bus.
//
// On the local bus request_ps is the first clock at or after the post of the first word of a posted burst, or
// the start of a read or a burst of DMA. A burst that the local bus refuses is left out.
struct BusBurst {
  enum class Bus : std::uint8_t { kPci, kLocal };

  Bus bus = Bus::kPci;
  // PCI bus: "host", "left_capture", "right_capture", "bridge", "load". Local bus: "posted", "read", "dma0",
  // "dma1".
  const char* master = "";
  // PCI bus: "host_memory", "bridge", "bridge_registers", "left_capture", "right_capture", "load", or "none"
  // for a master abort. Local bus: the name of a bank, or "registers" for those of the core.
  const char* target = "";
  bool write = false;
  std::uint64_t address = 0;     // on the bus
  std::uint64_t words = 0;       // transferred
  std::uint64_t request_ps = 0;  // the first clock that could be granted begins
  std::uint64_t address_ps = 0;  // the address clock begins
  std::uint64_t data_ps = 0;     // the address clock ends; wait or decode clocks, and the data follow
  std::uint64_t end_ps = 0;      // the last data clock ends, and the idle clock begins
};

// A queue holds this number of words from a time on.
//
// - The FIFO of a capture board: its complete words. A word comes with its last pixel. It leaves at the end
//   of its data clock, or of the burst that loses it. No two levels have the same time.
// - The posted words: there is a level when a write is posted, and when the places of a posted burst become
//   free at the end of its idle clock. Of two levels at the same time the later one holds.
struct QueueLevel {
  const char* queue = "";  // "left_capture", "right_capture", "posted"
  std::uint64_t time_ps = 0;
  std::uint64_t words = 0;
};

// Receives the bursts of each bus in the order of their ends, and the levels of each queue in the order of
// their times. The names in a record are valid as long as the BusTrace that gives them. Plain C++.
class BusObserver {
 public:
  virtual ~BusObserver() = default;
  virtual void burst(const BusBurst& burst) = 0;
  virtual void level(const QueueLevel& level) = 0;
};

}  // namespace stereotlm::platform
