#pragma once

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <optional>
#include <systemc>
#include <tlm>

#include "models/access_rules.h"
#include "models/clock.h"
#include "models/kernel_time.h"
#include "models/refusals.h"

namespace stereotlm::memory {

// The bytes of a memory. They are zeros at first; untouched pages take no memory of the simulating machine.
class Ram {
 public:
  // Throws std::bad_alloc.
  explicit Ram(std::uint64_t bytes)
      : bytes_(bytes), data_(static_cast<unsigned char*>(std::calloc(bytes, 1))) {
    if (data_ == nullptr) throw std::bad_alloc();
  }

  std::uint64_t bytes() const { return bytes_; }             // size
  unsigned char* data() { return data_.get(); }              // the first byte
  const unsigned char* data() const { return data_.get(); }  // the first byte
  // Whether all these bytes are inside the memory.
  bool holds(std::uint64_t address, std::uint64_t length) const {
    return address <= bytes_ && length <= bytes_ - address;
  }

 private:
  struct Free {
    void operator()(void* memory) const { std::free(memory); }
  };

  std::uint64_t bytes_;
  std::unique_ptr<unsigned char[], Free> data_;
};

// The base-protocol target that SsramBank and HostMemory bind to their sockets. b_transport never waits; it
// adds the time of the access to `delay` (Timing). nb_transport_fw has the same effect and returns
// TLM_COMPLETED. An access that breaks the rules has the response of check_access(), and no effect; the first
// one is reported (refusals.h). Debug transport takes any length. DMI grants the whole memory, for reads and
// writes, and is never revoked.
class RamTarget : public tlm::tlm_fw_transport_if<> {
 public:
  // Debug transport and DMI are not counted.
  struct Stats {
    std::uint64_t reads = 0;   // words
    std::uint64_t writes = 0;  // words
    std::uint64_t errors = 0;  // refused accesses
  };

  // The cycles of an access. It takes the time from the first edge of the clock at or after its beginning to
  // the edge that is so many cycles later: an access that begins with an edge ends with one.
  struct Timing {
    Clock clock;                // of the memory
    std::uint64_t read_cycles;  // of the first word of a read; each further word takes one cycle more
  };

  // `rules.end` is the number of bytes. `report`: the type of the SC_REPORT_ERROR for a phase other than
  // BEGIN_REQ. `owner`: the module, which outlives this object. Without `timing` accesses take no time.
  RamTarget(const AccessRules& rules, const char* report, const sc_core::sc_object& owner,
            const std::optional<Timing>& timing = std::nullopt)
      : rules_(rules), report_(report), refusals_(owner), timing_(timing), ram_(rules.end) {
    if (timing) read_time_ = kernel_time::to_time(timing->clock.edge_ps(timing->read_cycles));
  }

  void b_transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) override;
  tlm::tlm_sync_enum nb_transport_fw(tlm::tlm_generic_payload& access, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) override;
  unsigned transport_dbg(tlm::tlm_generic_payload& access) override;
  bool get_direct_mem_ptr(tlm::tlm_generic_payload& access, tlm::tlm_dmi& dmi) override;

  const Stats& stats() const { return stats_; }  // counts up to the present time
  const Ram& ram() const { return ram_; }        // the stored bytes
  Ram& ram() { return ram_; }                    // the stored bytes

 private:
  void move(tlm::tlm_generic_payload& access);

  AccessRules rules_;
  const char* report_;
  Refusals refusals_;
  std::optional<Timing> timing_;
  sc_core::sc_time read_time_;  // of a word that is read at time 0
  Ram ram_;
  Stats stats_;
};

}  // namespace stereotlm::memory
