#pragma once

#include <tlm_utils/simple_initiator_socket.h>

#include <cstdint>
#include <optional>
#include <systemc>
#include <tlm>
#include <vector>

#include "models/clock.h"
#include "models/memory/memory_config.h"
#include "models/memory/word_access.h"
#include "models/stream.h"
#include "models/words_by_range.h"

namespace stereotlm::fpga {

struct LocalBusConfig {
  double clock_mhz = 40;                   // of the local bus, 1..1000
  std::vector<AddressRange> buffers = {};  // on the local bus; words written are counted for each
};

// Byte addresses on the local bus: the banks as on the crossbar, then the registers of register_map.h.
inline constexpr std::uint64_t kLocalRegisters = std::uint64_t{1} << 34U;

// The route of a burst to a bank: its bank, direction and words. Without `bank`: the burst has ended.
struct HostRoute {
  std::optional<std::size_t> bank;
  bool write = false;
  std::uint64_t first = 0;  // byte address on the crossbar
  std::uint64_t end = 0;    // byte address after the burst
};

// The FPGA's end of the bridge's local bus (contract section 3; the state machine of Alpha Data's examples).
// A burst is one transaction of consecutive words in one bank, or of registers, by nb_transport. One burst
// is under way at a time.
//
// - BEGIN_REQ stands for the address clock: the first clock that begins at or after the annotated time. A
//   decode clock follows, then one clock a word.
// - A word whose clock ends at t requests its bank from the first cycle of the FPGA that begins at or after
//   t. The next word's clock is the first that begins at or after the cycle of the grant.
// - Words read are on the bus once they are usable.
// - BEGIN_RESP stands for the end of the idle clock after the last word, when the bus is free. The next
//   BEGIN_REQ comes after END_RESP (or TLM_COMPLETED).
//
// | refused at BEGIN_REQ                                                              | response           |
// |-----------------------------------------------------------------------------------|--------------------|
// | an address that is no multiple of 4, or of no bank or register                    | address error      |
// | a length that is no multiple of 4, a streaming width below it, a burst beyond the | burst error        |
// | 2^28 bytes of its bank's addresses                                                |                    |
// | byte enables                                                                      | byte enable error  |
// | neither read nor write                                                            | command error      |
//
// If a bank or register refuses a word, the burst has the response of the first such word; the other words
// are transferred. Debug transport reaches banks and registers without a burst, and DMI reaches banks.
// b_transport is refused.
//
// The words of the banks need no process here: the core's process grants them. Registers are accessed at the
// end of the word's clock.
class LocalBus : public sc_core::sc_module, private tlm::tlm_fw_transport_if<> {
 public:
  struct Stats {
    std::uint64_t bursts = 0;
    std::uint64_t words_read = 0;     // from the banks
    std::uint64_t words_written = 0;  // to the banks
    std::uint64_t register_accesses = 0;
    std::uint64_t errors = 0;       // refused words and bursts
    std::uint64_t clocks = 0;       // whole clocks since time 0
    std::uint64_t busy_clocks = 0;  // clocks of bursts, but not their idle clocks
  };

  tlm::tlm_target_socket<32> bus{"bus"};
  tlm_utils::simple_initiator_socket<LocalBus> memory{"memory"};
  tlm_utils::simple_initiator_socket<LocalBus> registers{"registers"};
  // Pushes a route before the first word of a burst to a bank, and after its last word.
  StreamOut<HostRoute> route_out{"route_out"};

  // Throws std::invalid_argument if the clock or the number of banks is out of range.
  LocalBus(const sc_core::sc_module_name& name, const LocalBusConfig& config, std::size_t banks);

  // Whether a word waits for a bank, and the time from which it requests.
  bool word_waits() const { return words_left_ != 0; }
  std::uint64_t request_ps() const { return request_ps_; }
  // Whether a word requests in the cycle that begins at `edge_ps`.
  bool requests(std::uint64_t edge_ps) const { return words_left_ != 0 && request_ps_ <= edge_ps; }
  // Transfers the waiting word. It is granted in the cycle that is `at` from now and begins at `grant_ps`. A
  // word that is read is usable at `usable_ps`.
  void access(const sc_core::sc_time& at, std::uint64_t grant_ps, std::uint64_t usable_ps);
  std::size_t words_left() const { return words_left_; }
  // An alternative to access(): moves the data of all words_left() to or from `words`, without granting them.
  // count_granted() grants them.
  void move_words(unsigned char* words);
  // Grants the next `words` words that were moved, the last of them in the cycle that begins at `grant_ps`.
  // If it is read, it is usable at `usable_ps`.
  void count_granted(std::size_t words, std::uint64_t grant_ps, std::uint64_t usable_ps);
  // Whether the clocks of the bus begin with those of `clock`.
  bool is_in_step_with(const Clock& clock) const { return clock_.has_edges_of(clock); }
  // Notified when the first word of a burst begins to request.
  const sc_core::sc_event& request_event() const { return request_event_; }
  // Counts up to the current time.
  Stats stats() const;
  // Words written to the banks: those granted, and those of the burst that are not granted yet.
  const WordsByRange& words_granted() const { return words_granted_; }
  WordsByRange words_to_grant() const;

 private:
  static constexpr std::uint64_t kUnknown = UINT64_MAX;

  void b_transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) override;
  tlm::tlm_sync_enum nb_transport_fw(tlm::tlm_generic_payload& access, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) override;
  unsigned transport_dbg(tlm::tlm_generic_payload& access) override;
  bool get_direct_mem_ptr(tlm::tlm_generic_payload& access, tlm::tlm_dmi& dmi) override;
  void invalidate_dmi(sc_dt::uint64 start, sc_dt::uint64 end);

  tlm::tlm_response_status check(const tlm::tlm_generic_payload& access) const;
  void begin(tlm::tlm_generic_payload& access, const sc_core::sc_time& delay);
  void run_registers();
  void access_register();
  bool transfer(memory::WordAccess& through, std::uint64_t address, sc_core::sc_time& delay);
  void advance(std::size_t words, std::uint64_t grant_ps, std::uint64_t usable_ps);
  void end(std::uint64_t last_clock_end_ps);

  Clock clock_;
  std::size_t banks_;
  memory::WordAccess memory_access_{memory};
  memory::WordAccess register_access_{registers};
  tlm::tlm_generic_payload* burst_ = nullptr;  // the burst under way, until END_RESP
  bool responding_ = false;                    // between BEGIN_RESP and END_RESP
  std::size_t next_word_ = 0;
  std::size_t words_left_ = 0;       // words of a burst to a bank that are not granted
  std::uint64_t address_clock_ = 0;  // number of the last burst's address clock
  std::uint64_t idle_clock_ = 0;     // number of its idle clock; kUnknown until its last grant
  std::uint64_t request_ps_ = 0;     // end of the waiting word's clock
  tlm::tlm_response_status status_ = tlm::TLM_OK_RESPONSE;
  sc_core::sc_event request_event_{"request"};
  sc_core::sc_event register_event_{"register"};
  std::vector<AddressRange> buffers_;
  WordsByRange words_granted_;
  Stats stats_;  // busy_clocks: of all bursts but the last; clocks: not kept
};

}  // namespace stereotlm::fpga
