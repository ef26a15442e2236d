#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "models/capture/capture_control.h"
#include "models/pci/bridge_control.h"
#include "models/pci/pci_bus_control.h"
#include "platform/bus_counts.h"
#include "platform/computer_parts.h"
#include "platform/fast_board.h"

namespace stereotlm::platform {

// Skips lines of the cameras that repeat what an earlier line did.
//
// Both cameras send a line at the same time. Its words take bursts on the PCI bus, wait in the bridge, and
// take bursts on the local bus to their banks. When this happens depends on three series of times: the
// arrivals of the first and of the last pixel of each word, the clocks of the PCI bus, and those of the local
// bus. These are seldom in step, so the times of a line seldom repeat. But only their order matters: which
// words are complete when a clock of the PCI bus begins, and which clock of the local bus comes next.
//
// So a line is stepped once and recorded: its counts, and the clocks in which it ends. The record also has
// bounds: how far the clocks of the PCI bus can move against the pixels, and those of the local bus against
// those of the PCI bus, before two times change their order. A later line is skipped if it begins within
// these bounds, and if the same master had the PCI bus last (the bus is granted in turn). A line that no
// record fits is stepped.
//
// This holds only for lines that nothing else touches:
// - Bridge, local bus and PCI bus are idle when the line begins, and both boards request then.
// - The banks of the words serve one word a cycle, whatever the running frame does: it does not use the bank,
//   or the host comes first. The local bus and the core have the same clock. The frame then runs as the
//   bursts demand.
// - Until the last word is stored, no other master requests the PCI bus, and no other block has an event.
// - No FIFO would run full if the words of a burst left it only at the end of the burst. Else the data clock
//   in which each word leaves would matter too.
// The first line of a picture and the last one are always stepped.
class CameraLines {
 public:
  // `has_pixels`: whether the words of the skipped lines are written. The other arguments outlive this
  // object.
  CameraLines(pci::PciBusControl& pci_bus, pci::BridgeControl& bridge, FastBoard& board,
              std::array<capture::CaptureControl, 2>& captures, bool has_pixels);

  // Whether a line begins with the next decision of the PCI bus: both boards wait for the same line, and the
  // bus is free as they request it.
  bool begins() const {
    return captures_[0].is_between_lines() && captures_[1].is_between_lines() &&
           captures_[0].requested_ps() == captures_[1].requested_ps() &&
           captures_[0].fifo().next_row() == captures_[1].fifo().next_row() &&
           pci_bus_.request_clock(kLeftCapture) == pci_bus_.decision_clock();
  }
  // To be called if begins(), before that decision, at `now_ps`. Before `end_ps` only the PCI bus and the
  // bridge have events. Returns true if it has skipped the line: that decision must not be made then.
  bool skip(std::uint64_t now_ps, std::uint64_t end_ps);

  // While a line is recorded, stepped() is to be called after each event of PCI bus and bridge, and drop()
  // after each other event. A step of the core that ends no frame needs neither: it only serves words.
  bool is_recording() const { return is_recording_; }
  void stepped(std::uint64_t now_ps, bool is_of_pci_bus);
  void drop() { is_recording_ = false; }

  // The number of lines skipped.
  std::uint64_t skipped() const { return skipped_; }

 private:
  static constexpr std::size_t kSides = 2;
  static constexpr std::int64_t kFar = INT64_MAX / 4;
  template <class T>
  using OfSides = std::array<T, kSides>;  // [left, right]

  struct Beginning {
    std::size_t last_granted = 0;  // master of the PCI bus
    std::int64_t pci_ps = 0;       // from the time of the requests to the next clock of the PCI bus
    std::int64_t local_ps = 0;     // from there to the next clock of the local bus
  };
  // The beginnings that a record fits.
  struct Bounds {
    Beginning least;
    Beginning most;

    bool hold(const Beginning& beginning) const {
      return least.pci_ps <= beginning.pci_ps && beginning.pci_ps <= most.pci_ps &&
             least.local_ps <= beginning.local_ps && beginning.local_ps <= most.local_ps &&
             least.last_granted == beginning.last_granted;
    }
  };
  // What a line does. Clocks of the PCI bus are counted from the one with which the line begins, clocks of
  // the local bus from the next one after that.
  struct Line {
    struct SideLine {
      pci::PciBusControl::MasterCounts pci;
      std::uint64_t end_clock = 0;    // of the PCI bus: its last burst ends
      std::uint64_t first_clock = 0;  // of its first LocalBurst
    };
    // A burst on the local bus: its side, and the clock in which its words begin to request their bank.
    struct LocalBurst {
      std::size_t side;
      std::uint64_t first_clock;
      std::uint64_t words;
    };
    OfSides<SideLine> sides;
    std::vector<LocalBurst> bursts;
    pci::PciBusControl::Position pci;  // after the line
    BusCounts buses;
    std::size_t turns = 0;         // how often the turn on the local bus was passed on
    std::uint64_t idle_clock = 0;  // of the last burst on the local bus
  };
  struct Record {
    Beginning beginning;
    // How far the clocks of the PCI bus could move against the pixels, and those of the local bus against
    // those of the PCI bus.
    std::int64_t pci_earlier_ps = kFar, pci_later_ps = kFar;
    std::int64_t local_earlier_ps = kFar, local_later_ps = kFar;
    Line line;                      // so far
    int row = 0;                    // its number in the picture
    std::uint64_t pci_clock = 0;    // with which the line begins
    std::uint64_t local_clock = 0;  // the next one
    OfSides<std::uint64_t> addresses{};
    // At the beginning of the line.
    OfSides<pci::PciBusControl::MasterCounts> counts;
    OfSides<std::uint64_t> full_checks{};
    BusCounts buses;
    std::size_t turn = 0;
    // The clocks of the requests for which the bounds are narrowed already.
    OfSides<std::uint64_t> request_clocks{};
  };

  std::optional<OfSides<std::uint64_t>> bank_addresses() const;
  Beginning beginning(std::uint64_t now_ps) const;
  const Line* find(const Beginning& beginning) const;
  bool fits_before(const Line& line, std::uint64_t now_ps, std::uint64_t end_ps) const;
  void apply(const Line& line, std::uint64_t now_ps, const OfSides<std::uint64_t>& addresses);
  void set_bursts(const Line& line, std::uint64_t first_local, const OfSides<std::uint64_t>& addresses);

  void begin_record(std::uint64_t now_ps, const Beginning& beginning,
                    const OfSides<std::uint64_t>& addresses);
  void record_pci_step(std::uint64_t clock);
  void record_local_burst();
  void narrow_pixel_bounds(std::uint64_t pci_clock);
  void narrow_local_bounds(std::uint64_t pci_clock);
  void end_record();
  bool record_is_whole(const BusCounts& buses) const;

  std::uint64_t words_of_line() const {
    return static_cast<std::uint64_t>(captures_[0].fifo().words_per_line());
  }

  pci::PciBusControl& pci_bus_;
  fpga::LocalBusControl& local_bus_;
  pci::BridgeControl& bridge_;
  FastBoard& board_;
  OfSides<capture::CaptureControl>& captures_;
  bool has_pixels_;
  // The clocks of the PCI bus have few phases against those of the local bus. Two phases that differ by at
  // most this are the same: it is half a step from phase to phase.
  std::int64_t phase_tolerance_ps_;

  std::vector<Bounds> bounds_;
  std::vector<Line> lines_;  // [index in bounds_]
  std::size_t oldest_ = 0;   // index of the record that is replaced next; 0 until there are kMostRecords
  bool is_recording_ = false;
  Record record_;
  std::uint64_t recorded_ = 0;  // lines of which a record was begun
  std::uint64_t unknown_ = 0;   // lines that no record fitted
  std::uint64_t skipped_ = 0;
  std::vector<fpga::HostPort::SkippedBurst> bursts_;  // of apply()
};

}  // namespace stereotlm::platform
