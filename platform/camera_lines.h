#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "models/capture/capture_control.h"
#include "models/pci/bridge_control.h"
#include "models/pci/pci_bus_control.h"
#include "platform/fast_board.h"

namespace stereotlm::platform {

// Skips lines of the cameras. Both cameras send line after line, at the same times. If the words of a line
// reach the banks undisturbed, everything from its first request of the PCI bus to that of the next line
// depends on two things only: whose turn it is, and the order of three series of times, which are the edges of
// the clocks of PCI bus and local bus, and the arrivals of the first and the last pixel of each word.
//
// So a line is stepped once, and recorded: what was counted, whose turn it is then, and how far the clocks of
// the PCI bus could move against the pixels, and those of the local bus against the PCI bus, before an event
// on the PCI bus would change places with one of these times. A later line that begins with the same turn and
// within these bounds is skipped. A line that no record fits is stepped.
//
// A line is undisturbed if at its beginning nothing is under way, both boards request the bus from the same
// time on, their words go to two banks that serve one word a cycle independently of the core's frame, and
// nothing else happens until the last word is there.
class CameraLines {
 public:
  // `has_pixels`: whether the words of the skipped lines are written. The other arguments outlive this object.
  CameraLines(pci::PciBusControl& pci_bus, pci::BridgeControl& bridge, FastBoard& board,
              std::array<capture::CaptureControl, 2>& captures, bool has_pixels);

  // Whether a line begins with the next decision of the PCI bus.
  bool begins() const {
    return captures_[0].is_between_lines() && captures_[1].is_between_lines() && both_request();
  }
  // To be called then, before that decision, at `now_ps`. Before `end_ps` nothing but the PCI bus and the
  // bridge has an event. Returns true if it has skipped the line, instead of that decision.
  bool skip(std::uint64_t now_ps, std::uint64_t end_ps);

  // While a line is recorded, stepped() is to be called after each event of PCI bus and bridge, and drop()
  // when something else happens.
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

  // How a line begins.
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
  // What a line does. Clocks are counted from the one with which it begins, on the local bus from the next one.
  struct Line {
    struct Side {
      pci::PciBusControl::MasterCounts pci;
      std::uint64_t end_clock = 0;                      // of the PCI bus: its last burst ends
      std::vector<fpga::HostPort::ServedWords> bursts;  // on the local bus: when its words request their bank
    };
    OfSides<Side> sides;
    pci::PciBusControl::Position pci;  // after the line
    std::size_t turns = 0;             // how often the turn on the local bus was passed on
    std::uint64_t most_posted = 0;     // the most words in the bridge at one time
    std::uint64_t bursts = 0;          // on the local bus
    std::uint64_t busy_clocks = 0;
    std::uint64_t address_clock = 0;  // of the last burst
    std::uint64_t idle_clock = 0;
  };
  // The line that is being recorded.
  struct Record {
    Beginning beginning;
    // How far the clocks of the PCI bus could move against the pixels, and those of the local bus against them.
    std::int64_t pci_earlier_ps = kFar, pci_later_ps = kFar;
    std::int64_t local_earlier_ps = kFar, local_later_ps = kFar;
    Line line;
    int row = 0;
    std::uint64_t pci_clock = 0;    // with which the line begins
    std::uint64_t local_clock = 0;  // the next one
    OfSides<std::uint64_t> addresses{};
    // At the beginning of the line.
    OfSides<pci::PciBusControl::MasterCounts> counts;
    OfSides<std::uint64_t> looks{};
    pci::PciBusControl::Position position;
    std::size_t turn = 0;
    std::uint64_t transactions = 0;
    std::uint64_t bursts = 0;
    std::uint64_t busy_clocks = 0;
    // After the last event.
    OfSides<std::uint64_t> request_clocks{};
    OfSides<std::uint64_t> words_on_local_bus{};
    std::uint64_t bursts_seen = 0;
  };

  bool both_request() const;
  std::optional<OfSides<std::uint64_t>> bank_addresses() const;
  Beginning beginning(std::uint64_t now_ps) const;
  const Line* find(const Beginning& beginning);
  std::size_t cell_of(const Beginning& beginning) const;
  bool fits_before(const Line& line, std::uint64_t now_ps, std::uint64_t end_ps) const;
  void apply(const Line& line, std::uint64_t now_ps, const OfSides<std::uint64_t>& addresses);

  void begin_record(std::uint64_t now_ps, const Beginning& beginning,
                    const OfSides<std::uint64_t>& addresses);
  void keep_place(std::uint64_t pci_clock, bool among_local_clocks);
  void see_local_burst();
  void end_record();
  bool record_is_whole() const;

  std::uint64_t words_of_line() const {
    return static_cast<std::uint64_t>(captures_[0].fifo().words_per_line());
  }
  const Clock& pci_clock() const { return pci_bus_.clock(); }
  const Clock& local_clock() const { return board_.local_bus().clock(); }

  pci::PciBusControl& pci_bus_;
  pci::BridgeControl& bridge_;
  FastBoard& board_;
  OfSides<capture::CaptureControl>& captures_;
  bool has_pixels_;
  bool buses_are_in_step_;
  std::uint64_t pci_cell_ps_;  // the part of a clock that a cell covers
  std::uint64_t local_cell_ps_;

  std::vector<Bounds> bounds_;
  std::vector<Line> lines_;  // [index in bounds_]
  // [cell of beginnings]: 1 + the index of the record that was found for one of them last; 0: none yet
  std::vector<std::uint16_t> cells_;
  bool is_recording_ = false;
  Record record_;
  std::uint64_t recorded_ = 0;  // lines of which a record was begun
  std::uint64_t skipped_ = 0;
};

}  // namespace stereotlm::platform
