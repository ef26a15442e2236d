#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "platform/config/tables.h"
#include "platform/figures/bounds.h"
#include "sw/explore/optimise/figure_range.h"
#include "sw/explore/plan/knobs.h"
#include "sw/explore/store/store.h"
#include "sw/runs/simulation/simulate_point.h"

namespace stereotlm::runs {

class ProgressLine;

// What the time of a frame goes to, in percent of it. The shares sum to 100.
struct Budget {
  double bound = 0;   // the frame takes as long as its matcher and ports need for it
  double queues = 0;  // queues and latencies of the core
  double waits = 0;   // ports wait for banks
  // The core waits for its next start, by reason (sw/report/README.md, Time line); of the core alone empty.
  std::map<std::string, double> core_waits;
};

// The figures of a run by their names. One that is missing reads as "" and 0.
class NamedFigures {
 public:
  NamedFigures() = default;
  explicit NamedFigures(const explore::Figures& figures);

  std::string text(const std::string& name) const;
  std::int64_t integer(const std::string& name) const;
  double real(const std::string& name) const;

 private:
  std::map<std::string, platform::KeyValue> values_;
};

// Simulates a board, and one board for each step of a knob, without pixels. Finds what limits the board, and
// what each step gains or costs.
class Explanation {
 public:
  // A multiple of every possible turn of the lists (1, 2, 3 or 6).
  static constexpr std::uint64_t kTurns = 6;
  // The default numbers of frames of each board. 6 of the 42 are for the warm-up of the whole computer.
  static constexpr std::uint64_t kCoreFrames = kTurns;
  static constexpr std::uint64_t kComputerFrames = 7 * kTurns;
  // The fewest frames of the whole computer with which every board has a steady rate.
  static constexpr std::uint64_t kLeastComputerFrames = 2 * kTurns;

  // `camera`: the whole computer, else the core alone. `frames`: 0 for the default. `board` and `tables`
  // outlive the object.
  Explanation(const platform::BoardConfig& board, const platform::Tables& tables, bool camera,
              std::uint64_t frames = 0);

  // Returns false if interrupted before the board itself was simulated. A later interrupt leaves out steps
  // that were not simulated. Throws std::runtime_error if the run of the board itself has failed.
  // Everything below needs a call that has returned true.
  bool simulate(PointSimulator simulator);

  // The result of the simulation of one board.
  struct Rate {
    // Of the core. Of the whole computer in the long run: the steady rate, narrowed by what is proven.
    double frames_per_second = 0;
    double uncertainty = 0;        // 0 if the rate is proven
    std::int64_t lost_pixels = 0;  // by captures
    double memory_mj = 0;  // energy of the memories for each frame, in the long run, of whole pictures
    std::string failure;   // the reason if the run has failed; else empty
    bool loses_pixels() const { return lost_pixels > 0; }
    bool is_whole() const { return failure.empty() && !loses_pixels(); }
  };
  const platform::BoardConfig& board() const { return board_; }
  const Rate& now() const { return now_; }  // of the board itself
  // The figures of the board itself.
  const NamedFigures& figures() const { return figures_; }
  std::uint64_t frames() const { return explore::frames_of(run_, board_); }
  bool camera() const { return run_.camera; }

  // The bank with the most accesses for a frame. Of a whole computer these are those of the long run, with
  // all that the host moves, also between two frames.
  struct BusiestBank {
    std::string name;
    double accesses_per_frame = 0;  // with separate ports: the larger of its reads and its writes
  };

  struct Step {
    const explore::KnobStep* step = nullptr;
    Rate rate;
    BusiestBank busiest;
  };
  // All steps that were simulated, the best first: by their rate, those that lose pixels after the others,
  // those that have failed last. Of a group only the best. A step is not simulated if it is proven that it
  // does not exceed the rate of another one of its group by more than its uncertainty.
  const std::vector<Step>& steps() const { return steps_; }
  // How many of knobs().possible were simulated, and how many others share the simulation of one of them or
  // of the board itself, because both do the same at the same time.
  std::size_t simulated() const { return evaluated_ - shared_; }
  std::size_t shared() const { return shared_; }
  // How many of them were left out for that.
  std::size_t left_out() const { return knobs_.possible.size() - evaluated_ - next_boards().size(); }
  // "12 of 47 changes were evaluated"; empty without an interrupt.
  std::string interruption() const;
  const BusiestBank& busiest_bank() const { return busiest_; }
  const explore::KnobSteps& knobs() const { return knobs_; }

  // A resource of the board and its bound.
  struct Resource {
    std::string name;
    double frames_per_second = 0;  // its bound
    double headroom_percent = 0;   // share of the time of a frame that the resource does not need
    // The measured use. Ports, matcher and banks: share of the cycles of all frames in which they work on a
    // slot or make an access. Buses: share of clocks that are not idle. Cameras: share of frames captured.
    double busy_percent = 0;
    std::uint64_t frame = 0;  // the frame with the least headroom
    bool varies = false;      // the headroom is larger in other frames
  };
  // All resources, the least headroom first. The headroom of ports and matcher, and of banks if the core runs
  // alone, is the least in a turn of the allocation lists. On a whole computer the time between frames is
  // divided among the frames in proportion to their cycles. A steady rate above its bound counts as the
  // bound. Where captures lose pixels, the headroom of a bus or bank is that with whole pictures at this
  // rate, and can be negative.
  const std::vector<Resource>& resources() const { return resources_; }

  // The bound of the rate, and what sets it. Where captures lose pixels, fewer words are moved: then it is
  // that of the core or of the cameras.
  const platform::RateBound& rate_bound() const { return rate_bound_; }
  // Of the whole computer: the time in which the cameras deliver a pair of pictures, and the time that its
  // words take at least on each bus.
  double picture_seconds() const;
  const std::map<std::string, double>& pair_seconds() const { return pair_seconds_; }

  const Budget& budget() const { return budget_; }
  double percent_of_cycles(std::uint64_t cycles) const {
    return 100 * static_cast<double>(cycles) / static_cast<double>(figures_.integer("cycles"));
  }
  double gained_percent(const Step& step) const {
    return 100 * (step.rate.frames_per_second / now_.frames_per_second - 1);
  }
  // The change of the energy of the memories, in percent; 0 if the board's memories take none.
  double energy_percent(const Step& step) const {
    return now_.memory_mj == 0 ? 0 : 100 * (step.rate.memory_mj / now_.memory_mj - 1);
  }
  // Who stalls for whom, the most cycles first.
  const std::vector<platform::BlameRow>& blames() const { return blames_; }
  // The same, the lanes of a port as one, with the mean of their cycles.
  const std::vector<platform::BlameRow>& group_blames() const { return group_blames_; }

 private:
  // What is known of a whole computer without its simulation.
  struct Proven {
    explore::Range rate;  // in the long run
    double work_pj = 0;   // of the accesses of a frame
    BusiestBank busiest{};
    std::string time{};  // equal for those that do the same at the same time; empty: not known
  };
  template <typename Work, typename Take>
  void for_each(const std::vector<std::size_t>& numbers, const char* done_to_them, ProgressLine& progress,
                const Work& work, const Take& take) const;
  void prove(ProgressLine& progress);
  void simulate(const std::vector<std::size_t>& numbers, PointSimulator& simulator, ProgressLine& progress);
  std::vector<std::size_t> next_boards() const;
  const platform::BoardConfig& board_of(std::size_t number) const;
  Rate rate_of(std::size_t number) const;
  BusiestBank busiest_bank_of(std::size_t number) const;
  double busy_percent(const std::string& resource) const;
  void read_steps();
  void add_resource(const Resource& found);
  void compare_resources(const std::vector<double>& frame_cycles);
  void share_time(std::vector<double> frame_cycles);

  const platform::BoardConfig& board_;
  const platform::Tables& tables_;
  explore::PointRun run_;
  explore::KnobSteps knobs_;
  // What the simulation of a board has given.
  struct Outcome {
    NamedFigures figures;
    std::string failure;  // the reason if it has failed; else empty
  };
  std::vector<std::optional<Outcome>> outcomes_;  // of the board itself, then of the steps
  std::vector<Proven> proven_;                    // as many
  platform::FrameAccesses accesses_;
  std::vector<std::vector<platform::ResourceBound>> bounds_;  // [frame of one turn of the lists]
  NamedFigures figures_;
  Rate now_;
  BusiestBank busiest_;
  std::vector<Step> steps_;
  std::size_t evaluated_ = 0;
  std::size_t shared_ = 0;
  std::vector<Resource> resources_;
  std::map<std::string, double> pair_seconds_;
  platform::RateBound rate_bound_;
  Budget budget_;
  std::vector<platform::BlameRow> blames_;
  std::vector<platform::BlameRow> group_blames_;
};

// The longest wait of a port of the core, at this resource ("bank bank0") or at any bank. Waits of the host
// do not count: they cost the core nothing.
std::optional<platform::BlameRow> longest_wait(const Explanation& explanation,
                                               const std::string& resource = "");

// Why a board is not faster, after "limited by": "the matcher, at its bound of 18.596 frames/s".
std::string limiter_text(const Explanation& explanation);

// What the time of a frame goes to: "96.69 % the matcher and the ports, 3.31 % the core waits for ..".
std::string budget_text(const Explanation& explanation);

// What `explain --json` prints (stats/document_schemas.cpp).
nlohmann::ordered_json explanation_document(const platform::BoardConfig& board,
                                            const Explanation& explanation);

}  // namespace stereotlm::runs
