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

// [side]: whether the slot whose table entry has been read in a cycle needs an access for its pixel.
using PixelNeeds = std::array<bool, 2>;

// Decides the timing of the whole core (contract section 2): what every port requests in a cycle, and what
// follows from the grants. Plain C++ without data and without SystemC, used at every fidelity, with and
// without modules.
//
// A cycle is decide(), then the arbitration of the ports that request, then commit().
class CoreControl {
 public:
  struct Decision {
    std::array<Intent, kCorePortCount> intents;  // [port]
    bool work;     // the matcher works on a slot of both lanes, or on a consume-cycle of the drain
    bool consume;  // the matcher consumes it in this cycle
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
  // Carries out the decision with these grants. Returns true if the matcher has completed a group of four
  // columns. Groups are counted from column result_delay_columns % 4 on.
  bool commit(const Decision& decision, memory::PortMask granted, const PixelNeeds& needs_pixel);

  // The number of cycles, from the next one on, in which everything waits for the matcher: no port of the
  // core requests or passes, and the matcher works on a slot without consuming it.
  std::uint64_t waiting_cycles() const {
    const std::uint64_t cycles = match_.cycles_to_consume();
    if (cycles == 0 || !lane(Side::kLeft).is_settled() || !lane(Side::kRight).is_settled()) return 0;
    const Decision decision = decide();
    return decision.requests() == 0 && decision.passes() == 0 ? cycles : 0;
  }
  // Skips `cycles` of these cycles. The host must not request in them.
  void skip_waiting(std::uint64_t cycles);

  // Counts cycles of the host port, which commit() does not count.
  void count_host(bool requested, bool granted, std::uint64_t cycles = 1) {
    host_cycles().add(requested ? Intent::kRequest : Intent::kIdle, granted, cycles);
  }
  // Counts cycles in which the host requested an uncontended bank. Corrects the frame's own count of them as
  // idle, which may come before or after this call.
  void host_was_busy(bool granted, std::uint64_t cycles) {
    host_cycles().subtract(Intent::kIdle, false, cycles);
    host_cycles().add(Intent::kRequest, granted, cycles);
  }
  // Recounts `cycles` cycles of this frame in which the pixel port of a side was counted as granted, but
  // passed a slot.
  void correct_passes(Side side, std::uint64_t cycles);
  // See LaneControl.
  void correct_marks(Side side, std::uint64_t marks) { lanes_[index_of(side)].correct_marks(marks); }

  // The state that determines the next cycles, together with the arbiters' state and the slots that the pixel
  // ports have not handled.
  void append_state(memory::StateWords& state) const {
    for (const LaneControl& lane : lanes_) state.push_back(lane.state());
    state.push_back(match_.state() | result_.state() << kHalf);
  }
  // Skips cycles, after which the core is in `state`. In them the matcher consumes `slots` slots (in the
  // drain: consume-cycles), and `words` words of results are written. `slots` is at most
  // MatchControl::uniform_slots(). The caller then calls correct_marks().
  void skip_to(memory::StateReader& state, std::uint64_t slots, std::uint64_t words);
  // Cycles of the core's own ports, over all frames.
  using Counts = std::array<PortCycles, kCorePortCount>;
  Counts counts() const;
  static Counts difference(const Counts& after, const Counts& before);
  // Adds cycles that were skipped.
  void add(const Counts& counts, std::uint64_t times);

  const MatchControl& match() const { return match_; }
  const ResultControl& result() const { return result_; }
  const LaneControl& lane(Side side) const { return lanes_[index_of(side)]; }
  // The port that takes the slots of a side with table. With joint tables it is one port for both sides.
  memory::Port table_port(Side side) const { return lut_port(has_joint_tables_ ? Side::kLeft : side); }
  const FrameGeometry& geometry() const { return geometry_; }
  // Whether the last word of the frame has been written.
  bool frame_done() const { return result_.frame_done(); }
  // A lower bound of the cycle in which the last write of the frame is granted. `cycle` is the next cycle to
  // run.
  std::uint64_t earliest_last_write(std::uint64_t cycle) const;
  // The cycles of a port, from the start of each frame to its last write, over all frames.
  const PortCycles& port_cycles(memory::Port port) const { return cycles_[port]; }
  // Cycles in which the matcher worked plus words written, over all frames. The sum grows as long as frames
  // make progress.
  std::uint64_t work() const { return match_.worked() + port_cycles(kResultPort).granted(); }

 private:
  // Bits of the last word of the state: the matcher has the lower half, the result queue the upper half.
  static constexpr unsigned kHalf = 32;

  PortCycles& host_cycles() { return cycles_[kHostPort]; }

  FrameGeometry geometry_;
  bool has_joint_tables_;
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
  // With joint tables both lanes hold equally many slots, so that the left one decides for both.
  if (has_joint_tables_) decision.intents[lut_port(Side::kRight)] = Intent::kIdle;
  decision.intents[kResultPort] = result_.decide();
  const bool slots_ready = lane(Side::kLeft).ready() && lane(Side::kRight).ready();
  decision.work = match_.decide(slots_ready, result_.has_room());
  decision.consume = decision.work && match_.consumes();
  decision.drain = match_.draining();
  return decision;
}

inline bool CoreControl::commit(const Decision& decision, memory::PortMask granted,
                                const PixelNeeds& needs_pixel) {
  const auto is_granted = [granted](std::size_t port) { return (granted >> port & 1U) != 0; };
  for (std::size_t port = 0; port < kCorePortCount; ++port)
    cycles_[port].add(decision.intents[port], is_granted(port));
  const bool consumes_slot = decision.consume && !decision.drain;
  const auto commit_lane = [&](Side side) {
    const memory::Port lut = table_port(side);
    const memory::Port pixel = pixel_port(side);
    lanes_[index_of(side)].commit({decision.intents[lut], decision.intents[pixel]}, is_granted(lut),
                                  is_granted(pixel), needs_pixel[index_of(side)], consumes_slot);
  };
  commit_lane(Side::kLeft);
  commit_lane(Side::kRight);
  const bool four_columns = decision.work && match_.work();
  result_.commit(is_granted(kResultPort), four_columns ? match_.words_leaving() : 0);
  return four_columns;
}

}  // namespace stereotlm::fpga
