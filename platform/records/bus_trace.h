#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "models/capture/capture_observer.h"
#include "models/clock.h"
#include "models/fpga/frame_run.h"
#include "models/fpga/local_bus_control.h"
#include "models/fpga/record/core_cycle.h"
#include "models/pci/local_bus_master.h"
#include "models/pci/pci_bus_control.h"
#include "models/time_ps.h"
#include "platform/config/board_config.h"
#include "platform/records/trace_records.h"

namespace stereotlm::platform {

// Traces the buses and the queues of a computer in a window, at every fidelity with the same records
// (trace_records.h). The controls of the blocks report what they do. Plain C++.
//
// The window is a range of times, or the time of a frame of the core, from its start strobe to its end. A
// burst is in the window begin..end if its end_ps > begin and its request_ps < end. A QueueLevel is in the
// window if begin < time_ps <= end.
class BusTrace : public pci::PciBusObserver,
                 public pci::LocalBusMasterObserver,
                 public fpga::LocalBusObserver,
                 public fpga::FrameObserver {
 public:
  // If the window names a frame, the whole frame is traced. `observer` outlives this object. Throws
  // std::invalid_argument if a window of rows names no frame, or if a clock of the board is out of range.
  BusTrace(const BoardConfig& board, const fpga::CycleWindow& window, BusObserver& observer);
  BusTrace(const BusTrace&) = delete;
  BusTrace& operator=(const BusTrace&) = delete;

  // What the blocks do.
  void pci_burst_ended(const pci::EndedPciBurst& burst) override;
  void words_posted(std::uint64_t now_ps, std::size_t words) override;
  void transfer_waits(std::uint64_t now_ps, pci::LocalBusSource source) override;
  void burst_begins(std::uint64_t now_ps, pci::LocalBusSource source, std::size_t words) override;
  void posted_words_leave(std::uint64_t at_ps, std::size_t words) override { leaving_ = {at_ps, words}; }
  void local_burst_ended(const fpga::EndedLocalBurst& burst) override;
  void frame_begun(std::uint64_t strobe_ps) override;
  void frame_ended(const fpga::FrameTimes& times) override;
  // The observer of a capture board. `side`: 0 left, 1 right.
  capture::FifoObserver& capture_fifo(std::size_t side) { return fifos_[side]; }
  // `show(now_ps)` lets both observers of FIFOs receive all words up to a time.
  void set_show_words(std::function<void(std::uint64_t)> show) { show_words_ = std::move(show); }

  // Hands out, once each, the bursts whose bus is free again by `now_ps`, and the levels up to `now_ps`.
  // Keeps later records, which a computer that is ahead of `now_ps` has made. To be called regularly, because
  // records fill memory, and at the end of the run.
  void hand_out(std::uint64_t now_ps);

 private:
  class Fifo : public capture::FifoObserver {
   public:
    Fifo(BusTrace& trace, const char* name) : trace_(trace), name_(name) {}
    void word_came(std::uint64_t time_ps) override { add(came_ps_, time_ps, 1); }
    void words_left(std::uint64_t time_ps, std::size_t words) override {
      add(left_ps_, time_ps, -static_cast<std::int64_t>(words));
    }
    // All words up to `now_ps` have come or left.
    void settle(std::uint64_t now_ps);

   private:
    struct Change {
      std::uint64_t time_ps;
      std::int64_t words;
    };
    // A change that is reported again is left out.
    void add(std::uint64_t& last_ps, std::uint64_t time_ps, std::int64_t words);

    BusTrace& trace_;
    const char* name_;
    std::uint64_t came_ps_ = 0;  // the last word that has come
    std::uint64_t left_ps_ = 0;
    std::vector<Change> changes_;
    std::int64_t words_ = 0;
  };
  struct Words {
    std::uint64_t time_ps = kNever;
    std::size_t words = 0;
  };
  struct EndedBurst {
    BusBurst burst;
    std::uint64_t free_ps = 0;  // its bus is free
  };

  std::uint64_t take_posted(std::size_t words);
  void settle_posted(std::uint64_t now_ps);
  const char* local_target(std::uint64_t address) const;

  bool is_in_window(const BusBurst& burst) const;
  bool is_in_window(const QueueLevel& level) const;
  void add(const BusBurst& burst, std::uint64_t free_ps);
  void add(const QueueLevel& level);

  BusObserver& observer_;
  Clock core_clock_;
  Clock local_clock_;
  std::vector<std::string> banks_;
  std::function<void(std::uint64_t)> show_words_;
  std::array<Fifo, 2> fifos_{Fifo(*this, "left_capture"), Fifo(*this, "right_capture")};

  // The window. If it is a frame, both are kNever until the frame begins, and end_ps_ is until it ends.
  std::uint64_t begin_ps_ = kNever;
  std::uint64_t end_ps_ = kNever;
  std::optional<std::uint64_t> frame_;
  std::uint64_t frames_ended_ = 0;

  std::deque<Words> posted_;                 // not in a burst yet, oldest first
  Words leaving_;                            // of the posted burst that began last; kNever: they have left
  std::size_t posted_words_ = 0;             // all that have not left
  std::array<std::uint64_t, 4> waits_ps_{};  // [source]: the transfer waits from this time on
  // The burst of the local bus that began last.
  pci::LocalBusSource source_ = pci::LocalBusSource::kPosted;
  std::uint64_t request_ps_ = 0;

  // Not handed out yet.
  std::vector<EndedBurst> bursts_;
  std::vector<QueueLevel> levels_;
};

}  // namespace stereotlm::platform
