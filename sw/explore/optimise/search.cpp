#include "sw/explore/optimise/search.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numeric>
#include <queue>
#include <stdexcept>
#include <utility>

#include "models/memory/arbitration_policies.h"
#include "platform/config/board_keys.h"
#include "platform/config/board_reader.h"
#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"
#include "platform/yaml/words.h"
#include "sw/explore/optimise/key_effects.h"
#include "sw/explore/optimise/workers.h"
#include "sw/files/text_forms.h"
#include "sw/stats/figures.h"

namespace stereotlm::explore {
namespace {

using platform::BoardConfig;

constexpr std::size_t kMostGoals = 8;
constexpr const char* kSteady = "frames_per_second.steady";
constexpr const char* kUncertainty = "frames_per_second.steady_uncertainty";
constexpr const char* kExact = "frames_per_second.exact";
constexpr const char* kExactLeast = "frames_per_second.exact_least";
constexpr const char* kExactMost = "frames_per_second.exact_most";
constexpr const char* kLostPixels = "lost_pixels";
constexpr double kNoValue = -1;                   // of an accuracy
constexpr std::size_t kCombinationsOfPiece = 64;  // that are assessed together
constexpr std::size_t kPieces = 128;              // for each process, of a round
constexpr std::size_t kPixels = 2 * 640 * 480;    // the same: of the pictures of its whole computers
constexpr std::size_t kMostLooked = 4096;         // nodes that a round looks at
constexpr std::uint64_t kShortWindow = 30;        // frames of the steady rate of a short run, or a turn more
constexpr std::uint64_t kExactWindow = 4;         // the same, if the rate is proven

using Values = std::array<double, kMostGoals>;  // normalised: larger is better

// A message between processes.
class Bytes {
 public:
  Bytes() = default;
  explicit Bytes(const std::string& text) : text_(text) {}

  template <typename Number>
  void put(Number number) {
    text_.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
  void put_text(const std::string& text) {
    put(text.size());
    text_ += text;
  }
  template <typename Number>
  Number get() {
    Number number;
    std::memcpy(&number, text_.data() + at_, sizeof number);
    at_ += sizeof number;
    return number;
  }
  std::string get_text() {
    const auto size = get<std::size_t>();
    at_ += size;
    return text_.substr(at_ - size, size);
  }
  template <typename Number>
  void put_numbers(const std::vector<Number>& numbers) {
    put(numbers.size());
    for (const Number number : numbers) put(number);
  }
  template <typename Number>
  std::vector<Number> get_numbers() {
    std::vector<Number> numbers(get<std::size_t>());
    for (Number& number : numbers) number = get<Number>();
    return numbers;
  }
  bool at_end() const { return at_ == text_.size(); }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
  std::size_t at_ = 0;
};

[[noreturn]] void throw_no_figure(const std::string& name) {
  throw std::runtime_error(fmt::format("{}: a board of the plan does not have this figure", name));
}

std::string result_key(const std::string& text) {
  return files::sha256_hex(text.data(), text.size()).substr(0, 32);
}

// Whether another placement may not have this problem: a rule between keys, which is checked again for it.
bool is_of_placement(const platform::Diagnostic& problem) {
  return problem.is_between_keys && !problem.is_missing;
}

// Whether a frame of the core leaves nothing behind that the next frame could notice.
bool frames_are_independent(const BoardConfig& board) {
  return memory::find_arbitration_policy(board.fpga.arbiter.policy)->forgets &&
         std::none_of(board.banks.begin(), board.banks.end(), [](const platform::BankConfig& bank) {
           return bank.turnaround_cycles > 0 || bank.sdram;
         });
}

}  // namespace

namespace {

// "; nearest: NAME" for SQLite's message about a name that it does not know.
std::string nearest_name(const std::string& message, const std::set<std::string>& figures) {
  const std::string unknown = "no such column: ";
  if (message.rfind(unknown, 0) != 0) return "";
  const std::string name = message.substr(unknown.size());
  std::vector<std::string> names = stats::figure_names_like(name);
  names.insert(names.end(), figures.begin(), figures.end());
  for (const platform::Key& key : platform::board_keys()) names.push_back(key.path);
  const std::string nearest = platform::nearest_path(name, names);
  return nearest.empty() ? "" : "; nearest: " + nearest;
}

}  // namespace

const std::vector<std::string>& core_figures() {
  static const std::vector<std::string> kNames = {"cycles", "frames_per_second.core",
                                                  "energy.memory_mj_per_frame"};
  return kNames;
}

// A combination of the values of the plan, and what is asked of it again and again.
struct Combination {
  std::uint64_t number = 0;
  Verdict verdict = Verdict::kUnknown;
  std::string reason;  // of kImpossible
  BoardConfig board;
  PointRun run;
  std::shared_ptr<const Placements> placements;
  // Of the boards of a use of banks; made when they are asked for. Those that need a simulation are nullopt.
  struct OfUse {
    BoardConfig board;
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
class Search::Space {
 public:
  // `results`: those of the search.
  Space(const Plan& plan, const SearchWishes& wishes, const BoardModel& model, const Results& results);

  std::size_t goals() const { return goals_.size(); }
  bool is_maximum(std::size_t goal) const { return maxima_[goal]; }
  const std::vector<std::string>& result_names() const { return needed_; }

  Combination& combination(std::uint64_t number);
  Combination& take(std::uint64_t number, BoardConfig board, const PointRun& run,
                    std::vector<std::string> rules, bool places);
  const std::string& requirement(std::size_t number) const { return requirements_[number].text(); }
  // Of a group of placements, without a simulation.
  struct Estimate {
    bool may_meet = true;   // the requirements
    std::size_t unmet = 0;  // the first that no placement meets
    Values best{};
  };
  bool needs_accuracy() const { return !accuracy_.empty(); }
  // The key of a result: boards with the same key have the same accuracy.
  static std::string accuracy_key(const BoardConfig& board);
  // Adds the board of a combination, if it has one.
  void add_board(std::uint64_t number, std::map<std::string, BoardConfig>& by_accuracy_key);
  std::vector<double> accuracy(const BoardConfig& board) const;

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
                                      const BoardConfig& board) const;

 private:
  // Throws std::length_error if there are too many.
  std::shared_ptr<const Placements> placements_of(const BoardConfig& board) const;
  const Combination::OfUse& of_use(Combination& of, std::uint32_t use);
  Combination::OfUse facts_of(const Combination& of, const BoardConfig& board);
  // `most_steady`: of a whole computer, an upper bound of its rate.
  Estimate estimate(const Combination& of, const Combination::OfUse& facts, std::uint64_t least_cycles,
                    bool has_energy, double most_steady);
  // Of a whole computer that loses no pixels.
  Range long_run_rate(Combination& of, std::uint64_t placement, const BoardConfig& placed);
  std::uint64_t least_cycles_of_way(Combination& of, std::uint32_t way, bool waitless_alone);
  std::uint64_t waitless_cycles(Combination& of);

  const Plan& plan_;
  const SearchWishes& wishes_;
  const BoardModel& model_;
  const Results& results_;
  std::vector<Expression> goals_;
  std::vector<bool> maxima_;
  std::vector<Expression> requirements_;
  std::vector<std::string> without_simulation_;  // needed figures that no simulation gives
  std::vector<std::string> needed_;              // figures that only a simulation gives, or those of the core
  std::vector<std::string> accuracy_;            // its figures that are needed
  bool is_judged_ = true;                        // whether the last combination has them
  bool needs_all_ = false;                       // a figure beyond those of the core
  bool needs_steady_alone_ = false;              // the only one of a run is the steady rate
  bool needs_energy_ = false;                    // that of sdram does not follow from the cycles alone
  std::unique_ptr<Conditions> conditions_;
  std::map<std::string, std::shared_ptr<const Placements>> placements_;
  std::unordered_map<std::string, std::uint64_t> cycles_;  // bounds, by their keys
  Combination last_;
};

Search::Space::Space(const Plan& plan, const SearchWishes& wishes, const BoardModel& model,
                     const Results& results)
    : plan_(plan), wishes_(wishes), model_(model), results_(results) {
  std::set<std::string> names;
  const auto& without = figures_without_simulation();
  names.insert(without.begin(), without.end());
  names.insert(core_figures().begin(), core_figures().end());
  std::vector<platform::Diagnostic> problems;
  const auto add = [&](const Condition& text, std::vector<Expression>& to) {
    for (const std::string& name : names_in(text.text)) {
      if (stats::find_figure(name) != nullptr) names.insert(name);
      if (name.rfind(kExact, 0) == 0 && name != kExactLeast)  // and the numbers of the fraction
        problems.push_back(
            {text.place, fmt::format("{}: not every board has a proven rate: give {}, which is "
                                     "the proven rate where there is one",
                                     text.name, kSteady)});
    }
    try {
      to.emplace_back(text, names);
      if (const std::string name = to.back().name_of_bank(); wishes.most_banks > 0 && !name.empty())
        problems.push_back({text.place, fmt::format("{}: {}: names banks, and placements do not tell banks "
                                                    "apart that are alike",
                                                    text.name, name)});
    } catch (const std::invalid_argument& error) {
      const std::string reason = error.what();  // which may name the nearest key
      const std::string own = reason.substr(0, reason.find("; nearest: "));
      const std::string nearest = nearest_name(own, names);
      problems.push_back(
          {text.place, fmt::format("{}: {}", text.name, nearest.empty() ? reason : own + nearest)});
    }
  };
  for (const SearchWishes::Goal& goal : wishes.goals) {
    add(goal.figure, goals_);
    maxima_.push_back(goal.is_maximum);
  }
  for (const Condition& requirement : wishes.requirements) add(requirement, requirements_);
  if (wishes.goals.empty())
    problems.push_back({plan.path(),
                        "no goal: give maximise or minimise, such as maximise: "
                        "frames_per_second.core"});
  if (wishes.goals.size() > kMostGoals)
    problems.push_back({plan.path(), fmt::format("{} goals: at most {}", wishes.goals.size(), kMostGoals)});
  if (!problems.empty()) throw platform::BoardError(problems);
  std::set<std::string> needed;
  for (const auto* const all : {&goals_, &requirements_}) {
    for (const Expression& one : *all) {
      needed.insert(one.figures().begin(), one.figures().end());
    }
  }
  for (const std::string& name : accuracy_figures()) {
    if (needed.count(name) == 0) continue;
    if (!model.accuracy)
      throw platform::BoardError(
          {{plan.path(), fmt::format("{}: of pictures: give {} or {}", name, kPairsPath, kSyntheticPath)}});
    accuracy_.push_back(name);
  }
  for (const std::string& name : without) {
    if (needed.erase(name) > 0) without_simulation_.push_back(name);
  }
  for (const std::string& name : needed)
    needs_all_ = needs_all_ || std::count(core_figures().begin(), core_figures().end(), name) == 0;
  needs_steady_alone_ = needed == std::set<std::string>{kSteady};
  if (needed.count(kSteady) > 0) needed.insert({kUncertainty, kExact, kExactLeast, kExactMost, kLostPixels});
  needed_ = {needed.begin(), needed.end()};
  needs_energy_ = needed.count("energy.memory_mj_per_frame") > 0;
  const std::vector<std::string> varied = plan.varied();
  const bool has_computer =
      plan.run().camera || std::count(varied.begin(), varied.end(), std::string(kSourcePath)) > 0;
  if (needed.count(kSteady) > 0 && !has_computer)
    throw platform::BoardError(
        {{plan.path(), fmt::format("{}: of a whole computer: give {}: camera", kSteady, kSourcePath)}});
}

Combination& Search::Space::combination(std::uint64_t number) {
  if (last_.number == number && last_.placements) return last_;
  Plan::ReadPoint read = plan_.read(number);
  std::vector<std::string> rules;
  for (const platform::Diagnostic& problem : read.reading.problems) {
    if (wishes_.most_banks == 0 || !is_of_placement(problem)) rules.push_back(problem.text);
  }
  return take(number, std::move(read.reading.board), read.run, rules, wishes_.most_banks > 0);
}

std::shared_ptr<const Placements> Search::Space::placements_of(const BoardConfig& board) const try {
  const int most = std::min(wishes_.most_banks, static_cast<int>(board.banks.size()));
  return std::make_shared<Placements>(board, most, wishes_.most_parts);
} catch (const std::length_error& error) {
  throw std::length_error(
      fmt::format("{}: placements: {}: give fewer banks, stripes or buffers", plan_.path(), error.what()));
}

// Makes a combination the last one. `rules`: that its board breaks. `places`: whether its buffers can be
// placed elsewhere.
Combination& Search::Space::take(std::uint64_t number, BoardConfig board, const PointRun& run,
                                 std::vector<std::string> rules, bool places) {
  last_ = {};
  last_.number = number;
  last_.run = run;
  last_.board = std::move(board);
  const auto impossible = [this](const std::string& reason) -> Combination& {
    last_.verdict = Verdict::kImpossible;
    last_.reason = reason;
    return last_;
  };
  if (!rules.empty()) return impossible(fmt::format("{}", fmt::join(rules, "; ")));
  std::shared_ptr<const Placements> all;
  if (places) {
    std::shared_ptr<const Placements>& known = placements_[Placements::key(last_.board)];
    if (!known) known = placements_of(last_.board);
    all = known;
    if (all->size() == 0)
      return impossible(
          fmt::format("no placement of the buffers in at most {} banks has room", wishes_.most_banks));
    last_.board = all->placed(last_.board, 0);
    for (const platform::BrokenRule& rule :
         broken_rules(last_.board, [](const std::string&) { return true; }))
      rules.push_back(rule.text);
  } else {
    all = std::make_shared<Placements>(last_.board);
  }
  if (const auto problem = plan_.tables_problem(last_.board))
    rules.push_back(fmt::format("{}: {}", kCalibrationPath, *problem));
  if (!rules.empty()) return impossible(fmt::format("{}", fmt::join(rules, "; ")));
  for (std::size_t i = 0; i < accuracy_.size() && is_judged_; ++i) {
    const std::string key = accuracy_key(last_.board);
    const auto known = results_.find(key);
    const double value = (known != results_.end() ? known->second : accuracy(last_.board))[i];
    if (value == kNoValue) return impossible(fmt::format("{}: has no value: no pixel counts", accuracy_[i]));
    last_.accuracy.emplace(accuracy_[i], Range::of(value));
  }
  last_.placements = all;
  last_.run.frames = frames_of(last_.run, last_.board);
  last_.turns = last_.run.frames / all->turn();
  const bool has_sdram = std::any_of(last_.board.banks.begin(), last_.board.banks.end(),
                                     [](const auto& bank) { return bank.sdram.has_value(); });
  const auto takes = [](const platform::BankConfig& bank) {
    const memory::BankEnergy its = platform::energy_of(bank);
    return std::pair(its.standby_mw, its.access_pj);
  };
  last_.takes_alike = !has_sdram && std::all_of(last_.board.banks.begin(), last_.board.banks.end(),
                                                [&](const platform::BankConfig& bank) {
                                                  return takes(bank) == takes(last_.board.banks.front());
                                                });
  last_.is_full = last_.run.camera || needs_all_ || (needs_energy_ && has_sdram);
  last_.is_by_ways =
      !last_.is_full && last_.run.frames % all->turn() == 0 && frames_are_independent(last_.board);
  if (plan_.conditions().empty()) return last_;
  if (!conditions_) conditions_ = std::make_unique<Conditions>(plan_.conditions());
  std::vector<platform::BoardValue> values = platform::values_of(last_.board);
  values.push_back({kSourcePath, last_.run.camera ? "camera" : "preloaded"});
  values.push_back({kFramesPath, static_cast<std::int64_t>(last_.run.frames)});
  if (!conditions_->hold(values)) last_.verdict = Verdict::kExcluded;
  return last_;
}

std::string Search::Space::accuracy_key(const BoardConfig& board) {
  std::string text = "accuracy\n";
  for (const platform::Key& key : platform::board_keys()) {
    if (platform::has_value(key) && effects_of_key(key.path).disparities)
      text += platform::value_text(platform::value_of(key, board)) + '\n';
  }
  return result_key(text);
}

void Search::Space::add_board(std::uint64_t number, std::map<std::string, BoardConfig>& by_accuracy_key) {
  is_judged_ = false;
  const Combination& its = combination(number);
  if (its.verdict == Verdict::kUnknown) by_accuracy_key.emplace(accuracy_key(its.board), its.board);
  last_ = {};
  is_judged_ = true;
}

std::vector<double> Search::Space::accuracy(const BoardConfig& board) const {
  const std::map<std::string, double> all = model_.accuracy(board);
  std::vector<double> values;
  for (const std::string& name : accuracy_) values.push_back(all.count(name) > 0 ? all.at(name) : kNoValue);
  return values;
}

std::uint64_t Search::Space::least_cycles_of_way(Combination& of, std::uint32_t way, bool waitless_alone) {
  of.least_cycles_of_way.resize(of.placements->ways());
  std::optional<std::uint64_t>& least = of.least_cycles_of_way[way];
  if (least && !waitless_alone) return *least;
  const BoardConfig one = of.placements->board_of_way(of.board, way);
  const auto known = [this](const std::string& key, const auto& compute) {
    const auto found = cycles_.find(key);
    if (found != cycles_.end()) return found->second;
    return cycles_.emplace(key, compute()).first->second;
  };
  const std::uint64_t waitless =
      known("waitless\n" + waitless_key(one), [&] { return model_.waitless_cycles(one); });
  if (waitless_alone) return waitless;
  least = std::max(waitless,
                   known("contended\n" + core_cycles_key(one), [&] { return model_.contended_cycles(one); }));
  return *least;
}

// Of a frame in any placement.
std::uint64_t Search::Space::waitless_cycles(Combination& of) {
  const auto configs = ssram_configs(of.board);
  const bool is_one = std::all_of(configs.begin(), configs.end(), [&](const auto& bank) {
    return memory::read_latency_cycles(bank) == memory::read_latency_cycles(configs.front());
  });
  std::uint64_t least = UINT64_MAX;
  for (std::uint32_t way = 0; way < (is_one ? 1 : of.placements->ways()); ++way)
    least = std::min(least, least_cycles_of_way(of, way, true));
  return least;
}

std::uint64_t Search::Space::least_cycles(Combination& of, const Placements::Group& group) {
  std::uint64_t sum = 0;
  std::uint64_t least = UINT64_MAX;
  for (const std::uint32_t way : group.ways) {
    const std::uint64_t cycles = least_cycles_of_way(of, way, false);
    sum += cycles;
    least = std::min(least, cycles);
  }
  const std::uint64_t turn = of.placements->turn();
  return sum * of.turns + least * (of.run.frames % turn);
}

Combination::OfUse Search::Space::facts_of(const Combination& of, const BoardConfig& board) {
  Combination::OfUse facts = {board, figures_without_simulation(board), {}, {}};
  facts.figures.insert(of.accuracy.begin(), of.accuracy.end());
  for (const std::string& name : without_simulation_) {
    if (facts.figures.count(name) == 0) throw_no_figure(name);
  }
  const Known known = {facts.board, of.run, facts.figures};
  for (Expression& goal : goals_)
    facts.goals.push_back(goal.is_fixed() ? std::optional(goal.range(known)) : std::nullopt);
  for (Expression& requirement : requirements_)
    facts.requirements.push_back(requirement.is_fixed() ? requirement.holds(known) : std::nullopt);
  return facts;
}

const Combination::OfUse& Search::Space::of_use(Combination& of, std::uint32_t use) {
  of.of_use.resize(of.placements->uses());
  std::unique_ptr<Combination::OfUse>& facts = of.of_use[use];
  if (!facts)
    facts = std::make_unique<Combination::OfUse>(
        facts_of(of, of.placements->placed(of.board, of.placements->first_of_use(use))));
  return *facts;
}

Search::Space::Estimate Search::Space::estimate(const Combination& of, const Combination::OfUse& facts,
                                                std::uint64_t least_cycles, bool has_energy,
                                                double most_steady) {
  const PointRun& run = of.run;
  Known now = {facts.board, run, facts.figures};
  if (!run.camera) {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    for (const auto& [name, value] :
         model_.figures_of_cycles(facts.board, run.frames, least_cycles, needs_energy_ && has_energy))
      now.others[name] = name == "frames_per_second.core" ? Range{0, value} : Range{value, kNone};
  }
  if (run.camera) now.others[kSteady] = {0, most_steady};
  Estimate found;
  for (std::size_t i = 0; i < requirements_.size(); ++i) {
    const auto& fixed = facts.requirements[i];
    if ((fixed ? fixed : requirements_[i].holds(now)) != false) continue;
    found.may_meet = false;
    found.unmet = i;
    return found;
  }
  for (std::size_t goal = 0; goal < goals(); ++goal) {
    const auto& fixed = facts.goals[goal];
    const Range range = fixed ? *fixed : goals_[goal].range(now);
    found.best[goal] = maxima_[goal] ? range.most : -range.least;
  }
  return found;
}

Search::Space::Estimate Search::Space::estimate(Combination& of) {
  Estimate all;
  all.may_meet = false;
  const std::uint64_t least = waitless_cycles(of);
  const double most_steady = of.board.fpga.clock_mhz * 1e6 / static_cast<double>(least);
  for (std::uint32_t use = 0; use < of.placements->uses(); ++use) {
    const Estimate one = estimate(of, of_use(of, use), least * of.run.frames, of.takes_alike, most_steady);
    if (!one.may_meet) continue;
    for (std::size_t goal = 0; goal < goals(); ++goal)
      all.best[goal] = all.may_meet ? std::max(all.best[goal], one.best[goal]) : one.best[goal];
    all.may_meet = true;
  }
  return all;
}

Search::Space::Estimate Search::Space::estimate(Combination& of, const Placements::Group& group,
                                                std::uint64_t placement) {
  const std::uint64_t least = of.run.camera ? 0 : least_cycles(of, group);
  if (!is_alone(of)) return estimate(of, of_use(of, group.use), least, true, 0);
  const Combination::OfUse own = facts_of(of, of.placements->placed(of.board, placement));
  const double most_steady = of.run.camera ? long_run_rate(of, placement, own.board).most : 0;
  return estimate(of, own, least, true, most_steady);
}

Range Search::Space::long_run_rate(Combination& of, std::uint64_t placement, const BoardConfig& placed) {
  if (of.proven && of.proven->first == placement) return of.proven->second;
  std::vector<std::uint64_t> frame_cycles;
  const std::size_t turn = of.placements->turn();
  for (std::size_t frame = 0; frame < turn && frames_are_independent(placed); ++frame) {
    const std::uint32_t way = of.placements->way(placement, frame);
    of.cycles_of_way.resize(of.placements->ways());
    std::optional<std::uint64_t>& cycles = of.cycles_of_way[way];
    if (!cycles) cycles = model_.frame_cycles(of.placements->board_of_way(of.board, way), 1).front();
    frame_cycles.push_back(*cycles);
  }
  if (frame_cycles.empty()) frame_cycles = model_.frame_cycles(placed, turn);
  const Range rate = model_.long_run_rate(placed, frame_cycles);
  of.proven.emplace(placement, rate);
  return rate;
}

std::uint64_t Search::Space::short_frames(Combination& of, std::uint64_t placement) {
  if (!of.run.camera || !needs_steady_alone_) return 0;
  const Range proven = long_run_rate(of, placement, of.placements->placed(of.board, placement));
  const std::uint64_t window = proven.is_exact() ? kExactWindow : kShortWindow;
  const std::uint64_t turn = of.placements->turn();
  const std::uint64_t frames = turn + (window + turn - 1) / turn * turn;
  return 2 * frames <= of.run.frames ? frames : 0;
}

std::vector<std::string> Search::Space::result_keys(Combination& of, const Placements::Group& group,
                                                    std::uint64_t placement, bool is_short) {
  PointRun run = of.run;
  if (is_short) run.frames = short_frames(of, placement);
  if (of.is_full) return {result_key(make_point(0, of.placements->placed(of.board, placement), run).hash)};
  std::vector<std::string> keys;
  if (of.is_by_ways) {
    of.key_of_way.resize(of.placements->ways());
    for (const std::uint32_t way : group.ways) {
      std::string& key = of.key_of_way[way];
      if (key.empty()) key = result_key(core_cycles_key(of.placements->board_of_way(of.board, way)));
      keys.push_back(key);
    }
    return keys;
  }
  return {result_key(fmt::format("{}frames {}", core_cycles_key(of.placements->placed(of.board, placement)),
                                 of.run.frames))};
}

std::vector<double> Search::Space::simulate(Combination& of, const Placements::Group& group,
                                            std::uint64_t placement, std::size_t which, bool is_short) {
  if (of.is_by_ways)
    return {static_cast<double>(
        model_.frame_cycles(of.placements->board_of_way(of.board, group.ways[which]), 1).front())};
  const BoardConfig placed = of.placements->placed(of.board, placement);
  if (!of.is_full) {
    const std::vector<std::uint64_t> cycles = model_.frame_cycles(placed, of.run.frames);
    return {static_cast<double>(std::accumulate(cycles.begin(), cycles.end(), std::uint64_t{0}))};
  }
  PointRun run = of.run;
  if (is_short) run.frames = short_frames(of, placement);
  const Figures figures = model_.simulate(make_point(0, placed, run));
  std::vector<double> values;
  for (const std::string& name : needed_) {
    const auto found = std::find_if(figures.values.begin(), figures.values.end(),
                                    [&name](const auto& value) { return value.path == name; });
    if (found == figures.values.end()) {
      if (name != kUncertainty && name.rfind(kExact, 0) != 0) throw_no_figure(name);
      values.push_back(0);
    } else if (const auto* const integer = std::get_if<std::int64_t>(&found->value)) {
      values.push_back(static_cast<double>(*integer));
    } else if (const auto* const real = std::get_if<double>(&found->value)) {
      values.push_back(*real);
    } else {
      throw std::runtime_error(fmt::format("{}: a text, which is no goal", name));
    }
  }
  return values;
}

std::vector<double> Search::Space::totals(const Combination& of,
                                          const std::vector<std::vector<double>>& results) const {
  if (!of.is_by_ways) return results.front();
  double sum = 0;
  for (const std::vector<double>& frame : results) sum += frame.front();
  return {sum * static_cast<double>(of.turns)};
}

std::map<std::string, double> Search::Space::named(const Combination& of,
                                                   const std::vector<std::vector<double>>& results,
                                                   const BoardConfig& board) const {
  const std::vector<double> all = totals(of, results);
  if (!of.is_full)
    return model_.figures_of_cycles(board, of.run.frames, static_cast<std::uint64_t>(all.front()),
                                    needs_energy_);
  std::map<std::string, double> figures;
  for (std::size_t i = 0; i < needed_.size(); ++i) figures.emplace(needed_[i], all[i]);
  return figures;
}

std::optional<Search::Space::Worth> Search::Space::worth(Combination& of, const Placements::Group& group,
                                                         std::uint64_t placement,
                                                         const std::vector<std::vector<double>>& results,
                                                         bool is_short, const Range& known) {
  std::optional<Combination::OfUse> own;
  if (is_alone(of)) own = facts_of(of, of.placements->placed(of.board, placement));
  const Combination::OfUse& facts = own ? *own : of_use(of, group.use);
  Worth worth;
  Known now = {facts.board, of.run, facts.figures};
  for (const auto& [name, value] : named(of, results, facts.board)) now.others[name] = Range::of(value);
  if (const auto steady = now.others.find(kSteady); steady != now.others.end() && of.run.camera) {
    if (now.range(kLostPixels).least > 0) return std::nullopt;  // the bound is one of whole pictures
    const double rate = steady->second.least;
    const double uncertainty = now.range(kUncertainty).least;
    Range proven = long_run_rate(of, placement, facts.board);
    if (const double most = now.range(kExactMost).least; most > 0) {  // of the frames of the run
      proven.least = std::max(proven.least, now.range(kExactLeast).least);
      proven.most = std::max(proven.least, std::min(proven.most, most));
    }
    const Range its = narrowed(proven, rate, uncertainty);
    const double most = std::min(its.most, known.most);
    worth.steady = steady->second = {std::min(std::max(its.least, known.least), most), most};
    worth.is_known = worth.steady.is_exact();
  }
  for (std::size_t i = 0; i < requirements_.size(); ++i) {
    const auto& fixed = facts.requirements[i];
    const std::optional<bool> holds = fixed ? fixed : requirements_[i].holds(now);
    if (!holds.value_or(is_short)) return std::nullopt;
    worth.is_known = worth.is_known && holds.has_value();
  }
  for (std::size_t goal = 0; goal < goals(); ++goal) {
    const Range range = facts.goals[goal] ? *facts.goals[goal] : goals_[goal].range(now);
    if (!std::isfinite(range.least) || !std::isfinite(range.most)) {
      const std::string& text = goals_[goal].text();
      throw ConditionError(
          fmt::format("{}: the rate of a board lies between {:.3f} and {:.3f} frames/s: the goal must rise "
                      "all the way between them, or fall",
                      text, worth.steady.least, worth.steady.most),
          text);
    }
    worth.goals.push_back(range);
    worth.is_known = worth.is_known && range.is_exact();
  }
  return worth;
}

// A combination, or some of its placements, that are not decided yet.
struct Search::Node {
  static constexpr std::uint32_t kAll = UINT32_MAX;

  Values best{};
  std::uint64_t combination = 0;
  std::uint32_t group = kAll;      // of placements
  std::uint32_t placement = kAll;  // of the group
  std::uint32_t boards = 0;

  // The order of the search: by the goals one after the other.
  friend bool operator<(const Node& a, const Node& b) {
    if (a.best != b.best) return a.best < b.best;
    return std::tie(a.combination, a.group, a.placement) > std::tie(b.combination, b.group, b.placement);
  }
};

struct Search::Heap {
  std::priority_queue<Node> nodes;
};

Search::Search(const Plan& plan, const SearchWishes& wishes, const BoardModel& model, unsigned processes)
    : wishes_(wishes),
      processes_(processes),
      space_(std::make_unique<Space>(plan, wishes_, model, results_)),
      heap_(std::make_unique<Heap>()) {
  if (plan.size() > kMostCombinations)
    throw std::length_error(
        fmt::format("{} combinations of values: at most {}", plan.size(), kMostCombinations));
  verdicts_.resize(plan.size());
  placements_.resize(plan.size());
  bests_.resize(plan.size() * space_->goals());
}

Search::~Search() = default;

std::vector<std::string> Search::result_names() const { return space_->result_names(); }

void Search::know(Results results) { results_ = std::move(results); }

Search::Results Search::take_results() { return std::exchange(new_results_, {}); }

namespace {

double best_of(const Range& range, bool is_maximum) { return is_maximum ? range.most : -range.least; }
double worst_of(const Range& range, bool is_maximum) { return is_maximum ? range.least : -range.most; }

}  // namespace

// Whether a front point is at least as good in all goals, and better in one, whatever the uncertainties.
bool Search::beats(const FrontPoint& point, const double* best) const {
  bool is_better = false;
  for (std::size_t goal = 0; goal < point.values.size(); ++goal) {
    const double its = worst_of(point.values[goal], space_->is_maximum(goal));
    if (its < best[goal]) return false;
    is_better = is_better || its > best[goal];
  }
  return is_better;
}

bool Search::is_dominated(const double* best) const {
  return std::any_of(front_.begin(), front_.end(), [&](const FrontPoint& one) { return beats(one, best); });
}

std::vector<double> Search::bests_of(const std::vector<Range>& values) const {
  std::vector<double> bests;
  for (std::size_t goal = 0; goal < values.size(); ++goal)
    bests.push_back(best_of(values[goal], space_->is_maximum(goal)));
  return bests;
}

// The rate is what both runs leave open. So a board that its short run rules out is ruled out by its own
// run too, and the front does not depend on which boards had a run of their own.
Search::Found Search::find(Combination& its, const Placements::Group& group, std::uint64_t placement,
                           const GetResult& get) {
  std::optional<Space::Worth> of_short;
  if (space_->short_frames(its, placement) > 0) {
    const std::string key = space_->result_keys(its, group, placement, true).front();
    const auto result = get(key, 0, true);
    of_short = space_->worth(its, group, placement, {result}, true);
    if (!of_short) return {"unmet", {}, {}};
    if (is_dominated(bests_of(of_short->goals).data())) return {"bound", of_short->goals, {}};
    if (of_short->is_known) return {"front", of_short->goals, {}};
  }
  Found found;
  for (const std::string& key : space_->result_keys(its, group, placement)) {
    const auto result = get(key, found.results.size(), false);
    if (result.empty()) return {"", of_short->goals, {}};
    found.results.push_back(result);
  }
  const Range steady = of_short ? of_short->steady : Range();
  const auto worth = space_->worth(its, group, placement, found.results, false, steady);
  found.fate = "unmet";
  if (!worth) return found;
  found.values = worth->goals;
  found.fate = is_dominated(bests_of(found.values).data()) ? "dominated" : "front";
  return found;
}

void Search::add_to_front(const std::vector<Range>& values, std::uint64_t combination,
                          const std::vector<std::uint32_t>& placements) {
  if (is_dominated(bests_of(values).data())) return;
  const auto is_same = [&values](const FrontPoint& point) {
    return std::equal(values.begin(), values.end(), point.values.begin(),
                      [](const Range& a, const Range& b) { return a.least == b.least && a.most == b.most; });
  };
  auto point = std::find_if(front_.begin(), front_.end(), is_same);
  if (point == front_.end()) {
    front_.push_back({values, 0, {}});
    const std::vector<FrontPoint> before = front_;
    const auto is_beaten = [&](const FrontPoint& other) {
      return is_dominated(bests_of(other.values).data());
    };
    std::vector<FrontPoint> kept;
    for (const FrontPoint& other : before) {
      if (!is_beaten(other)) kept.push_back(other);
    }
    front_ = std::move(kept);
    std::sort(front_.begin(), front_.end(), [this](const FrontPoint& a, const FrontPoint& b) {
      for (std::size_t goal = 0; goal < a.values.size(); ++goal) {
        const bool is_maximum = space_->is_maximum(goal);
        const std::pair of_a(best_of(a.values[goal], is_maximum), worst_of(a.values[goal], is_maximum));
        const std::pair of_b(best_of(b.values[goal], is_maximum), worst_of(b.values[goal], is_maximum));
        if (of_a != of_b) return of_a > of_b;
      }
      return false;
    });
    point = std::find_if(front_.begin(), front_.end(), is_same);
  }
  point->boards += placements.size();
  for (const std::uint32_t placement : placements) {
    const BoardNumber number = {combination, placement};
    if (point->first.size() == kMostListed && !(number < point->first.back())) continue;
    point->first.insert(std::upper_bound(point->first.begin(), point->first.end(), number), number);
    if (point->first.size() > kMostListed) point->first.pop_back();
  }
}

// Boards that differ in nothing that changes the disparities are computed once.
bool Search::compute_accuracy(const std::function<bool()>& keep_going) {
  std::map<std::string, BoardConfig> boards;  // by the keys of their results
  for (std::uint64_t number = 0; number < verdicts_.size(); ++number) {
    if (number % kCombinationsOfPiece == 0 && !keep_going()) return false;
    space_->add_board(number, boards);
  }
  std::vector<std::pair<std::string, BoardConfig>> left;
  for (auto& one : boards) {
    if (results_.count(one.first) == 0) left.push_back(one);
  }
  const auto work = [&](std::size_t piece) {
    Bytes bytes;
    bytes.put_numbers(space_->accuracy(left[piece].second));
    return bytes.text();
  };
  const auto take = [&](std::size_t piece, const std::string& message) {
    const auto values = Bytes(message).get_numbers<double>();
    results_.emplace(left[piece].first, values);
    new_results_.emplace(left[piece].first, values);
  };
  return do_in_processes(left.size(), processes_, work, take, keep_going);
}

// Finds the verdict and the bounds of each combination.
bool Search::assess(const std::function<bool()>& keep_going) {
  const std::size_t goals = space_->goals();
  const std::size_t pieces = (verdicts_.size() + kCombinationsOfPiece - 1) / kCombinationsOfPiece;
  const auto work = [&](std::size_t piece) {
    Bytes bytes;
    const std::size_t end = std::min(verdicts_.size(), (piece + 1) * kCombinationsOfPiece);
    for (std::size_t number = piece * kCombinationsOfPiece; number < end; ++number) {
      Combination& its = space_->combination(number);
      Verdict verdict = its.verdict;
      Space::Estimate estimate;
      if (verdict == Verdict::kUnknown) {
        estimate = space_->estimate(its);
        if (!estimate.may_meet) verdict = Verdict::kUnmet;
      }
      bytes.put(verdict);
      bytes.put(verdict == Verdict::kImpossible ? std::uint32_t{0}
                                                : static_cast<std::uint32_t>(its.placements->size()));
      for (std::size_t goal = 0; goal < goals; ++goal) bytes.put(estimate.best[goal]);
    }
    return bytes.text();
  };
  const auto take = [&](std::size_t piece, const std::string& message) {
    Bytes bytes(message);
    for (std::size_t number = piece * kCombinationsOfPiece; !bytes.at_end(); ++number) {
      verdicts_[number] = bytes.get<Verdict>();
      placements_[number] = bytes.get<std::uint32_t>();
      Node node;
      node.combination = number;
      for (std::size_t goal = 0; goal < goals; ++goal)
        node.best[goal] = bests_[number * goals + goal] = bytes.get<double>();
      node.boards = placements_[number];
      state_.boards += node.boards;
      if (verdicts_[number] != Verdict::kUnknown) continue;
      heap_->nodes.push(node);
      state_.open += node.boards;
    }
  };
  return do_in_processes(pieces, processes_, work, take, keep_going);
}

// A round: what is best by its bounds is examined, in all processes.
bool Search::step(const std::function<bool()>& keep_going) {
  std::vector<Node> chosen;  // their placements are known before the processes are forked
  std::vector<Node> later;
  std::size_t pixels = 0;  // of the frames of whole computers
  const auto is_worse = [goals = space_->goals()](const Node& a, const Node& b) {
    bool is_better = false;
    for (std::size_t goal = 0; goal < goals; ++goal) {
      if (b.best[goal] < a.best[goal]) return false;
      is_better = is_better || b.best[goal] > a.best[goal];
    }
    return is_better;
  };
  for (std::size_t looked = 0; looked < kMostLooked && !heap_->nodes.empty(); ++looked) {
    if (chosen.size() == kPieces * processes_ || pixels >= kPixels * processes_) break;
    const Node node = heap_->nodes.top();
    heap_->nodes.pop();
    if (is_dominated(node.best.data())) {
      state_.open -= node.boards;
      continue;
    }
    const bool waits =
        std::any_of(chosen.begin(), chosen.end(), [&](const Node& other) { return is_worse(node, other); });
    (waits ? later : chosen).push_back(node);
    if (waits || node.placement == Node::kAll) continue;
    const Combination& its = space_->combination(node.combination);
    if (its.run.camera) pixels += static_cast<std::size_t>(its.board.image.width * its.board.image.height);
  }
  for (const Node& node : later) heap_->nodes.push(node);

  std::vector<bool> is_done(chosen.size());
  const auto put_values = [](Bytes& bytes, const std::vector<Range>& values,
                             const std::vector<std::uint32_t>& placements) {
    bytes.put('v');
    for (const Range& value : values) bytes.put(value);
    bytes.put_numbers(placements);
  };
  // In another process: finds the values of placements, and says the results of simulations.
  const auto examine = [&](Combination& its, const Placements::Group& group, std::uint32_t placement,
                           const std::vector<std::uint32_t>& placements, Bytes& bytes) -> Found {
    bool had_short_run = false;
    const auto get = [&](const std::string& key, std::size_t which, bool is_short) -> std::vector<double> {
      const auto known = results_.find(key);
      if (known != results_.end()) return known->second;
      if (had_short_run && !front_.empty()) return {};  // else there would be no best so far for long
      had_short_run = is_short;
      const auto result = space_->simulate(its, group, placement, which, is_short);
      results_.emplace(key, result);
      const bool is_second = !is_short && space_->short_frames(its, placement) > 0;
      bytes.put(is_second ? 's' : 'r');
      bytes.put_text(key);
      bytes.put_numbers(result);
      return result;
    };
    Found found = find(its, group, placement, get);
    if (found.fate == "front") {
      add_to_front(found.values, its.number, placements);
      put_values(bytes, found.values, placements);
    }
    return found;
  };
  const auto work = [&](std::size_t piece) {
    const Node& node = chosen[piece];
    Bytes bytes;
    Combination& its = space_->combination(node.combination);
    const std::vector<Placements::Group>& groups = its.placements->groups();
    const auto put_group = [&bytes](const Node& one, const std::vector<std::uint32_t>& placements) {
      bytes.put('g');
      bytes.put(one.group);
      bytes.put(one.best);
      bytes.put_numbers(placements);
    };
    if (node.placement != Node::kAll) {
      const Found found = examine(its, groups[node.group], node.placement, {node.placement}, bytes);
      if (!found.fate.empty()) return bytes.text();
      Node again = node;  // its own run comes after those of boards that can be better
      const std::vector<double> bests = bests_of(found.values);
      for (std::size_t goal = 0; goal < bests.size(); ++goal)
        again.best[goal] = std::min(node.best[goal], bests[goal]);
      put_group(again, {node.placement});
      return bytes.text();
    }
    std::vector<Node> nodes;
    const bool is_alone = space_->is_alone(its) && !its.is_by_ways;
    for (std::uint32_t i = 0; i < groups.size(); ++i) {
      const std::vector<std::uint32_t>& all = groups[i].placements;
      for (std::size_t first = 0; first < (is_alone ? all.size() : 1); ++first) {
        Node one = node;
        one.group = i;
        if (is_alone) one.placement = all[first];
        const Space::Estimate estimate = space_->estimate(its, groups[i], all[first]);
        one.best = estimate.best;
        if (estimate.may_meet && !is_dominated(one.best.data())) nodes.push_back(one);
      }
    }
    std::sort(nodes.rbegin(), nodes.rend());
    for (const Node& one : nodes) {
      const Placements::Group& group = groups[one.group];
      if (is_dominated(one.best.data())) continue;
      if (its.is_by_ways) {
        examine(its, group, group.placements.front(), group.placements, bytes);
        continue;
      }
      put_group(one, is_alone ? std::vector{one.placement} : group.placements);
    }
    return bytes.text();
  };
  const auto take = [&](std::size_t piece, const std::string& message) {
    const Node& node = chosen[piece];
    is_done[piece] = true;
    state_.open -= node.boards;
    for (Bytes bytes(message); !bytes.at_end();) {
      const char kind = bytes.get<char>();
      if (kind == 'r' || kind == 's') {
        const std::string key = bytes.get_text();
        const auto result = bytes.get_numbers<double>();
        if (results_.emplace(key, result).second && kind == 'r') ++state_.simulated;
        new_results_.emplace(key, result);
      } else if (kind == 'v') {
        std::vector<Range> values(space_->goals());
        for (Range& value : values) value = bytes.get<Range>();
        add_to_front(values, node.combination, bytes.get_numbers<std::uint32_t>());
      } else {
        Node one = node;
        one.group = bytes.get<std::uint32_t>();
        one.best = bytes.get<Values>();
        one.boards = 1;
        for (const std::uint32_t placement : bytes.get_numbers<std::uint32_t>()) {
          one.placement = placement;
          heap_->nodes.push(one);
          ++state_.open;
        }
      }
    }
  };
  const bool is_whole = do_in_processes(chosen.size(), processes_, work, take, keep_going);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (!is_done[i]) heap_->nodes.push(chosen[i]);
  }
  return is_whole;
}

SearchState Search::state() const {
  SearchState state = state_;
  const bool is_maximum = space_->is_maximum(0);
  state.has_best = !front_.empty();
  if (state.has_best) state.best = best_of(front_.front().values.front(), is_maximum);
  state.bound = heap_->nodes.empty() ? state.best : std::max(heap_->nodes.top().best[0], state.best);
  if (!is_maximum) {
    state.best = -state.best;
    state.bound = -state.bound;
  }
  return state;
}

bool Search::run(const std::function<bool(const SearchState& state)>& keep_going) {
  const auto goes_on = [&] { return keep_going(state()); };
  if (space_->needs_accuracy() && !compute_accuracy(goes_on)) return false;
  if (!assess(goes_on)) return false;
  while (!heap_->nodes.empty()) {
    if (!step(goes_on)) return false;
  }
  return true;
}

Search::Board Search::board(const BoardNumber& number) {
  Combination& its = space_->combination(number.combination);
  if (its.verdict == Verdict::kImpossible) return {std::nullopt, its.run, its.reason};
  return {its.placements->placed(its.board, number.placement), its.run, ""};
}

std::map<std::string, double> Search::results_of(const BoardNumber& number) {
  Combination& its = space_->combination(number.combination);
  const std::vector<Placements::Group>& groups = its.placements->groups();
  const auto group = std::find_if(groups.begin(), groups.end(), [&](const Placements::Group& one) {
    return std::binary_search(one.placements.begin(), one.placements.end(), number.placement);
  });
  std::vector<std::vector<double>> results;
  for (const std::string& key : space_->result_keys(its, *group, number.placement)) {
    const auto known = results_.find(key);
    results.push_back(known != results_.end()
                          ? known->second
                          : space_->simulate(its, *group, number.placement, results.size()));
  }
  return space_->named(its, results, its.placements->placed(its.board, number.placement));
}

Search::Judgement Search::judge(const platform::BoardDraft& draft, const PointRun& run, bool places) {
  platform::BoardDraft::Reading reading = draft.read_with_problems();
  places = places && wishes_.most_banks > 0;
  std::vector<std::string> rules;
  for (const platform::Diagnostic& problem : reading.problems) {
    if (!places || !is_of_placement(problem)) rules.push_back(problem.text);
  }
  const std::vector<bool> used = platform::used_banks(reading.board);
  const auto banks = std::count(used.begin(), used.end(), true);
  if (!places && wishes_.most_banks > 0 && banks > wishes_.most_banks)
    rules.push_back(fmt::format("it uses {} banks, and may use {}", banks, wishes_.most_banks));
  constexpr std::uint64_t kNoNumber = UINT64_MAX;
  Combination& its = space_->take(kNoNumber, std::move(reading.board), run, rules, places);
  Judgement found;
  found.refused = its.verdict == Verdict::kExcluded ? "left out by where" : its.reason;
  if (!found.refused.empty()) return found;
  // The best by the goals one after the other, of those that meet the requirements.
  std::optional<Values> most;
  const auto take = [&](const Values& best, const std::vector<Range>& values, bool is_bound) {
    if (most && best <= *most) return;
    most = best;
    found.values = values;
    found.is_bound = is_bound;
    const auto better = std::find_if(front_.begin(), front_.end(),
                                     [&](const FrontPoint& point) { return beats(point, best.data()); });
    found.dominated_by =
        better == front_.end() ? std::nullopt : std::optional<std::size_t>(better - front_.begin());
  };
  for (const Placements::Group& group : its.placements->groups()) {
    for (const std::uint32_t placement : group.placements) {
      const Space::Estimate estimate = space_->estimate(its, group, placement);
      if (!estimate.may_meet) {
        found.unmet = space_->requirement(estimate.unmet);
      } else if (is_dominated(estimate.best.data())) {
        std::vector<Range> bounds;
        for (std::size_t goal = 0; goal < space_->goals(); ++goal)
          bounds.push_back(Range::of(space_->is_maximum(goal) ? estimate.best[goal] : -estimate.best[goal]));
        take(estimate.best, bounds, true);
      } else {
        const Found its_own =
            find(its, group, placement, [&](const std::string& /*key*/, std::size_t which, bool is_short) {
              return space_->simulate(its, group, placement, which, is_short);
            });
        if (its_own.fate == "unmet") {
          found.unmet = "all requirements, or loses pixels, as its simulation shows";
          continue;
        }
        Values best{};
        const std::vector<double> bests = bests_of(its_own.values);
        std::copy(bests.begin(), bests.end(), best.begin());
        take(best, its_own.values, false);
        if (its_own.fate == "front") return found;
      }
      if (its.is_by_ways) break;
    }
  }
  if (most) found.unmet.clear();
  return found;
}

std::vector<Search::Examined> Search::examined(Combination& its) {
  std::vector<Examined> found;
  std::map<std::tuple<std::string, std::uint32_t, std::vector<double>>, std::size_t>
      known;  // by fate, use, results
  const std::string space = result_key(wishes_.most_banks > 0 ? Placements::key(its.board) : "own");
  const auto examine = [&](const Placements::Group& group, std::uint32_t placement, std::uint32_t number) {
    Examined one = {its.number, space, its.is_by_ways, {number}, "bound", std::nullopt, {}};
    if (!its.run.camera) one.least_cycles = space_->least_cycles(its, group);
    const Space::Estimate estimate = space_->estimate(its, group, placement);
    if (!estimate.may_meet) {
      one.fate = "unmet";
    } else if (!is_dominated(estimate.best.data())) {
      const Found its_own = find(its, group, placement,
                                 [&](const std::string& key, std::size_t, bool) { return results_.at(key); });
      one.fate = its_own.fate;
      if (!its_own.results.empty()) one.results = space_->totals(its, its_own.results);
    }
    const auto [at, is_new] = known.emplace(std::tuple(one.fate, group.use, one.results), found.size());
    if (is_new) return found.push_back(std::move(one));
    Examined& other = found[at->second];
    other.numbers.push_back(number);
    if (other.least_cycles) other.least_cycles = std::min(other.least_cycles, one.least_cycles);
  };
  const std::vector<Placements::Group>& groups = its.placements->groups();
  for (std::uint32_t i = 0; i < groups.size(); ++i) {
    if (its.is_by_ways) {
      examine(groups[i], groups[i].placements.front(), i);
    } else {
      for (const std::uint32_t placement : groups[i].placements) examine(groups[i], placement, placement);
    }
  }
  for (Examined& one : found) std::sort(one.numbers.begin(), one.numbers.end());
  return found;
}

void Search::certify(const Certificate& certificate) {
  const std::size_t goals = space_->goals();
  // The reasons, and the groups, are found in all processes.
  std::vector<std::uint64_t> asked;
  for (std::uint64_t number = 0; number < verdicts_.size(); ++number) {
    Verdict& verdict = verdicts_[number];
    if (verdict == Verdict::kUnknown)
      verdict = is_dominated(&bests_[number * goals]) ? Verdict::kRuledOut : Verdict::kExamined;
    if (verdict == Verdict::kExamined || verdict == Verdict::kImpossible) asked.push_back(number);
  }
  const auto work = [&](std::size_t piece) {
    Bytes bytes;
    const std::size_t end = std::min(asked.size(), (piece + 1) * kCombinationsOfPiece);
    for (std::size_t i = piece * kCombinationsOfPiece; i < end; ++i) {
      Combination& its = space_->combination(asked[i]);
      bytes.put_text(its.reason);
      const std::vector<Examined> all =
          its.verdict == Verdict::kImpossible ? std::vector<Examined>() : examined(its);
      bytes.put(all.size());
      for (const Examined& one : all) {
        bytes.put_text(one.space);
        bytes.put(one.are_groups);
        bytes.put_numbers(one.numbers);
        bytes.put_text(one.fate);
        bytes.put(one.least_cycles);
        bytes.put_numbers(one.results);
      }
    }
    return bytes.text();
  };
  std::map<std::size_t, std::string> waiting;  // for the pieces before them
  std::size_t next_piece = 0;
  std::uint64_t next = 0;  // combination
  std::set<std::string> spaces;
  std::optional<Part> open;
  const auto add = [&](Verdict verdict, const std::string& reason) {
    if (open && open->verdict == verdict && open->reason == reason) {
      open->last = next;
    } else {
      if (open) certificate.part(*open);
      open = Part{next, next, verdict, reason};
    }
    ++next;
  };
  const auto take = [&](std::size_t piece, const std::string& message) {
    waiting.emplace(piece, message);
    for (; !waiting.empty() && waiting.begin()->first == next_piece; waiting.erase(waiting.begin())) {
      Bytes bytes(waiting.begin()->second);
      for (std::size_t i = next_piece * kCombinationsOfPiece; !bytes.at_end(); ++i) {
        while (next < asked[i]) add(verdicts_[next], "");
        add(verdicts_[asked[i]], bytes.get_text());
        for (auto left = bytes.get<std::size_t>(); left > 0; --left) {
          Examined one;
          one.combination = asked[i];
          one.space = bytes.get_text();
          one.are_groups = bytes.get<bool>();
          one.numbers = bytes.get_numbers<std::uint32_t>();
          one.fate = bytes.get_text();
          one.least_cycles = bytes.get<std::optional<std::uint64_t>>();
          one.results = bytes.get_numbers<double>();
          if (spaces.insert(one.space).second && wishes_.most_banks > 0)
            certificate.space(one.space, *space_->combination(asked[i]).placements);
          certificate.examined(one);
        }
      }
      ++next_piece;
    }
  };
  const std::size_t pieces = (asked.size() + kCombinationsOfPiece - 1) / kCombinationsOfPiece;
  do_in_processes(pieces, processes_, work, take, [] { return true; });
  while (next < verdicts_.size()) add(verdicts_[next], "");
  if (open) certificate.part(*open);
}

}  // namespace stereotlm::explore
