#pragma once

#include <cstddef>
#include <cstdint>
#include <systemc>
#include <vector>

#include "models/clock.h"

// What passes between the PCI bus and its masters: REQ#, GNT# and the burst that follows (PCI 2.2). Targets
// are reached by the base protocol.
namespace stereotlm::pci {

// What a master does with the bus that it has been granted.
struct PciBurst {
  bool write = true;
  std::uint64_t address = 0;  // of the first byte; a multiple of 4
  std::vector<std::uint32_t>* words =
      nullptr;  // to write; or of the length to read, and where the words go. The
                // master's own, untouched by it until the end of the burst
};

enum class BurstEnd : std::uint8_t {
  kComplete,      // all words transferred
  kLatencyTimer,  // cut: the timer has expired and another master waits
  kDisconnect,    // the target takes no more now; with no word transferred, a retry
  kMasterAbort,   // no target at this address: nothing transferred
  kTargetError,   // the target answered with an error: nothing transferred
};

// How a burst went. Word i was transferred in clock first_data_clock + i of the bus, and had left at its end.
struct BurstResult {
  BurstEnd end = BurstEnd::kComplete;
  std::size_t words = 0;  // transferred
  std::uint64_t first_data_clock = 0;
};

// A master, as the bus sees it.
class PciMasterIf {
 public:
  virtual ~PciMasterIf() = default;
  // GNT#: the address clock begins now, at `address_clock_ps`. Without words the bus is given back unused.
  virtual PciBurst begin_burst(std::uint64_t address_clock_ps) = 0;
  // At the end of the last data clock. The master may request again at once.
  virtual void end_burst(const BurstResult& result) = 0;
};

// A place on the bus, as its master sees it.
class PciSlotIf : public virtual sc_core::sc_interface {
 public:
  // REQ#, until the bus is granted: from the first clock that begins now or later, or at or after a time that
  // is to come. Asking again meanwhile changes nothing.
  void request(PciMasterIf& master) { request(master, Clock::to_ps(sc_core::sc_time_stamp())); }
  virtual void request(PciMasterIf& master, std::uint64_t from_ps) = 0;
  // The words of the master's running burst that have been transferred by now, and the clock of the first.
  // `end` says nothing yet.
  virtual BurstResult transferred() const = 0;
  virtual const Clock& clock() const = 0;
};

// The sockets of a place: `capture.pci.bind(bus.slots[0])`.
using PciMasterPort = sc_core::sc_port<PciSlotIf>;
using PciSlotExport = sc_core::sc_export<PciSlotIf>;

// What a target tells the bus beside the base protocol: STOP#. One without it takes bursts of any length.
class PciStopIf : public virtual sc_core::sc_interface {
 public:
  // At the address clock of a write of `words` words: how many of them the target can take, 0..words.
  virtual std::size_t writable_words(std::uint64_t address, std::size_t words) const = 0;
};

}  // namespace stereotlm::pci
