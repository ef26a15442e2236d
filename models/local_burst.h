#pragma once

#include <cstddef>
#include <cstdint>

// The protocol between the bridge and the FPGA's end of its local bus, without TLM. One burst is under way at
// a time: it begins after the end of the one before.
namespace stereotlm {

// A burst of consecutive words in one direction.
struct LocalBurst {
  bool write = false;             // to the FPGA; else from it
  std::uint64_t address = 0;      // byte address of the first word
  unsigned char* data = nullptr;  // 32-bit words to write, or their places; the master keeps them to the end
  std::size_t words = 0;          // at least 1
};

// The FPGA's end of the local bus, called by the bridge.
class LocalBusIf {
 public:
  virtual ~LocalBusIf() = default;
  // Begins a burst. Returns false if it is refused: then it has ended.
  virtual bool begin_burst(std::uint64_t now_ps, const LocalBurst& burst) = 0;
};

// The master of the local bus, called by the FPGA's end.
class LocalBusMasterIf {
 public:
  virtual ~LocalBusMasterIf() = default;
  // The burst under way ends at `end_ps`, when the bus is free. Called once for each burst that was not
  // refused, as soon as this time is known: within begin_burst() or later, up to `end_ps`. The data is in its
  // place at `end_ps`. `ok`: no word was refused.
  virtual void end_burst_at(std::uint64_t end_ps, bool ok) = 0;
};

}  // namespace stereotlm
