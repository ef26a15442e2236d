#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "models/fpga/core_config.h"
#include "models/fpga/core_ports.h"
#include "models/fpga/frame_geometry.h"
#include "models/fpga/lane_control.h"
#include "models/fpga/match_control.h"
#include "models/fpga/port_cycles.h"
#include "models/fpga/result_control.h"
#include "models/memory/bank_arbiter.h"

namespace stereotlm::fpga {

// [port group]: read latency of the bank that holds the group's buffer in a frame, 1 or 2 cycles. Without
// meaning for a group that writes, or that the core does not have.
using FrameLatencies = std::array<int, kCoreGroupCount>;

// Whether the slots whose table entries have been read in a cycle need an access for their pixels: bit
// CoreControl::lane_index() for each lane.
using PixelNeeds = std::uint32_t;

// Decides the timing of the whole core (contract section 2): what every port requests in a cycle, and what
// follows from the grants. Plain C++ without data and without SystemC, used at every fidelity, with and
// without modules.
//
// A cycle is decide(), then the arbitration of the ports that request, then commit().
class CoreControl {
 public:
  struct Decision {
    std::array<Intent, memory::kMostPorts - 1> intents;  // [port]
    memory::PortMask requests = 0;                       // ports with Intent::kRequest
    memory::PortMask passes = 0;                         // ports with Intent::kPass
    bool work;                                           // the matcher works on a consume-cycle
    bool consume;                                        // the consume-cycle ends in this cycle
    bool drain;
  };

  // Throws std::invalid_argument if the configuration has problems.
  explicit CoreControl(const CoreConfig& config);

  void start_frame(const FrameLatencies& latencies);
  Decision decide() const;
  // Carries out the decision with these grants. Returns true if the matcher has completed a group of four
  // columns. Groups are counted from column result_delay_columns % 4 on.
  bool commit(const Decision& decision, memory::PortMask granted, PixelNeeds needs_pixel);

  // The number of cycles, from the next one on, in which everything waits for the matcher: no port of the
  // core requests or passes, and the matcher works on a slot without consuming it.
  std::uint64_t waiting_cycles() const {
    const std::uint64_t cycles = std::min(match_.cycles_to_consume(), result_.cycles_to_arrival());
    if (cycles == 0 || !std::all_of(lanes_.begin(), lanes_.end(), std::mem_fn(&LaneControl::has_all)))
      return 0;
    const Decision decision = decide();
    return decision.requests == 0 && decision.passes == 0 ? cycles : 0;
  }
  // Skips `cycles` of these cycles. The host must not request in them.
  void skip_waiting(std::uint64_t cycles);

  // Counts cycles of the frame in which the host port requested, which commit() does not count.
  void count_host(bool granted, std::uint64_t cycles = 1) {
    cycles_.back().add(Intent::kRequest, granted, cycles);
  }
  // See LaneControl.
  void set_marks(std::size_t lane, std::uint64_t marks) { lanes_[lane].set_marks(marks); }

  // The state that determines the next cycles, together with the arbiters' state and the slots that the pixel
  // ports have not handled.
  void append_state(memory::StateWords& state) const {
    for (const LaneControl& lane : lanes_) state.push_back(lane.state());
    state.push_back(match_.state() | result_.state() << kHalf);
    if (result_.delay() != 0) state.push_back(result_.arrivals());
  }
  // Skips cycles, after which the core is in `state`. In them `consumed` consume-cycles end, and `words`
  // words of results are written. The caller then calls set_marks().
  void set_state(memory::StateReader& state, std::uint64_t consumed, std::uint64_t words);
  // [port]: cycles of the core's own ports, over all frames.
  using Counts = std::vector<PortCycles>;
  Counts counts() const;
  static Counts difference(const Counts& after, const Counts& before);
  // Adds cycles that were skipped.
  void add(const Counts& counts, std::uint64_t times);

  const MatchControl& match() const { return match_; }
  const ResultControl& result() const { return result_; }
  // The lanes of the left side, then those of the right side.
  const std::vector<LaneControl>& lanes() const { return lanes_; }
  const LaneControl& lane(std::size_t lane) const { return lanes_[lane]; }
  std::size_t lane_index(Side side, std::size_t lane) const { return index_of(side) * ports_.lanes() + lane; }
  Side side_of(std::size_t lane) const { return lane < ports_.lanes() ? Side::kLeft : Side::kRight; }
  // The port that takes the slots of a lane with table. With joint tables it serves the lane of each side.
  memory::Port table_port(std::size_t lane) const {
    return has_joint_tables_ && lane >= ports_.lanes() ? lane - ports_.lanes() : lane;
  }
  memory::Port pixel_port(std::size_t lane) const { return lanes_.size() + lane; }
  const CorePorts& ports() const { return ports_; }
  const FrameGeometry& geometry() const { return geometry_; }
  // Whether the last word of the frame has been written.
  bool frame_done() const { return result_.frame_done(); }
  // Cycles that this object does not know of: their number, the steps of the matcher that end in them (each
  // of `folds` cycles), and the words that are written.
  struct Unknown {
    std::uint64_t cycles = 0;
    std::uint64_t consumed = 0;
    std::uint64_t words = 0;
  };
  // A lower bound of the cycle in which the last write of the frame is granted. `cycle` is the next cycle to
  // run; `before` are cycles before it.
  std::uint64_t earliest_last_write(std::uint64_t cycle, const Unknown& before) const;
  // The cycles of a port, from the start of each frame to its last write, over all frames.
  PortCycles port_cycles(memory::Port port) const {
    PortCycles cycles = cycles_[port];
    // The host is idle in all cycles of the frame in which it does not request.
    if (port == ports_.host()) cycles.add(Intent::kIdle, false, cycles_.front().sum() - cycles.sum());
    return cycles;
  }
  // Cycles in which the matcher worked plus words written, over all frames. The sum grows as long as frames
  // make progress.
  std::uint64_t work() const { return match_.worked() + port_cycles(ports_.result()).granted(); }

 private:
  // Bits of the last word of the state: the matcher has the lower half, the result queue the upper half.
  static constexpr unsigned kHalf = 32;

  template <std::size_t kLanes>
  Decision decide_lanes() const;
  template <std::size_t kLanes>
  bool commit_lanes(const Decision& decision, memory::PortMask granted, PixelNeeds needs_pixel);
  // Whether the matcher can consume the slots of its next consume-cycle.
  bool slots_ready() const {
    const auto lanes = static_cast<std::size_t>(match_.lanes());
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      if (!lanes_[lane].ready() || !lanes_[ports_.lanes() + lane].ready()) return false;
    }
    return true;
  }

  FrameGeometry geometry_;
  CorePorts ports_;
  bool has_joint_tables_;
  std::vector<LaneControl> lanes_;  // see lanes()
  MatchControl match_;
  ResultControl result_;
  std::vector<PortCycles> cycles_;  // [port]; the host's without idle cycles
};

// `kLanes`: the number of lanes of both sides, or 0 if it is not known when this is compiled. With 2, the
// paper's, a run at `cycle` takes 0.90 of the time (move_lanes() of CoreDatapath: 0.98).
template <std::size_t kLanes>
CoreControl::Decision CoreControl::decide_lanes() const {
  const std::size_t lanes = kLanes != 0 ? kLanes : lanes_.size();
  const LaneControl* const all = lanes_.data();
  Decision decision;
  std::uint64_t requests = 0;  // of the readers, which are ports 0..63 at most
  std::uint64_t passes = 0;
  const auto decide_port = [&](std::size_t port, Intent intent) {
    decision.intents[port] = intent;
    requests |= std::uint64_t{intent == Intent::kRequest} << port;
    passes |= std::uint64_t{intent == Intent::kPass} << port;
  };
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const LaneControl::Decision of_lane = all[lane].decide();
    // With joint tables the lanes of both sides hold equally many slots, so that the left one decides.
    decide_port(lane, has_joint_tables_ && lane >= lanes / 2 ? Intent::kIdle : of_lane.lut);
    decide_port(lanes + lane, of_lane.pixel);
  }
  const Intent result = result_.decide();
  decision.intents[2 * lanes] = result;
  decision.requests = requests | memory::PortMask{result == Intent::kRequest} << 2 * lanes;
  decision.passes = passes;
  decision.drain = match_.draining();
  const bool is_ready = decision.drain || (kLanes == 2 ? all[0].ready() && all[1].ready() : slots_ready());
  decision.work = match_.decide(is_ready, result_.has_room());
  decision.consume = decision.work && match_.consumes();
  return decision;
}

template <std::size_t kLanes>
bool CoreControl::commit_lanes(const Decision& decision, memory::PortMask granted, PixelNeeds needs_pixel) {
  const std::size_t lanes = kLanes != 0 ? kLanes : lanes_.size();
  LaneControl* const all = lanes_.data();
  PortCycles* const cycles = cycles_.data();
  const auto of_readers = static_cast<std::uint64_t>(granted);  // they are ports 0..63 at most
  const auto is_granted = [of_readers](std::size_t port) { return (of_readers >> port & 1U) != 0; };
  const int in_cycle = kLanes == 2 ? 1 : match_.lanes();
  const auto consuming = static_cast<std::size_t>(decision.consume && !decision.drain ? in_cycle : 0);
  for (std::size_t port = 0; port < 2 * lanes; ++port)
    cycles[port].add(decision.intents[port], is_granted(port));
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const bool is_right = lane >= lanes / 2;
    const memory::Port lut = has_joint_tables_ && is_right ? lane - lanes / 2 : lane;
    const memory::Port pixel = lanes + lane;
    all[lane].commit({decision.intents[lut], decision.intents[pixel]}, is_granted(lut), is_granted(pixel),
                     (needs_pixel >> lane & 1U) != 0, (is_right ? lane - lanes / 2 : lane) < consuming);
  }
  const bool result_granted = memory::has(granted, 2 * lanes);
  cycles[2 * lanes].add(decision.intents[2 * lanes], result_granted);
  const bool four_columns = decision.work && match_.work();
  result_.commit(result_granted, four_columns ? match_.words_leaving() : 0);
  return four_columns;
}

inline CoreControl::Decision CoreControl::decide() const {
  return lanes_.size() == 2 ? decide_lanes<2>() : decide_lanes<0>();
}

inline bool CoreControl::commit(const Decision& decision, memory::PortMask granted, PixelNeeds needs_pixel) {
  return lanes_.size() == 2 ? commit_lanes<2>(decision, granted, needs_pixel)
                            : commit_lanes<0>(decision, granted, needs_pixel);
}

}  // namespace stereotlm::fpga
