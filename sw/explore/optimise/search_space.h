#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "sw/explore/optimise/figure_range.h"
#include "sw/explore/optimise/placements.h"
#include "sw/explore/plan/plan.h"
#include "sw/explore/store/store.h"

namespace stereotlm::explore {

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

// What is known about a combination of the values of the plan.
enum class Verdict : std::uint8_t {
  kUnknown,
  kImpossible,  // no board: it breaks a rule, or no placement fits
  kExcluded,    // by `where`
  kUnmet,       // no placement can meet the requirements
  kRuledOut,    // even with its bounds a front point is at least as good in all goals, and better in one
  kExamined,    // by its placements
};

// The most goals of a search.
inline constexpr std::size_t kMostGoals = 8;
using GoalValues = std::array<double, kMostGoals>;  // [goal], larger is better

// The results of simulations, by their keys.
using SearchResults = std::unordered_map<std::string, std::vector<double>>;

// 32 digits for a text.
std::string short_hash(const std::string& text);

// Whether another placement may not have this problem: a rule between keys, which is checked again for it.
bool is_of_placement(const platform::Diagnostic& problem);

// A combination of the values of the plan, and what is asked of it again and again.
struct Combination {
  std::uint64_t number = 0;
  Verdict verdict = Verdict::kUnknown;
  std::string reason;  // of kImpossible
  platform::BoardConfig board;
  PointRun run;
  std::shared_ptr<const Placements> placements;
  // Of the boards of a use of banks; made when they are asked for. Those that need a simulation are nullopt.
  struct OfUse {
    platform::BoardConfig board;
    FigureRanges figures;
    std::vector<std::optional<Range>> goals;
    std::vector<std::optional<bool>> requirements;
  };
  std::vector<std::unique_ptr<OfUse>> of_use;
  FigureRanges accuracy;
  std::vector<std::optional<std::uint64_t>> least_cycles_of_way;
  std::vector<std::string> key_of_way;
  std::vector<std::optional<std::uint64_t>> cycles_of_way;
  std::optional<std::pair<std::uint64_t, Range>> proven;  // the placement asked last, its rate for long

  bool takes_alike = false;  // all banks take the same for an access
  bool is_full = false;      // figures beyond the cycles of the core are needed
  bool is_by_ways = false;   // a frame for each way is all that is simulated
  std::uint64_t turns = 1;   // of the lists, in the frames of a run
};

// Evaluates boards of the space. Each process has its own copy.
class SearchSpace {
 public:
  // `results`: those of the search.
  SearchSpace(const Plan& plan, const SearchWishes& wishes, const BoardModel& model,
              const SearchResults& results);

  std::size_t goals() const { return goals_.size(); }
  bool is_maximum(std::size_t goal) const { return maxima_[goal]; }
  const std::vector<std::string>& result_names() const { return needed_; }

  Combination& combination(std::uint64_t number);
  Combination& take(std::uint64_t number, platform::BoardConfig board, const PointRun& run,
                    std::vector<std::string> rules, bool places);
  const std::string& requirement(std::size_t number) const { return requirements_[number].text(); }
  // What the last board for which worth() has returned nullopt does not meet.
  const std::string& unmet() const { return unmet_; }
  // Of a group of placements, without a simulation.
  struct Estimate {
    bool may_meet = true;   // the requirements
    std::size_t unmet = 0;  // the first that no placement meets
    GoalValues best{};
  };
  bool needs_accuracy() const { return !accuracy_.empty(); }
  // The key of a result: boards with the same key have the same accuracy.
  static std::string accuracy_key(const platform::BoardConfig& board);
  // Adds the board of a combination, if it has one.
  void add_board(std::uint64_t number, std::map<std::string, platform::BoardConfig>& by_accuracy_key);
  std::vector<double> accuracy(const platform::BoardConfig& board) const;

  // Whether placements of one group can have other estimates.
  bool is_alone(const Combination& of) const { return of.is_full || (needs_energy_ && !of.takes_alike); }
  // The best of all placements of a combination.
  Estimate estimate(Combination& of);
  Estimate estimate(Combination& of, const Placements::Group& group, std::uint64_t placement);
  std::uint64_t least_cycles(Combination& of, const Placements::Group& group);

  // The frames of a run of a whole computer that may rule it out before its own run, which has at least
  // twice as many; 0: there is none.
  std::uint64_t short_frames(Combination& of, std::uint64_t placement);
  // The keys of the results that a group, or one of its placements, needs. `is_short`: of the short run.
  std::vector<std::string> result_keys(Combination& of, const Placements::Group& group,
                                       std::uint64_t placement, bool is_short = false);
  std::vector<double> simulate(Combination& of, const Placements::Group& group, std::uint64_t placement,
                               std::size_t which, bool is_short = false);
  struct Worth {
    std::vector<Range> goals;
    Range steady = {};     // of a whole computer
    bool is_known = true;  // the rate exactly, each goal, and that the requirements are met
  };
  // nullopt if the board does not meet the requirements, or, `is_short`, cannot. `results`: of each of the
  // keys. `steady`: what else is known of the rate. Throws ConditionError if a goal can have any value.
  std::optional<Worth> worth(Combination& of, const Placements::Group& group, std::uint64_t placement,
                             const std::vector<std::vector<double>>& results, bool is_short,
                             const Range& steady = {});
  std::vector<double> totals(const Combination& of, const std::vector<std::vector<double>>& results) const;
  // Of BoardModel::figures_of_cycles, or of result_names().
  std::map<std::string, double> named(const Combination& of, const std::vector<std::vector<double>>& results,
                                      const platform::BoardConfig& board) const;

 private:
  // Throws std::length_error if there are too many.
  std::shared_ptr<const Placements> placements_of(const platform::BoardConfig& board) const;
  const Combination::OfUse& of_use(Combination& of, std::uint32_t use);
  Combination::OfUse facts_of(const Combination& of, const platform::BoardConfig& board);
  // `most_steady`: of a whole computer, an upper bound of its rate.
  Estimate estimate(const Combination& of, const Combination::OfUse& facts, std::uint64_t least_cycles,
                    bool has_energy, double most_steady);
  // Of a whole computer that loses no pixels.
  Range long_run_rate(Combination& of, std::uint64_t placement, const platform::BoardConfig& placed);
  std::uint64_t least_cycles_of_way(Combination& of, std::uint32_t way, bool waitless_alone);
  std::uint64_t waitless_cycles(Combination& of);

  const Plan& plan_;
  const SearchWishes& wishes_;
  const BoardModel& model_;
  const SearchResults& results_;
  std::vector<Expression> goals_;
  std::vector<bool> maxima_;
  std::vector<Expression> requirements_;
  std::vector<std::string> without_simulation_;  // needed figures that no simulation gives
  std::vector<std::string> needed_;              // figures that only a simulation gives, or those of the core
  std::vector<std::string> accuracy_;            // its figures that are needed
  bool is_judged_ = true;                        // whether the last combination has them
  bool needs_all_ = false;                       // a figure beyond those of the core
  bool needs_whole_pictures_ = false;            // a computer that loses pixels does not count
  bool needs_steady_alone_ = false;              // the only one of a run is the steady rate
  bool needs_energy_ = false;                    // that of sdram does not follow from the cycles alone
  std::string unmet_;
  std::unique_ptr<Conditions> conditions_;
  std::map<std::string, std::shared_ptr<const Placements>> placements_;
  std::unordered_map<std::string, std::uint64_t> cycles_;  // bounds, by their keys
  Combination last_;
};

}  // namespace stereotlm::explore
