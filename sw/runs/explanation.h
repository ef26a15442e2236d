#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "platform/bounds.h"
#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "sw/explore/plan/knobs.h"
#include "sw/explore/store/store.h"
#include "sw/explore/sweep/batch.h"
#include "sw/runs/simulation/simulate_point.h"

namespace stereotlm::runs {

// Simulates a board, and once more one board for each step of a knob, without pixels: what limits the board,
// and what each step gains or costs.
class Explanation {
 public:
  // `camera`: the whole computer, else the core alone. `board` and `tables` outlive the object.
  Explanation(const platform::BoardConfig& board, const platform::Tables& tables, bool camera);

  // Returns false if interrupted. Everything below needs a call that has returned true.
  bool simulate(PointSimulator simulator);

  // The result of the simulation of one board.
  struct Rate {
    double frames_per_second = 0;
    bool loses_pixels = false;
    std::string failure;  // the reason if the run has failed; else empty
  };
  // The board itself. Throws std::runtime_error if its run has failed.
  Rate now();
  // The figures of the board itself, valid until the next call of a member function.
  const explore::StoredRow& figures() { return batch_.row_of(points_.point(0)); }
  std::uint64_t frames() const { return explore::frames_of(run_, board_); }
  bool camera() const { return run_.camera; }

  // The busiest bank of a simulated board.
  struct BusiestBank {
    std::string name;
    double accesses_per_frame = 0;  // with separate ports: the larger of its reads and its writes
  };

  struct Step {
    const explore::KnobStep* step = nullptr;
    Rate rate;
    BusiestBank busiest;  // without meaning if the run has failed
  };
  // All steps, the best first; those that have failed last.
  std::vector<Step> steps();
  BusiestBank busiest_bank();
  const explore::KnobSteps& knobs() const { return knobs_; }

  // A resource of the board and its bound.
  struct Resource {
    std::string name;
    double frames_per_second = 0;  // its bound
    double headroom_percent = 0;   // share of the time of a frame that the resource does not need
    std::uint64_t frame = 0;       // the frame with the least headroom
    bool varies = false;           // the headroom is larger in other frames
  };
  // All resources, the least headroom first. For a resource of the core, the headroom is the least over the
  // frames of one allocation period. The time of a frame is its cycles and, for a whole computer, its share of
  // the time between frames.
  std::vector<Resource> resources();

  // Who stalls for whom, the most cycles first.
  std::vector<explore::StoredBlame> blames();

 private:
  std::vector<platform::BoardConfig> boards() const;
  Rate rate_of(std::uint64_t number);
  BusiestBank busiest_bank_of(std::uint64_t number, const platform::BoardConfig& board);

  const platform::BoardConfig& board_;
  const platform::Tables& tables_;
  explore::PointRun run_;
  explore::KnobSteps knobs_;
  explore::BoardPoints points_;
  explore::Batch batch_;
};

}  // namespace stereotlm::runs
