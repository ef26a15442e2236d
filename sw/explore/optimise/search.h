#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <queue>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "sw/explore/optimise/front.h"
#include "sw/explore/optimise/message.h"
#include "sw/explore/optimise/placements.h"
#include "sw/explore/optimise/search_space.h"
#include "sw/explore/plan/plan.h"

namespace stereotlm::explore {

struct SearchState {
  std::uint64_t boards = 0;     // that `where` leaves, as far as counted
  bool is_counted = false;      // all of them
  std::uint64_t open = 0;       // not decided yet, at most
  std::uint64_t simulated = 0;  // runs
  double best = 0;              // of the first goal: the most that a board is certain to have, or the least
  double bound = 0;             // of the first goal: the most that a board can have, or the least
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
  Search(const Search&) = delete;
  Search& operator=(const Search&) = delete;

  // Results of earlier runs of the same search: they need not be simulated again.
  void know(SearchResults results) { results_ = std::move(results); }
  // Those found since the last call.
  SearchResults take_results() { return std::exchange(new_results_, {}); }
  // The front of a search that has ended before.
  void set_front(std::vector<FrontPoint> front) { front_.set_points(std::move(front)); }

  // `keep_going` is called several times a second; false ends the search, and run() returns false.
  bool run(const std::function<bool(const SearchState& state)>& keep_going);

  // The front so far, sorted by the values: the best of the first goal first, and so on.
  const std::vector<FrontPoint>& front() const { return front_.points(); }
  const SearchWishes& wishes() const { return wishes_; }
  SearchState state() const;
  std::uint64_t combinations() const { return verdicts_.size(); }
  // How many combinations are no board, and the first of them, as far as is known.
  struct Impossible {
    std::uint64_t count = 0;
    std::uint64_t first = 0;
  };
  Impossible impossible() const;
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
  const std::vector<std::string>& result_names() const { return space_.result_names(); }

 private:
  static constexpr std::size_t kCombinationsOfPiece = 64;  // that a process assesses together

  // A combination, or some of its placements, that are not decided yet.
  struct Node {
    static constexpr std::uint32_t kAll = UINT32_MAX;

    GoalValues best{};
    std::uint64_t combination = 0;
    std::uint32_t group = kAll;      // of placements
    std::uint32_t placement = kAll;  // of the group
    std::uint32_t boards = 0;

    // Says that these placements of its group are nodes like it.
    void put(const std::vector<std::uint32_t>& placements, Message& message) const;
    // The order of the search: by the goals one after the other.
    friend bool operator<(const Node& a, const Node& b) {
      if (a.best != b.best) return a.best < b.best;
      return std::tie(a.combination, a.group, a.placement) > std::tie(b.combination, b.group, b.placement);
    }
  };
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

  // The parts of run(). They return false if `keep_going` has.
  bool compute_accuracy(const std::function<bool()>& keep_going);
  bool assess(const std::function<bool()>& keep_going);
  bool do_round(const std::function<bool()>& keep_going);
  std::vector<Node> choose();
  std::string work_on(const Node& node);
  void examine(Combination& its, const Placements::Group& group, const Node& node,
               const std::vector<std::uint32_t>& placements, Message& message);
  void take(const Node& node, Message message);
  std::vector<Examined> examined(Combination& its);

  SearchWishes wishes_;
  unsigned processes_;
  SearchResults results_;
  SearchResults new_results_;
  SearchSpace space_;
  std::priority_queue<Node> nodes_;
  std::vector<Verdict> verdicts_;          // [combination]
  std::vector<double> bests_;              // [combination][goal]: of an open one, the best that it can be
  std::vector<std::uint32_t> placements_;  // [combination]
  Front front_;
  SearchState state_;
};

}  // namespace stereotlm::explore
