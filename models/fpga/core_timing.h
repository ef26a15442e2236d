#pragma once

#include <cstdint>
#include <vector>

#include "models/fpga/core_config.h"
#include "models/fpga/core_control.h"
#include "models/fpga/row_recorder.h"
#include "models/fpga/slot_pattern.h"
#include "models/memory/arbitration.h"

namespace stereotlm::fpga {

// Whether the table entries that the LUT ports read in a cycle are valid.
struct EntriesRead {
  bool left_valid = false;
  bool right_valid = false;
};

// The cycles of the core: control and arbitration, stepped together. Plain C++, no SystemC.
//
// A frame can be stepped cycle by cycle, while whoever steps it moves the data; or it runs ahead by itself. Then what
// repeats is not stepped again: where the state after four columns of the matcher is what it was some columns before,
// and the slots to come make the same accesses as those in between, everything happens again and again, exactly, until
// that ends. Of a pixel port that is alone on its bank it does not matter which entries are valid: a slot that needs an
// access takes the cycle of one that passes. Running ahead, all are taken for valid then, and the counts are put right
// in the end.
//
// While rows are recorded the cycles around the end of each are stepped: at most so many more as two periods have.
class CoreTiming {
 public:
  // `arbitration` outlives it. Throws std::invalid_argument if the configuration has problems.
  CoreTiming(const CoreConfig& config, memory::Arbitration& arbitration);

  // Ports are routed. A frame whose data is moved as it is stepped ..
  void start_frame(const FrameLatencies& latencies);
  // .. or one that runs ahead, on these accesses, which outlive it.
  void start_frame(const FrameLatencies& latencies, const SlotPattern& left, const SlotPattern& right);
  // Routes are about to change within a frame.
  void begin_routing();
  // All cycles of the frame have been run: puts the counts right.
  void end_frame() { look_at_entries(); }

  // To be turned on between two frames.
  RowRecorder& rows() { return rows_; }
  const RowRecorder& rows() const { return rows_; }

  // One cycle, in which the host requests or not. `move` is called as move(decision, granted) between the grants and
  // what follows from them, and returns EntriesRead.
  template <class Move>
  memory::PortMask step(std::uint64_t cycle, bool host_requests, const Move& move) {
    using memory::PortMask;
    const CoreControl::Decision decision = control_.decide();
    const PortMask host = host_requests ? memory::mask_of(memory::Port::kHost) : PortMask{0};
    const PortMask granted = arbitration_.arbitrate(cycle, static_cast<PortMask>(decision.requests() | host));
    const EntriesRead read = move(decision, granted);
    four_columns_ = control_.commit(decision, granted, read.left_valid, read.right_valid);
    control_.count_host(host_requests, (granted & host) != 0);
    if (control_.result().words_written() == rows_.next_words()) rows_.note(cycle, control_);
    return granted;
  }
  // The same, with the entries that the patterns foretell.
  memory::PortMask step(std::uint64_t cycle, bool host_requests);

  // From cycle `cycle` to before cycle `end`, or until the frame is done. Returns the cycle that comes next.
  std::uint64_t run_ahead(std::uint64_t cycle, std::uint64_t end);
  // With `cycle` the next to run: the last write of the frame is not granted before the cycle returned.
  std::uint64_t earliest_last_write(std::uint64_t cycle) const;

  CoreControl& control() { return control_; }
  const CoreControl& control() const { return control_; }

 private:
  struct State {
    CoreControl::State control;
    memory::Arbitration::State arbitration{};

    friend bool operator==(const State& a, const State& b) {
      return a.control == b.control && a.arbitration == b.arbitration;
    }
  };
  // Where a period may have begun.
  struct Beginning {
    State state;
    std::uint64_t cycle = 0;
    std::uint64_t phase = 0;          // of the matcher
    std::uint64_t columns = 0;        // that the matcher has consumed
    std::uint64_t left_alike_to = 0;  // slots of the frame that make the accesses of those next to be taken
    std::uint64_t right_alike_to = 0;
  };
  struct Cycle {
    CoreControl::Decision decision;
    memory::PortMask granted;
  };

  // The table of one side, and its pixel port.
  struct Side {
    const SlotPattern* pattern = nullptr;
    bool looks = true;  // else all entries are taken for valid
  };

  void look_at_entries();
  void look_at_entries(Side& side, memory::Port port, LaneControl& lane);
  std::uint64_t repeat(std::uint64_t cycle, std::uint64_t end);
  void begin_period(const State& state, std::uint64_t cycle);
  std::uint64_t alike_to(const LaneControl& lane, const Side& side) const;
  std::uint64_t times_alike(std::uint64_t columns) const;

  CoreControl control_;
  RowRecorder rows_;
  memory::Arbitration& arbitration_;
  SlotPattern all_valid_;
  Side left_;
  Side right_;
  bool four_columns_ = false;  // the last cycle completed them

  bool tracking_ = false;
  Beginning beginning_;
  std::uint64_t groups_ = 0;    // of four columns, since the beginning
  std::uint64_t patience_ = 1;  // groups after which the beginning is moved; doubled each time
  std::vector<Cycle> period_;   // since the beginning
};

}  // namespace stereotlm::fpga
