#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "sw/explore/optimise/figure_range.h"
#include "sw/explore/optimise/placements.h"
#include "sw/explore/plan/plan.h"
#include "sw/explore/store/store.h"

namespace stereotlm::explore {

struct Combination;

// How the boards of a search are evaluated. The cycles of a frame include the pipeline latency.
struct BoardModel {
  // A lower bound for the cycles of frame 0 of the core in every placement whose buffers have the read
  // latencies that they have here.
  std::function<std::uint64_t(const platform::BoardConfig& board)> waitless_cycles;
  // A lower bound for the cycles of frame 0 of the core, with what its ports need of the banks that they
  // share.
  std::function<std::uint64_t(const platform::BoardConfig& board)> contended_cycles;
  // The cycles of each of frames 0..frames-1 of the core alone.
  std::function<std::vector<std::uint64_t>(const platform::BoardConfig& board, std::uint64_t frames)>
      frame_cycles;
  // What follows from the board and its cycles: the figures of core_figures(), the energy only with
  // `has_energy`. More cycles give a lower rate and more energy.
  std::function<std::map<std::string, double>(const platform::BoardConfig& board, std::uint64_t frames,
                                              std::uint64_t cycles, bool has_energy)>
      figures_of_cycles;
  // What is proven of the rate of a whole computer in the long run, if it loses no pixels. `frame_cycles`: of
  // a turn of the lists of the core alone.
  std::function<Range(const platform::BoardConfig& board, const std::vector<std::uint64_t>& frame_cycles)>
      long_run_rate;
  // All figures of a point.
  std::function<Figures(const Point& point)> simulate;
  // The accuracy_figures() over the pictures of the plan; a figure without a value is missing. Null if the
  // plan has no pictures.
  std::function<std::map<std::string, double>(const platform::BoardConfig& board)> accuracy = nullptr;
};

// The figures of BoardModel::figures_of_cycles.
const std::vector<std::string>& core_figures();

// A board of the space.
struct BoardNumber {
  std::uint64_t combination = 0;  // of the values of the plan
  std::uint32_t placement = 0;

  friend bool operator<(const BoardNumber& a, const BoardNumber& b) {
    return a.combination != b.combination ? a.combination < b.combination : a.placement < b.placement;
  }
};

// Boards of a front with the same values.
struct FrontPoint {
  std::vector<Range> values;  // [goal]; a value that is not exact is a rate with its uncertainty
  std::uint64_t boards = 0;
  std::vector<BoardNumber> first;  // at most kMostListed, in their order
};
inline constexpr std::size_t kMostListed = 100;

// What is known about a combination of the values of the plan.
enum class Verdict : std::uint8_t {
  kUnknown,
  kImpossible,  // no board: it breaks a rule, or no placement fits
  kExcluded,    // by `where`
  kUnmet,       // no placement can meet the requirements
  kRuledOut,    // even with its bounds a front point is at least as good in all goals, and better in one
  kExamined,    // by its placements
};

struct SearchState {
  std::uint64_t boards = 0;     // of the space
  std::uint64_t open = 0;       // not decided yet, at most
  std::uint64_t simulated = 0;  // runs
  double best = 0;              // of the first goal
  double bound = 0;             // of the first goal: of the open boards and the best
  bool has_best = false;
};

// Finds all boards of a plan that are on the front of its goals: no other board is at least as good in all
// goals and better in one. With one goal these are the boards that tie for the best.
//
// The search goes through the combinations in the order of their bounds, the best first. One whose bound
// shows that a board of the front is better is ruled out with all of its placements. Else its placements are
// ruled out by their own bounds, or simulated. What is found does not depend on the order.
class Search {
 public:
  static constexpr std::uint64_t kMostCombinations = std::uint64_t{1} << 24U;

  // Throws platform::BoardError if a goal or a requirement is wrong, and std::length_error if there are too
  // many combinations or placements. `plan` and `model` outlive the search.
  Search(const Plan& plan, const SearchWishes& wishes, const BoardModel& model, unsigned processes);
  ~Search();
  Search(const Search&) = delete;
  Search& operator=(const Search&) = delete;

  // Results of earlier runs of the same search: they need not be simulated again.
  using Results = std::unordered_map<std::string, std::vector<double>>;
  void know(Results results);
  // Those found since the last call.
  Results take_results();
  // The front of a search that has ended before.
  void set_front(std::vector<FrontPoint> front) { front_ = std::move(front); }

  // `keep_going` is called several times a second; false ends the search, and run() returns false.
  bool run(const std::function<bool(const SearchState& state)>& keep_going);

  // The front so far, sorted by the values: the best of the first goal first, and so on.
  const std::vector<FrontPoint>& front() const { return front_; }
  const SearchWishes& wishes() const { return wishes_; }
  SearchState state() const;
  std::uint64_t combinations() const { return verdicts_.size(); }
  // The board with this number; the reason if there is none.
  struct Board {
    std::optional<platform::BoardConfig> board;
    PointRun run;
    std::string reason;
  };
  Board board(const BoardNumber& number);
  // The results of the simulation of a board, by the names of result_names() or of core_figures(). Simulates
  // it if that is not known.
  std::map<std::string, double> results_of(const BoardNumber& number);

  // Why a board is not on the front.
  struct Judgement {
    std::string refused;                      // why it is no board of the space; else empty
    std::string unmet;                        // the requirement that it does not meet; else empty
    std::vector<Range> values;                // [goal]
    bool is_bound = false;                    // the values are those of its bounds, not simulated
    std::optional<std::size_t> dominated_by;  // a front point; nullopt: it is on the front
  };
  // `places`: the best of its placements counts, if the search places buffers; else its own.
  Judgement judge(const platform::BoardDraft& draft, const PointRun& run, bool places);

  // What a search that has ended proves, in an order and with contents that depend on the space alone.
  struct Part {
    std::uint64_t first = 0;  // combinations
    std::uint64_t last = 0;
    Verdict verdict = Verdict::kUnknown;
    std::string reason;  // of kImpossible
  };
  // Placements of a combination with the same fate.
  struct Examined {
    std::uint64_t combination = 0;
    std::string space;        // which Placements: the same text for the same
    bool are_groups = false;  // the numbers are those of Placements::groups(), else of placements
    std::vector<std::uint32_t> numbers;
    std::string fate;                           // unmet, bound, dominated, front
    std::optional<std::uint64_t> least_cycles;  // of the core, the least of their bounds
    std::vector<double> results;                // of the simulation of each: cycles, or result_names()
  };
  // Receives the parts in order, the placements that the examined combinations have, and their fates.
  struct Certificate {
    std::function<void(const Part&)> part;
    std::function<void(const std::string& space, const Placements& placements)> space;
    std::function<void(const Examined&)> examined;
  };
  void certify(const Certificate& certificate);
  // The figures of Examined::results, of runs that are needed for more than the cycles of the core.
  std::vector<std::string> result_names() const;

 private:
  class Space;
  struct Node;
  struct Heap;

  // What is found of a placement that its bounds do not rule out.
  struct Found {
    std::string fate;                          // unmet, bound, dominated, front; empty: a result is missing
    std::vector<Range> values;                 // [goal]; without meaning if unmet
    std::vector<std::vector<double>> results;  // of its own run; empty if its short run is enough
  };
  // Gives the result of a key, the one with number `which` of the placement; empty if it is not known yet.
  using GetResult =
      std::function<std::vector<double>(const std::string& key, std::size_t which, bool is_short)>;
  Found find(Combination& its, const Placements::Group& group, std::uint64_t placement, const GetResult& get);
  bool compute_accuracy(const std::function<bool()>& keep_going);
  bool assess(const std::function<bool()>& keep_going);
  bool step(const std::function<bool()>& keep_going);
  void add_to_front(const std::vector<Range>& values, std::uint64_t combination,
                    const std::vector<std::uint32_t>& placements);
  std::vector<Examined> examined(Combination& its);
  std::vector<double> bests_of(const std::vector<Range>& values) const;
  bool beats(const FrontPoint& point, const double* best) const;
  bool is_dominated(const double* best) const;

  SearchWishes wishes_;
  unsigned processes_;
  std::unique_ptr<Space> space_;
  std::unique_ptr<Heap> heap_;
  std::vector<Verdict> verdicts_;          // [combination]
  std::vector<double> bests_;              // [combination][goal]: of an open one, the best that it can be
  std::vector<std::uint32_t> placements_;  // [combination]
  std::vector<FrontPoint> front_;
  Results results_;
  Results new_results_;
  SearchState state_;
};

}  // namespace stereotlm::explore
