#include "sw/explore/optimise/search_space.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <stdexcept>

#include "models/memory/arbitration_policies.h"
#include "platform/config/board_keys.h"
#include "platform/config/board_reader.h"
#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"
#include "platform/yaml/words.h"
#include "sw/explore/optimise/key_effects.h"
#include "sw/files/text_forms.h"
#include "sw/stats/figures.h"

namespace stereotlm::explore {
namespace {

using platform::BoardConfig;

constexpr const char* kSteady = "frames_per_second.steady";
constexpr const char* kUncertainty = "frames_per_second.steady_uncertainty";
constexpr const char* kExact = "frames_per_second.exact";
constexpr const char* kExactLeast = "frames_per_second.exact_least";
constexpr const char* kExactMost = "frames_per_second.exact_most";
constexpr const char* kLostPixels = "lost_pixels";
constexpr double kNoValue = -1;             // of an accuracy
constexpr std::uint64_t kShortWindow = 30;  // frames of the steady rate of a short run, or a turn more
constexpr std::uint64_t kExactWindow = 4;   // the same, if the rate is proven

// `figures`: those of the board.
[[noreturn]] void throw_no_figure(const std::string& name, const std::vector<std::string>& figures) {
  const std::string nearest = platform::nearest_path(name, figures);
  throw std::runtime_error(fmt::format("{}: a board of the plan does not have this figure{}{}", name,
                                       nearest.empty() ? "" : "; nearest: ", nearest));
}

// Whether a frame of the core leaves nothing behind that the next frame could notice.
bool frames_are_independent(const BoardConfig& board) {
  return memory::find_arbitration_policy(board.fpga.arbiter.policy)->forgets &&
         std::none_of(board.banks.begin(), board.banks.end(), [](const platform::BankConfig& bank) {
           return bank.turnaround_cycles > 0 || bank.sdram;
         });
}

// What to do about a name that SQLite does not know: "; nearest: NAME".
std::string nearest_name(const std::string& message, const std::set<std::string>& figures) {
  const std::string unknown = "no such column: ";
  if (message.rfind(unknown, 0) != 0) return "";
  const std::string name = message.substr(unknown.size());
  if (const std::string remark = no_value_remark(name); !remark.empty()) return remark;
  if (figures.count(name) > 0 || stats::find_figure(name) != nullptr || platform::find_key(name) != nullptr)
    return "; write it without quotes";
  std::vector<std::string> names = stats::figure_names_like(name);
  names.insert(names.end(), figures.begin(), figures.end());
  for (const platform::Key& key : platform::board_keys()) names.push_back(key.path);
  const auto is_form = [](const std::string& one) { return one.find("NAME") != std::string::npos; };
  names.erase(std::remove_if(names.begin(), names.end(), is_form), names.end());
  const std::string nearest = platform::nearest_path(name, names);
  return nearest.empty() ? "; stereotlm keys, and keys --figures, list the names" : "; nearest: " + nearest;
}

}  // namespace

std::string short_hash(const std::string& text) {
  return files::sha256_hex(text.data(), text.size()).substr(0, 32);
}

bool is_of_placement(const platform::Diagnostic& problem) {
  return problem.is_between_keys && !problem.is_missing;
}

const std::vector<std::string>& core_figures() {
  static const std::vector<std::string> kNames = {"cycles", "frames_per_second.core",
                                                  "energy.memory_mj_per_frame"};
  return kNames;
}

SearchSpace::SearchSpace(const Plan& plan, const SearchWishes& wishes, const BoardModel& model,
                         const SearchResults& results)
    : plan_(plan), wishes_(wishes), model_(model), results_(results) {
  std::set<std::string> names;
  const auto& without = figures_without_simulation();
  names.insert(without.begin(), without.end());
  names.insert(core_figures().begin(), core_figures().end());
  std::vector<platform::Diagnostic> problems;
  const auto add = [&](const Condition& text, std::vector<Expression>& to) {
    for (const std::string& name : names_in(text.text)) {
      const stats::Figure* const figure = stats::find_figure(name);
      if (figure != nullptr) names.insert(name);
      if (figure != nullptr && figure->is_text)
        problems.push_back({text.place, fmt::format("{}: {} is a text: goals and conditions take numbers",
                                                    text.name, name)});
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
      const std::string own = reason.substr(0, reason.find("; "));
      const std::string nearest = nearest_name(own, names);
      problems.push_back(
          {text.place, fmt::format("{}: {}", text.name, nearest.empty() ? reason : own + nearest)});
    }
  };
  for (const SearchWishes::Goal& goal : wishes.goals) {
    add(goal.figure, goals_);
    maxima_.push_back(goal.is_maximum);
  }
  for (const Condition& requirement : wishes.requirements) {
    add(requirement, requirements_);
    const std::vector<std::string> all = names_in(requirement.text);
    const bool is_one =
        all.size() == 1 && requirement.text.find_first_not_of(all.front() + " ()") == std::string::npos;
    if (is_one && (names.count(all.front()) > 0 || platform::find_key(all.front()) != nullptr))
      problems.push_back(
          {requirement.place, fmt::format("{}: no condition: compare it with a number", requirement.name)});
  }
  if (wishes.goals.empty())
    problems.push_back({plan.path(),
                        "no goal: give maximise or minimise, such as maximise: "
                        "frames_per_second.core, or the option --maximise"});
  if (wishes.goals.size() > kMostGoals)
    problems.push_back({plan.path(), fmt::format("{} goals: at most {}", wishes.goals.size(), kMostGoals)});
  if (wishes.most_banks > 0) {
    for (const Condition& condition : plan.conditions()) {
      if (const std::string name = explore::name_of_bank(condition.text); !name.empty())
        problems.push_back(
            {condition.place, fmt::format("{}: {}: names banks, and placements put buffers in all of them",
                                          condition.name, name)});
    }
    if (const std::string path = plan.varied_banks(); !path.empty())
      problems.push_back({plan.path(), path + ": its values differ in banks alone, and placements put "
                                              "buffers in all of them"});
  }
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
  const std::vector<std::string> varied = plan.varied();
  const bool has_computer =
      plan.run().camera || std::count(varied.begin(), varied.end(), std::string(kSourcePath)) > 0;
  const bool asks_for_losses = std::any_of(needed.begin(), needed.end(), [](const std::string& name) {
    return name == kLostPixels || name.find("dropped_pixels") != std::string::npos;
  });
  needs_whole_pictures_ = has_computer && (needed.count(kSteady) > 0 || !asks_for_losses);
  if (needed.count(kSteady) > 0) needed.insert({kUncertainty, kExact, kExactLeast, kExactMost});
  if (needs_whole_pictures_) needed.insert(kLostPixels);
  needed_ = {needed.begin(), needed.end()};
  needs_energy_ = needed.count("energy.memory_mj_per_frame") > 0;
  if (needed.count(kSteady) > 0 && !has_computer)
    throw platform::BoardError(
        {{plan.path(), fmt::format("{}: of a whole computer: give {}: camera", kSteady, kSourcePath)}});
  if (needs_energy_ && has_computer && plan.run().frames == 0 &&
      std::count(varied.begin(), varied.end(), std::string(kFramesPath)) == 0)
    throw platform::BoardError(
        {{plan.path(),
          fmt::format("energy.memory_mj_per_frame: counts the start of a run of a whole computer, "
                      "so all boards must run equally long: give {}, such as 120",
                      kFramesPath)}});
}

Combination& SearchSpace::combination(std::uint64_t number) {
  if (last_.number == number && last_.placements) return last_;
  Plan::ReadPoint read = plan_.read(number);
  std::vector<std::string> rules;
  for (const platform::Diagnostic& problem : read.reading.problems) {
    if (wishes_.most_banks == 0 || !is_of_placement(problem)) rules.push_back(problem.text);
  }
  return take(number, std::move(read.reading.board), read.run, rules, wishes_.most_banks > 0);
}

std::shared_ptr<const Placements> SearchSpace::placements_of(const BoardConfig& board) const try {
  const int most = std::min(wishes_.most_banks, static_cast<int>(board.banks.size()));
  return std::make_shared<Placements>(board, most, wishes_.most_parts);
} catch (const std::length_error& error) {
  throw std::length_error(
      fmt::format("{}: placements: {}: give fewer banks, stripes or buffers", plan_.path(), error.what()));
}

// Makes a combination the last one. `rules`: that its board breaks. `places`: whether its buffers can be
// placed elsewhere.
Combination& SearchSpace::take(std::uint64_t number, BoardConfig board, const PointRun& run,
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
  if (const auto problem = plan_.pairs_problem(last_.board))
    rules.push_back(fmt::format("{}: {}", kPairsPath, *problem));
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

std::string SearchSpace::accuracy_key(const BoardConfig& board) {
  std::string text = "accuracy\n";
  for (const platform::Key& key : platform::board_keys()) {
    if (platform::has_value(key) && effects_of_key(key.path).disparities)
      text += platform::value_text(platform::value_of(key, board)) + '\n';
  }
  return short_hash(text);
}

void SearchSpace::add_board(std::uint64_t number, std::map<std::string, BoardConfig>& by_accuracy_key) {
  is_judged_ = false;
  const Combination& its = combination(number);
  if (its.verdict == Verdict::kUnknown) by_accuracy_key.emplace(accuracy_key(its.board), its.board);
  last_ = {};
  is_judged_ = true;
}

std::vector<double> SearchSpace::accuracy(const BoardConfig& board) const {
  const std::map<std::string, double> all = model_.accuracy(board);
  std::vector<double> values;
  for (const std::string& name : accuracy_) values.push_back(all.count(name) > 0 ? all.at(name) : kNoValue);
  return values;
}

std::uint64_t SearchSpace::least_cycles_of_way(Combination& of, std::uint32_t way, bool waitless_alone) {
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
std::uint64_t SearchSpace::waitless_cycles(Combination& of) {
  const auto configs = ssram_configs(of.board);
  const bool is_one = std::all_of(configs.begin(), configs.end(), [&](const auto& bank) {
    return memory::read_latency_cycles(bank) == memory::read_latency_cycles(configs.front());
  });
  std::uint64_t least = UINT64_MAX;
  for (std::uint32_t way = 0; way < (is_one ? 1 : of.placements->ways()); ++way)
    least = std::min(least, least_cycles_of_way(of, way, true));
  return least;
}

std::uint64_t SearchSpace::least_cycles(Combination& of, const Placements::Group& group) {
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

Combination::OfUse SearchSpace::facts_of(const Combination& of, const BoardConfig& board) {
  Combination::OfUse facts = {board, figures_without_simulation(board), {}, {}};
  facts.figures.insert(of.accuracy.begin(), of.accuracy.end());
  for (const std::string& name : without_simulation_) {
    if (facts.figures.count(name) == 0) throw_no_figure(name, {});
  }
  const Known known = {facts.board, of.run, facts.figures};
  for (Expression& goal : goals_)
    facts.goals.push_back(goal.is_fixed() ? std::optional(goal.range(known)) : std::nullopt);
  for (Expression& requirement : requirements_)
    facts.requirements.push_back(requirement.is_fixed() ? requirement.holds(known) : std::nullopt);
  return facts;
}

const Combination::OfUse& SearchSpace::of_use(Combination& of, std::uint32_t use) {
  of.of_use.resize(of.placements->uses());
  std::unique_ptr<Combination::OfUse>& facts = of.of_use[use];
  if (!facts)
    facts = std::make_unique<Combination::OfUse>(
        facts_of(of, of.placements->placed(of.board, of.placements->first_of_use(use))));
  return *facts;
}

SearchSpace::Estimate SearchSpace::estimate(const Combination& of, const Combination::OfUse& facts,
                                            std::uint64_t least_cycles, bool has_energy, double most_steady) {
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

SearchSpace::Estimate SearchSpace::estimate(Combination& of) {
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

SearchSpace::Estimate SearchSpace::estimate(Combination& of, const Placements::Group& group,
                                            std::uint64_t placement) {
  const std::uint64_t least = of.run.camera ? 0 : least_cycles(of, group);
  if (!is_alone(of)) return estimate(of, of_use(of, group.use), least, true, 0);
  const Combination::OfUse own = facts_of(of, of.placements->placed(of.board, placement));
  const double most_steady = of.run.camera ? long_run_rate(of, placement, own.board).most : 0;
  return estimate(of, own, least, true, most_steady);
}

Range SearchSpace::long_run_rate(Combination& of, std::uint64_t placement, const BoardConfig& placed) {
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

std::uint64_t SearchSpace::short_frames(Combination& of, std::uint64_t placement) {
  if (!of.run.camera || !needs_steady_alone_) return 0;
  const Range proven = long_run_rate(of, placement, of.placements->placed(of.board, placement));
  const std::uint64_t window = proven.is_exact() ? kExactWindow : kShortWindow;
  const std::uint64_t turn = of.placements->turn();
  const std::uint64_t frames = turn + (window + turn - 1) / turn * turn;
  return 2 * frames <= of.run.frames ? frames : 0;
}

std::vector<std::string> SearchSpace::result_keys(Combination& of, const Placements::Group& group,
                                                  std::uint64_t placement, bool is_short) {
  PointRun run = of.run;
  if (is_short) run.frames = short_frames(of, placement);
  if (of.is_full) return {short_hash(make_point(0, of.placements->placed(of.board, placement), run).hash)};
  std::vector<std::string> keys;
  if (of.is_by_ways) {
    of.key_of_way.resize(of.placements->ways());
    for (const std::uint32_t way : group.ways) {
      std::string& key = of.key_of_way[way];
      if (key.empty()) key = short_hash(core_cycles_key(of.placements->board_of_way(of.board, way)));
      keys.push_back(key);
    }
    return keys;
  }
  return {short_hash(fmt::format("{}frames {}", core_cycles_key(of.placements->placed(of.board, placement)),
                                 of.run.frames))};
}

std::vector<double> SearchSpace::simulate(Combination& of, const Placements::Group& group,
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
      const bool may_lack = name == kUncertainty || name == kLostPixels || name.rfind(kExact, 0) == 0;
      std::vector<std::string> all;
      for (const platform::BoardValue& value : figures.values) all.push_back(value.path);
      if (!may_lack) throw_no_figure(name, all);
      values.push_back(0);
    } else if (const auto* const integer = std::get_if<std::int64_t>(&found->value)) {
      values.push_back(static_cast<double>(*integer));
    } else if (const auto* const real = std::get_if<double>(&found->value)) {
      values.push_back(*real);
    }
  }
  return values;
}

std::vector<double> SearchSpace::totals(const Combination& of,
                                        const std::vector<std::vector<double>>& results) const {
  if (!of.is_by_ways) return results.front();
  double sum = 0;
  for (const std::vector<double>& frame : results) sum += frame.front();
  return {sum * static_cast<double>(of.turns)};
}

std::map<std::string, double> SearchSpace::named(const Combination& of,
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

std::optional<SearchSpace::Worth> SearchSpace::worth(Combination& of, const Placements::Group& group,
                                                     std::uint64_t placement,
                                                     const std::vector<std::vector<double>>& results,
                                                     bool is_short, const Range& known) {
  std::optional<Combination::OfUse> own;
  if (is_alone(of)) own = facts_of(of, of.placements->placed(of.board, placement));
  const Combination::OfUse& facts = own ? *own : of_use(of, group.use);
  Worth worth;
  Known now = {facts.board, of.run, facts.figures};
  for (const auto& [name, value] : named(of, results, facts.board)) now.others[name] = Range::of(value);
  if (const double lost = now.range(kLostPixels).least; needs_whole_pictures_ && of.run.camera && lost > 0) {
    unmet_ = fmt::format("what counts: it loses {:.0f} pixels", lost);
    return std::nullopt;
  }
  if (const auto steady = now.others.find(kSteady); steady != now.others.end() && of.run.camera) {
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
    if (!holds.value_or(is_short)) {
      unmet_ = requirements_[i].text();
      if (!holds)
        unmet_ +=
            fmt::format(" for sure: its rate is {:.6f} to {:.6f}", worth.steady.least, worth.steady.most);
      return std::nullopt;
    }
    worth.is_known = worth.is_known && holds.has_value();
  }
  for (std::size_t goal = 0; goal < goals(); ++goal) {
    const Range range = facts.goals[goal] ? *facts.goals[goal] : goals_[goal].range(now);
    if (!std::isfinite(range.least) || !std::isfinite(range.most)) {
      const std::string& text = goals_[goal].text();
      throw ConditionError(
          fmt::format("{}: the rate of a board lies between {:.3f} and {:.3f} frames/s: the goal must rise "
                      "all the way between them, or fall: the rate once, with numbers, keys, + - * /, "
                      "comparisons, round(), min() or max()",
                      text, worth.steady.least, worth.steady.most),
          text);
    }
    worth.goals.push_back(range);
    worth.is_known = worth.is_known && range.is_exact();
  }
  return worth;
}

}  // namespace stereotlm::explore
