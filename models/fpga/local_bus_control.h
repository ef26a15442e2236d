#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "models/clock.h"
#include "models/local_burst.h"
#include "models/time_ps.h"
#include "models/words_by_range.h"

namespace stereotlm::fpga {

// A burst on the local bus. Each time is that at which a clock of the bus begins.
struct EndedLocalBurst {
  bool write = false;            // true: a write; false: a read
  std::uint64_t address = 0;     // on the local bus
  std::uint64_t words = 0;       // transferred words
  std::uint64_t address_ps = 0;  // time of the address clock
  std::uint64_t data_ps = 0;     // the decode clock
  std::uint64_t end_ps = 0;      // time of the idle clock
  std::uint64_t free_ps = 0;     // the clock after the idle clock
};

// Receives the bursts of the local bus, for traces. Plain C++.
class LocalBusObserver {
 public:
  virtual ~LocalBusObserver() = default;
  // Called once for each burst, in their order, as soon as its end is known. That is at free_ps or earlier. A
  // burst that was refused is none.
  virtual void local_burst_ended(const EndedLocalBurst& burst) = 0;
};

// The configuration of a LocalBus.
struct LocalBusConfig {
  double clock_mhz = 40;                   // of the local bus, 1..1000
  std::vector<AddressRange> buffers = {};  // on the local bus; words written are counted for each
};

// Byte addresses on the local bus: the banks as on the crossbar, then the registers of register_map.h.
inline constexpr std::uint64_t kLocalRegisters = std::uint64_t{1} << 34U;

// The route of a burst to a bank: its bank, direction and words. Without `bank`: the burst has ended.
struct HostRoute {
  std::optional<std::size_t> bank;  // nullopt: the burst has ended
  bool write = false;               // true: a write; false: a read
  std::uint64_t first = 0;          // byte address on the crossbar
  std::uint64_t end = 0;            // byte address after the burst
};

// The timing of the FPGA's end of the local bus (contract section 3, "Bridge"), and its counters. Plain C++.
//
// - A burst begins with its address clock, the first clock that begins at or after its time. A decode clock
//   follows, then one clock a word.
// - A word whose clock ends at t requests its bank from the first cycle of the FPGA that begins at or after
//   t. The next word's clock is the first that begins at or after the cycle of the grant.
// - Words read are on the bus once they are usable.
// - The burst ends with the idle clock after the last word.
//
// step() accesses only registers, each at the end of its word's clock. Words of the banks move without it:
// whoever grants the host port calls access(), or move_words() and count_granted().
class LocalBusControl final : public LocalBusIf {
 public:
  // What the bus has counted since time 0.
  struct Stats {
    std::uint64_t bursts = 0;             // bursts that were not refused
    std::uint64_t words_read = 0;         // from the banks
    std::uint64_t words_written = 0;      // words written to the banks
    std::uint64_t register_accesses = 0;  // words from and to registers
    std::uint64_t errors = 0;             // refused words and bursts
    std::uint64_t clocks = 0;             // whole clocks since time 0
    std::uint64_t busy_clocks = 0;        // clocks of bursts, but not their idle clocks
  };
  // Why a burst is refused.
  enum class Refusal : std::uint8_t {
    kNone,
    kAddress,  // no multiple of 4, or of no bank or register
    kLength,   // beyond the 2^28 bytes of its bank's addresses
  };

  // What the bus leads to.
  class Core {
   public:
    virtual ~Core() = default;
    // Called before the first word of a burst to a bank, and after its last word.
    virtual void route(const HostRoute& route) = 0;
    // Transfers a word, at `at_ps` or now if that is later. Returns false if the access is refused. The byte
    // address is that on the local bus, or that within the registers.
    virtual bool access_bank(std::uint64_t at_ps, bool write, std::uint64_t address, std::uint32_t& word) = 0;
    virtual bool access_register(std::uint64_t now_ps, bool write, std::uint64_t address,
                                 std::uint32_t& word) = 0;
  };

  // `core` outlives this object. Throws std::invalid_argument if the clock or the number of banks is out of
  // range.
  LocalBusControl(const LocalBusConfig& config, std::size_t banks, Core& core);
  // The master of the bus, which outlives this object. To be called before the first burst.
  void bind(LocalBusMasterIf& master) { master_ = &master; }
  // `observer` outlives this object.
  void observe(LocalBusObserver& observer) { observer_ = &observer; }

  bool begin_burst(std::uint64_t now_ps, const LocalBurst& burst) override;
  // Why begin_burst() refuses the burst.
  Refusal refusal_of(const LocalBurst& burst) const;
  // An alternative to begin_burst(), for a burst that is known not to be refused.
  void begin(std::uint64_t now_ps, const LocalBurst& burst);
  // Counts a burst that was refused before it came here.
  void count_error() { ++stats_.errors; }

  // When step() accesses a register.
  std::uint64_t next_ps() const { return next_ps_; }
  void step(std::uint64_t now_ps);

  // Whether a word waits for a bank, and the time from which it requests.
  bool word_waits() const { return words_left_ != 0; }
  std::uint64_t request_ps() const { return request_ps_; }
  // The time from which the next word of the burst requests, if a word is granted in the cycle that begins at
  // `grant_ps`.
  std::uint64_t next_request_ps(std::uint64_t grant_ps) const {
    return clock_.edge_ps(clock_.edge_at_or_after(grant_ps) + 1);
  }
  // Whether a word requests in the cycle that begins at `edge_ps`.
  bool requests(std::uint64_t edge_ps) const { return words_left_ != 0 && request_ps_ <= edge_ps; }
  // Transfers the waiting word, which is granted in the cycle that begins at `grant_ps`. If it is read, it is
  // usable at `usable_ps`.
  void access(std::uint64_t grant_ps, std::uint64_t usable_ps);
  std::size_t words_left() const { return words_left_; }
  // An alternative to access(): moves the data of all words_left() to or from `words`, without granting them.
  // count_granted() grants them.
  void move_words(unsigned char* words);
  // Grants the next `words` words that were moved, the last of them in the cycle that begins at `grant_ps`.
  // If it is read, it is usable at `usable_ps`.
  void count_granted(std::size_t words, std::uint64_t grant_ps, std::uint64_t usable_ps);
  // Whether the clocks of the bus begin with those of `clock`.
  bool is_in_step_with(const Clock& clock) const { return clock_.has_edges_of(clock); }

  // Counts up to `now_ps`.
  Stats stats(std::uint64_t now_ps) const;
  // Words written to the banks: those granted, and those of the burst that are not granted yet.
  const WordsByRange& words_granted() const { return words_granted_; }
  WordsByRange words_to_grant() const;

 private:
  static constexpr std::uint64_t kUnknown = UINT64_MAX;
  static constexpr std::uint64_t kFirstWordClock = 2;  // after the address clock and the decode clock

  unsigned char* next_data() const { return burst_.data + 4 * next_word_; }
  std::uint64_t next_address() const { return burst_.address + 4 * next_word_; }
  void count_words(std::size_t words) {
    (burst_.write ? stats_.words_written : stats_.words_read) += words;
    if (burst_.write) words_granted_.add(next_address(), words);
  }
  void advance(std::size_t words, std::uint64_t grant_ps, std::uint64_t usable_ps);
  void refuse_word();
  void end(std::uint64_t idle_clock);
  // Without an observer it costs nothing beside the branch around it.
  [[gnu::cold, gnu::noinline]] void report() const;

  Clock clock_;
  std::size_t banks_;
  Core& core_;
  LocalBusMasterIf* master_ = nullptr;
  LocalBusObserver* observer_ = nullptr;
  LocalBurst burst_;                 // the last burst
  bool ok_ = true;                   // no word of it was refused
  std::size_t next_word_ = 0;        // of the burst
  std::size_t words_left_ = 0;       // words of a burst to a bank that are not granted
  std::uint64_t address_clock_ = 0;  // number of the last burst's address clock
  std::uint64_t idle_clock_ = 0;     // number of its idle clock; kUnknown until its last grant
  std::uint64_t free_ps_ = kNever;   // end of that clock
  std::uint64_t request_clock_ = 0;  // number of the first clock behind the waiting word's clock
  std::uint64_t request_ps_ = 0;     // its beginning
  std::uint64_t next_ps_ = kNever;
  std::vector<AddressRange> buffers_;
  WordsByRange words_granted_;
  Stats stats_;  // busy_clocks: of all bursts but the last; clocks: not kept
};

}  // namespace stereotlm::fpga
