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
  std::vector<AddressRange> buffers = {};  // on the local bus: words written are counted for each
};

// Byte addresses on the local bus: the banks as on the crossbar, then the registers of register_map.h.
inline constexpr std::uint64_t kLocalRegisters = std::uint64_t{1} << 34U;

// Where the words of a burst go; nowhere behind its last word.
struct HostRoute {
  std::optional<std::size_t> bank;
  bool write = false;
  std::uint64_t first = 0;  // byte address on the crossbar
  std::uint64_t end = 0;    // the first behind the burst
};

// The FPGA's end of the bridge's local bus, and the `host` port of the banks (contract section 3; the state
// machine of Alpha Data's examples). A burst is one transaction of consecutive words in one bank, or of
// registers, by nb_transport: BEGIN_REQ stands for the address clock, the first that begins at or after its
// time; then come a decode clock and one clock a word. A word whose clock ends at t asks for its bank from
// the first cycle of the FPGA that begins at or after t, and the next word's clock is the first that begins
// at or after the cycle in which it was granted. Words read are on the bus once they are usable. BEGIN_RESP
// is at the end of the idle clock behind the last word: the bus is free. One burst at a time; the next
// BEGIN_REQ comes after END_RESP (or TLM_COMPLETED).
//
// Refused at once: an address that is not a multiple of 4 or of no bank or register
// TLM_ADDRESS_ERROR_RESPONSE; a length that is no multiple of 4, a streaming width below it, or a burst
// beyond the 2^28 bytes of its bank's addresses TLM_BURST_ERROR_RESPONSE; byte enables
// TLM_BYTE_ENABLE_ERROR_RESPONSE; neither read nor write TLM_COMMAND_ERROR_RESPONSE. What a bank or register
// refuses is the burst's response; its other words are transferred. Debug transport and DMI reach banks and
// registers at once; there is no b_transport.
//
// It has no process for the banks: the core's process asks it in every cycle. Register accesses happen at the
// end of their clock.
class LocalBus : public sc_core::sc_module, private tlm::tlm_fw_transport_if<> {
 public:
  struct Stats {
    std::uint64_t bursts = 0;
    std::uint64_t words_read = 0;     // from the banks
    std::uint64_t words_written = 0;  // to the banks
    std::uint64_t register_accesses = 0;
    std::uint64_t errors = 0;       // refused words and bursts
    std::uint64_t clocks = 0;       // whole clocks since time 0
    std::uint64_t busy_clocks = 0;  // of these: all of a burst but its idle clock
  };

  tlm::tlm_target_socket<32> bus{"bus"};
  tlm_utils::simple_initiator_socket<LocalBus> memory{"memory"};
  tlm_utils::simple_initiator_socket<LocalBus> registers{"registers"};
  StreamOut<HostRoute> route_out{
      "route_out"};  // before the first word of a burst to a bank, and behind its last

  // Throws std::invalid_argument if the clock or the number of banks is out of range.
  LocalBus(const sc_core::sc_module_name& name, const LocalBusConfig& config, std::size_t banks);

  // Whether a word waits for a bank, and from which time it asks.
  bool word_waits() const { return words_left_ != 0; }
  std::uint64_t request_ps() const { return request_ps_; }
  // Whether it asks in the cycle that begins at `edge_ps`.
  bool requests(std::uint64_t edge_ps) const { return words_left_ != 0 && request_ps_ <= edge_ps; }
  // The word is granted, in the cycle at `at` from now, which begins at `grant_ps`; read, it is usable at
  // `usable_ps`.
  void access(const sc_core::sc_time& at, std::uint64_t grant_ps, std::uint64_t usable_ps);
  std::size_t words_left() const { return words_left_; }
  // Instead of access(): the data of all words that wait goes to or comes from there at once ..
  void move_words(unsigned char* words);
  // .. and they are granted, `words` more of them, the last one in the cycle that begins at `grant_ps`; read,
  // it is usable at `usable_ps`.
  void count_granted(std::size_t words, std::uint64_t grant_ps, std::uint64_t usable_ps);
  // Whether its clocks begin when those of this clock do.
  bool is_in_step_with(const Clock& clock) const { return clock_.has_edges_of(clock); }
  // Notified when the first word of a burst begins to ask.
  const sc_core::sc_event& request_event() const { return request_event_; }
  // Up to now.
  Stats stats() const;
  // Words written to the banks that have been granted, and those of the running burst that have not yet.
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
  tlm::tlm_generic_payload* burst_ = nullptr;  // until END_RESP
  bool responding_ = false;                    // BEGIN_RESP sent, END_RESP to come
  std::size_t next_word_ = 0;
  std::size_t words_left_ = 0;       // of a burst to a bank
  std::uint64_t address_clock_ = 0;  // number of the last burst's
  std::uint64_t idle_clock_ = 0;     // that ends it, once its last word is granted
  std::uint64_t request_ps_ = 0;     // end of the waiting word's clock
  tlm::tlm_response_status status_ = tlm::TLM_OK_RESPONSE;
  sc_core::sc_event request_event_{"request"};
  sc_core::sc_event register_event_{"register"};
  std::vector<AddressRange> buffers_;
  WordsByRange words_granted_;
  Stats stats_;  // clocks and busy_clocks: of all bursts but the last
};

}  // namespace stereotlm::fpga
