#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/clock.h"

// The protocol between the PCI bus and its masters and targets: REQ#, GNT# and the burst that follows (PCI
// 2.2). Plain C++; pci_slot_if.h has the sockets. A target of PciBus uses the TLM base protocol, a target of
// PciBusControl is a PciTarget.
namespace stereotlm::pci {

// The burst for which a master uses its grant.
struct PciBurst {
  bool write = true;          // true: a write; false: a read
  std::uint64_t address = 0;  // address of the first byte, a multiple of 4
  // The words to write, or a buffer of as many words as are to be read. The master owns this vector, and does
  // not touch it until the end of the burst.
  std::vector<std::uint32_t>* words = nullptr;
};

// Why a burst has ended.
enum class BurstEnd : std::uint8_t {
  kComplete,      // all words were transferred
  kLatencyTimer,  // the latency timer has expired and another master waits
  kDisconnect,    // the target accepts no more words now; if it accepted none, a retry
  kMasterAbort,   // no target at this address; no word was transferred
  kTargetError,   // the target responded with an error; no word was transferred
};
constexpr bool is_error(BurstEnd end) {  // master abort or target error
  return end == BurstEnd::kMasterAbort || end == BurstEnd::kTargetError;
}

// The result of a burst. Word i was transferred in bus clock first_data_clock + i / words_per_clock, and left
// its sender at the end of that clock.
struct BurstResult {
  BurstEnd end = BurstEnd::kComplete;  // why the burst has ended
  std::size_t words = 0;               // words transferred
  std::uint64_t first_data_clock = 0;  // number of the bus clock of word 0
  std::uint64_t end_ps = 0;            // time of the call of end_burst()
  std::size_t words_per_clock = 1;     // 2 on a bus of 64 bits

  // The number of words that were transferred in earlier clocks than this one.
  std::size_t words_before(std::uint64_t clock) const {
    if (clock <= first_data_clock) return 0;
    return std::min<std::uint64_t>(words, (clock - first_data_clock) * words_per_clock);
  }
};

// The interface of a master, called by the bus.
class PciMasterIf {
 public:
  virtual ~PciMasterIf() = default;
  // GNT#: the address clock begins now, at `address_clock_ps`. Returns the burst to run; one without words
  // leaves the grant unused.
  virtual PciBurst begin_burst(std::uint64_t address_clock_ps) = 0;
  // The last data clock has ended. The master may request again immediately.
  virtual void end_burst(const BurstResult& result) = 0;
};

// The interface of a slot of the bus, called by the master in the slot.
class PciSlot {
 public:
  virtual ~PciSlot() = default;
  // REQ#, asserted until the bus is granted. The request counts from the first clock that begins at or after
  // `from_ps`, now or later. A second request before the grant changes nothing.
  virtual void request(PciMasterIf& master, std::uint64_t from_ps) = 0;
  // The words of the master's running burst that have been transferred by `now_ps`, and the clock of the
  // first word. `end` and `end_ps` have no meaning yet.
  virtual BurstResult transferred(std::uint64_t now_ps) const = 0;
  virtual const Clock& clock() const = 0;
};

// When a target has responded to an access, and how.
struct PciAnswer {
  std::uint64_t time_ps = 0;  // kNever: not yet
  bool ok = true;             // whether it takes the access without an error
};

// The access of a burst. Its address is relative to the target's window.
struct PciAccess {
  bool write = true;               // true: a write; false: a read
  std::uint64_t address = 0;       // of the first byte
  std::uint32_t* words = nullptr;  // to write, or places for the words read
  std::size_t count = 0;           // words
};

// A target of the bus, called by the bus.
class PciTarget {
 public:
  virtual ~PciTarget() = default;
  // STOP#: called at the address clock of a write. Returns how many of its `words` words the target takes.
  virtual std::size_t writable_words(std::uint64_t /*now_ps*/, std::uint64_t /*address*/, std::size_t words) {
    return words;
  }
  // Called for a write at the end of its last data clock, `at_ps`. Called for a read in the address clock; it
  // reads at the end of that clock, `at_ps`. PciBusControl::answer() gives an answer that is not known yet.
  virtual PciAnswer access(std::uint64_t now_ps, const PciAccess& access, std::uint64_t at_ps) = 0;
};

}  // namespace stereotlm::pci
