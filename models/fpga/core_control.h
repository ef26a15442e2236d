#pragma once

#include <array>
#include <cstdint>

#include "models/fpga/core_config.h"
#include "models/fpga/core_ports.h"
#include "models/fpga/frame_geometry.h"
#include "models/fpga/lane_control.h"
#include "models/fpga/match_control.h"
#include "models/fpga/port_cycles.h"
#include "models/fpga/result_control.h"
#include "models/memory/bank_arbiter.h"

namespace stereotlm::fpga {

// [port]: read latency of the bank that holds the port's buffer in a frame, 1 or 2 cycles. Without meaning
// for a port that writes, or that the core does not have.
using FrameLatencies = std::array<int, kCorePortCount>;

// [side]: whether the table entry is valid that the LUT port has read in a cycle; false if it has read none.
using EntriesRead = std::array<bool, 2>;

// The timing of the whole core (contract section 2): what every port requests in a cycle, and what follows
// from the grants. Plain C++ without data and without SystemC: the core's process and run_core() step the
// same object.
//
// A cycle is decide(), then the arbitration of the ports that request, then commit().
class CoreControl {
 public:
  struct Decision {
    std::array<Intent, kCorePortCount> intents;  // [port]
    bool consume;  // the matcher consumes a slot of both lanes, or a cycle of the drain
    bool drain;

    memory::PortMask requests() const { return ports_with(Intent::kRequest); }
    memory::PortMask passes() const { return ports_with(Intent::kPass); }

   private:
    memory::PortMask ports_with(Intent intent) const {
      unsigned ports = 0;
      for (std::size_t port = 0; port < kCorePortCount; ++port)
        ports |= unsigned{intents[port] == intent} << port;
      return static_cast<memory::PortMask>(ports);
    }
  };

  // Throws std::invalid_argument if the configuration has problems.
  explicit CoreControl(const CoreConfig& config);

  void start_frame(const FrameLatencies& latencies);
  Decision decide() const;
  // Returns true if the matcher has completed a group of four columns, counted from result_delay_columns % 4
  // on.
  bool commit(const Decision& decision, memory::PortMask granted, const EntriesRead& entries_valid);

  // Counts cycles of the host port, which commit() does not count.
  void count_host(bool requested, bool granted, std::uint64_t cycles = 1) {
    host_cycles().add(requested ? Intent::kRequest : Intent::kIdle, granted, cycles);
  }
  // Corrects cycles that are counted as idle, now or later in the frame: the host requested an uncontended
  // bank in them.
  void host_was_busy(bool granted, std::uint64_t cycles) {
    host_cycles().subtract(Intent::kIdle, false, cycles);
    host_cycles().add(Intent::kRequest, granted, cycles);
  }
  // Corrects `cycles` cycles of this frame in which the pixel port of a side is counted as granted: it passed
  // a slot. `marks`: see LaneControl::correct_marks().
  void correct_passes(Side side, std::uint64_t cycles, std::uint64_t marks);

  // After a group of four columns: the state that determines the next cycles, together with the arbiters'
  // state and the slots not yet taken.
  struct State {
    std::array<LaneControl::State, 2> lanes{};  // [side]
    std::uint64_t rest = 0;

    friend bool operator==(const State& a, const State& b) { return a.lanes == b.lanes && a.rest == b.rest; }
  };
  State state() const {
    return {{lane(Side::kLeft).state(), lane(Side::kRight).state()}, match_.state() | result_.state() << 8U};
  }
  // Skips cycles in which the matcher consumes `columns` columns, at most uniform_columns(), and `words`
  // words of results are written; lanes and result queue end in this state.
  void skip_to(const State& state, std::uint64_t columns, std::uint64_t words);
  // Cycles of the core's own ports, over all frames.
  using Counts = std::array<PortCycles, kCorePortCount>;
  Counts counts() const;
  static Counts difference(const Counts& after, const Counts& before);
  // Adds cycles that were skipped.
  void add(const Counts& counts, std::uint64_t times);

  const MatchControl& match() const { return match_; }
  const ResultControl& result() const { return result_; }
  const LaneControl& lane(Side side) const { return lanes_[index_of(side)]; }
  const FrameGeometry& geometry() const { return geometry_; }
  // The last word of the frame has been written.
  bool frame_done() const { return result_.frame_done(); }
  // A lower bound of the cycle in which the last write of the frame is granted. `cycle` is the next to run.
  std::uint64_t earliest_last_write(std::uint64_t cycle) const;
  // Counts over all frames, of the cycles from the start of each frame to its last write.
  const PortCycles& port_cycles(memory::Port port) const { return cycles_[port]; }
  // Slots consumed and words written, over all frames: grows as long as frames proceed.
  std::uint64_t work() const { return lane(Side::kLeft).consumed() + port_cycles(kResultPort).granted(); }

 private:
  PortCycles& host_cycles() { return cycles_[kHostPort]; }

  FrameGeometry geometry_;
  std::array<LaneControl, 2> lanes_;  // [side]
  MatchControl match_;
  ResultControl result_;
  std::array<PortCycles, kPortCount> cycles_{};  // [port]
};

inline CoreControl::Decision CoreControl::decide() const {
  Decision decision;
  const auto decide_lane = [&](Side side) {
    const LaneControl::Decision of_lane = lane(side).decide();
    decision.intents[lut_port(side)] = of_lane.lut;
    decision.intents[pixel_port(side)] = of_lane.pixel;
  };
  decide_lane(Side::kLeft);
  decide_lane(Side::kRight);
  decision.intents[kResultPort] = result_.decide();
  const bool slots_ready = lane(Side::kLeft).ready() && lane(Side::kRight).ready();
  decision.consume = match_.decide(slots_ready, result_.has_room());
  decision.drain = match_.draining();
  return decision;
}

inline bool CoreControl::commit(const Decision& decision, memory::PortMask granted,
                                const EntriesRead& entries_valid) {
  const auto is_granted = [granted](std::size_t port) { return (granted >> port & 1U) != 0; };
  for (std::size_t port = 0; port < kCorePortCount; ++port)
    cycles_[port].add(decision.intents[port], is_granted(port));
  const bool consumes_slot = decision.consume && !decision.drain;
  const auto commit_lane = [&](Side side) {
    const memory::Port lut = lut_port(side);
    const memory::Port pixel = pixel_port(side);
    lanes_[index_of(side)].commit({decision.intents[lut], decision.intents[pixel]}, is_granted(lut),
                                  is_granted(pixel), entries_valid[index_of(side)], consumes_slot);
  };
  commit_lane(Side::kLeft);
  commit_lane(Side::kRight);
  const bool four_columns = decision.consume && match_.consume();
  result_.commit(is_granted(kResultPort), four_columns && match_.word_leaves());
  return four_columns;
}

}  // namespace stereotlm::fpga
