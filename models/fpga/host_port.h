#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "models/address_range.h"
#include "models/clock.h"
#include "models/fpga/frame_run.h"
#include "models/fpga/local_bus_control.h"
#include "models/memory/arbitration.h"
#include "models/memory/direct_banks.h"

namespace stereotlm::fpga {

// The host port of the banks: serves the bursts of the local bus, beside the frames of the core. It never
// waits; whoever runs the core calls it.
//
// A burst has two roads into its bank. It is contended if it goes to a bank of the running frame: then each
// word is arbitrated in its cycle. An uncontended burst is served independently of the frame, and ahead of
// it. Its words are counted when the frame has come to their cycles. Plain C++.
class HostPort {
 public:
  // All of these outlive this object.
  HostPort(LocalBusControl& bus, memory::DirectBanks& banks, memory::Arbitration& arbitration,
           FrameRun& frames, const Clock& clock)
      : bus_(bus),
        banks_(banks),
        arbitration_(arbitration),
        frames_(frames),
        clock_(clock),
        is_in_step_(bus.is_in_step_with(clock)) {
    frames.set_host([this] { return next_word(); });
  }
  HostPort(const HostPort&) = delete;
  HostPort& operator=(const HostPort&) = delete;

  // Sets whether only the local bus can start frames. If so, no frame starts within a burst. Default: false.
  void set_only_master(bool is_only_master) { is_only_master_ = is_only_master; }

  // To be called when a burst begins or has ended; see LocalBusControl::Core.
  void route(const HostRoute& route);
  const HostRoute& burst() const { return burst_; }
  // The addresses of the words of the burst that are not granted yet.
  AddressRange words_left() const { return {burst_.end - 4 * bus_.words_left(), burst_.end}; }

  // To be called before a cycle in which the waiting word requests, if it takes part in the arbitration:
  // tells the arbiters which word it is.
  void place() {
    if (memory::has(arbitration_.placed(), port_)) arbitration_.place(port_, *burst_.bank, first_word());
  }
  // For a frame that is stepped: lets the burst take part in the arbitration of its bank from now on.
  void join();
  // Ends that.
  void leave();
  // Transfers the waiting word, which has been granted in `cycle`, which begins at `edge_ps`. Returns true if
  // the burst has ended.
  bool access(std::uint64_t cycle, std::uint64_t edge_ps);

  // Whether the burst goes to a bank of the running frame, or another master of the registers may start the
  // next frame as soon as this one ends.
  bool is_contended() const;
  // Runs the frame and serves words of the burst, at least the waiting one unless the frame ends, or the word
  // waits for more than FastForward::kMostHostCycles.
  void serve_contended();
  // Serves the words of an uncontended burst, early if possible: but from `horizon_ps` on, another master of
  // the registers could start a frame on its bank. Returns the time of the next call, in ps. If it is the end
  // of the finishing frame, that frame must be ended first. Returns nullopt if no word waits any more.
  std::optional<std::uint64_t> serve_uncontended(std::uint64_t horizon_ps);
  // To be called for each cycle in which the host requests while no frame runs, if serve_uncontended() is not
  // called.
  void record_cycle(std::uint64_t cycle, bool granted) {
    record_served(cycle, 1, granted, granted ? 0 : arbitration_.cause_of(port_, 0));
  }

  // Serves an uncontended burst that has just begun, if no frame can start within it.
  void serve_new_burst();

  // Counts the words of the running frame up to the next cycle that it runs.
  void count_words() {
    if (frames_.is_running()) count_served(frames_.cycle(), true);
  }
  // While no frame runs: the words that are counted already, and that are granted in `cycle` or later.
  AddressRange counted_ahead_of(std::uint64_t cycle) const;

  // Finishes the frame, after the cycle in which its last write was granted. Words served before the frame's
  // cycle() belong to it, later ones do not.
  void finish_frame() {
    count_words();
    frames_.finish();
    count_words_outside();
  }

 private:
  // Words that were served in an uncontended bank, and are not counted yet.
  struct Served {
    std::uint64_t cycle;
    std::uint64_t cycles;  // number of cycles, from `cycle` on
    bool granted;
    std::uint32_t cause;  // why it was not granted
  };

  std::optional<HostWord> next_word() const;
  // The number of the waiting word in its bank.
  std::uint32_t first_word() const {
    return static_cast<std::uint32_t>(memory::address_in_bank(words_left().first) / 4);
  }
  void record_served(std::uint64_t cycle, std::uint64_t cycles, bool granted, std::size_t cause) {
    if (frames_.cycles() != nullptr)
      frames_.cycles()->host_accesses(*next_word(), cycle, cycles, granted, cause);
  }
  void move_burst();
  void serve_words(std::size_t words, std::uint64_t last_cycle);
  void serve_at_once(std::uint64_t first_cycle);
  Served decide(std::size_t bank, std::uint64_t cycle, bool write);
  HostTraffic traffic() const;
  void count_served(std::uint64_t end_cycle, bool in_frame);
  void count_words_outside() { count_served(UINT64_MAX, false); }
  void count(const Served& served, std::uint64_t cycles, bool in_frame);
  std::uint64_t usable_ps(std::uint64_t cycle) const {
    return clock_.edge_ps(cycle + static_cast<std::uint64_t>(read_latency_cycles_));
  }

  LocalBusControl& bus_;
  memory::DirectBanks& banks_;
  memory::Arbitration& arbitration_;
  FrameRun& frames_;
  const Clock& clock_;
  memory::Port port_ = frames_.control().ports().host();
  memory::PortMask mask_ = memory::mask_of(port_);
  bool is_in_step_;  // the clocks of the local bus begin with those of the core
  bool is_only_master_ = false;
  HostRoute burst_;
  int read_latency_cycles_ = 2;  // of the burst's bank
  bool is_joined_ = false;       // the burst takes part in the arbitration
  bool is_moved_ = false;        // the data of the burst is in place; its words are still to be served
  std::vector<Served> served_;
  std::vector<Served> counted_ahead_;  // of the last burst that was counted outside frames
  std::uint64_t served_end_ = 0;       // byte address behind the burst of served_
  std::size_t served_bank_ = 0;        // of all served_
  bool served_write_ = false;          // of all served_
  HostTraffic served_traffic_ = HostTraffic::kCapture;
};

}  // namespace stereotlm::fpga
