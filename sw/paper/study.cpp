#include "sw/paper/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <list>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "models/kernels/matching_cost.h"
#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"
#include "sw/explore/plan/points.h"
#include "sw/explore/search/allocation_search.h"
#include "sw/files/text_forms.h"
#include "sw/files/whole_file.h"
#include "sw/stats/accuracy.h"

namespace stereotlm::paper {
namespace {

using platform::BoardConfig;

// Rates are quotients: a relative difference below this is rounding.
constexpr double kRounding = 1e-9;

bool reaches(double rate, double best) { return rate >= best * (1 - kRounding); }

bool has_less_rate(const Measured& a, const Measured& b) { return a.rate < b.rate; }

int banks_of(const BoardConfig& board) {
  std::vector<std::string> names;
  for (const platform::PlacedBuffer& buffer : platform::buffers(board)) names.push_back(buffer.bank);
  std::sort(names.begin(), names.end());
  return static_cast<int>(std::unique(names.begin(), names.end()) - names.begin());
}

// The words that name the board on a command line: "fpl2003 --set matcher.window=7".
std::string words_of(const BoardRun& run) {
  std::string text = run.preset;
  for (const std::string& set : run.sets) text += " --set " + files::shell_word(set);
  return text;
}

// Calls visit(run) for each run of the claims, but for the boards whose allocations are searched.
template <typename Visit>
void for_each_run(const std::vector<Claim>& claims, const Visit& visit) {
  for (const Claim& claim : claims) {
    if (claim.quantity == Quantity::kBanksProved) continue;
    for (const Case& one : claim.cases) std::for_each(one.runs.begin(), one.runs.end(), visit);
  }
}

// All different boards of the claims, cores alone and computers.
class Boards {
 public:
  explicit Boards(const std::vector<Claim>& claims) {
    for_each_run(claims, [&](const BoardRun& run) {
      if (numbers_.emplace(std::pair(run.camera, words_of(run)), runs_.size()).second) runs_.push_back(run);
    });
  }

  std::size_t size() const { return runs_.size(); }

  // Returns false if `keep_going` has ended the simulations.
  bool simulate(const Means& means, const std::function<bool(std::uint64_t done)>& keep_going) {
    return batch_.run({runs_.size(), [this](std::uint64_t number) { return point(number); }}, means.evaluate,
                      [&](const explore::SweepCounts& counts) { return keep_going(counts.done()); });
  }

  // To be called after simulate().
  Measured of(const BoardRun& run) {
    const std::size_t number = numbers_.at({run.camera, words_of(run)});
    const explore::Point one = point(number);
    const explore::StoredRow& row = batch_.row_of(one);
    if (run.camera && row.lost_pixels() > 0)
      throw std::runtime_error(fmt::format("{}: captures lose pixels", command_of(run)));
    const std::string bound = run.camera ? "bound.system" : "bound.core";
    Measured measured;
    measured.rate = row.real(run.camera ? "frames_per_second.steady" : "frames_per_second.core");
    if (run.camera) measured.delivered = row.real("frames_per_second.system");
    measured.bound = row.real(bound);
    measured.limited_by = row.text(bound + "_limited_by");
    measured.slices_percent = row.real("area.slices_percent");
    measured.banks = banks_of(*one.board);
    return measured;
  }

 private:
  explore::Point point(std::uint64_t number) const {
    const BoardRun& run = runs_.at(number);
    return explore::make_point(number, board_of(run), {run.camera, 0, ""});
  }

  std::vector<BoardRun> runs_;
  std::map<std::pair<bool, std::string>, std::size_t> numbers_;
  explore::Batch batch_;
};

// A search of the best allocation of the core alone for each number of banks.
struct BankSearch {
  BankSearch(const Claim& its, const Means& means)
      : claim(its),
        board(board_of(its.cases.front().runs.front())),
        search(board, static_cast<int>(board.banks.size()), {false, 0, ""},
               [&means](const BoardConfig& one) { return means.bound(one).core; }),
        most(search.most_left()) {}

  const Claim& claim;
  BoardConfig board;
  explore::AllocationSearch search;
  std::uint64_t most;  // upper limit for the number of boards to simulate
};

// The best allocation for each number of banks, after the search.
void add_best(const BankSearch& searched, const Means& means, std::vector<BankRow>& rows) {
  for (const explore::BestPlacement& best : searched.search.best()) {
    if (best.known != best.placements) {
      throw std::logic_error(
          fmt::format("{} banks: {} of {} allocations are known", best.banks, best.known, best.placements));
    }
    const BoardConfig one = explore::placed(searched.board, best.witness);
    const platform::Bound bound = means.bound(one);
    BankRow row;
    row.of = searched.claim.name;
    row.banks = best.banks;
    row.allocations = best.placements;
    row.reached_by = best.tied;
    row.measured.rate = best.outcome.frames_per_second;
    row.measured.bound = bound.core;
    row.measured.limited_by = bound.core_limited_by;
    row.measured.banks = best.banks;
    row.allocation = explore::allocation_text(one);
    row.command = commands_of(searched.claim, searched.claim.cases.front()).front();
    rows.push_back(row);
  }
}

// The smallest number of banks among the runs that reach the rate of `best`, which is one of them.
int fewest_banks(const std::vector<Measured>& runs, const Measured& best) {
  int fewest = best.banks;
  for (const Measured& run : runs) {
    if (reaches(run.rate, best.rate)) fewest = std::min(fewest, run.banks);
  }
  return fewest;
}

// The same for the rows of a claim: of those that reach the best rate of all.
int fewest_banks(const std::vector<BankRow>& rows, const std::string& claim) {
  std::vector<Measured> runs;
  for (const BankRow& row : rows) {
    if (row.of == claim) runs.push_back(row.measured);
  }
  return fewest_banks(runs, *std::max_element(runs.begin(), runs.end(), has_less_rate));
}

double spread(const std::vector<Measured>& runs) {
  const auto [least, most] = std::minmax_element(runs.begin(), runs.end(), has_less_rate);
  return most->rate - least->rate;
}

Quality change_of(const Quality& from, const Quality& to) {
  return {to.wrong_percent - from.wrong_percent, to.answered_percent - from.answered_percent};
}

double largest_change(const Quality& from, const Quality& to) {
  const Quality change = change_of(from, to);
  return std::max(std::abs(change.wrong_percent), std::abs(change.answered_percent));
}

std::string name_of_cost(const BoardRun& run) {
  const kernels::MatchingCost cost = board_of(run).matcher.cost;
  const std::string name = kernels::name_of(cost.kind);
  return cost.kind == kernels::CostKind::kCensus ? fmt::format("{} {}", name, cost.census_size) : name;
}

double modelled_value(const Claim& claim, const std::vector<Measured>& runs,
                      const std::vector<BankRow>& banks) {
  switch (claim.quantity) {
    case Quantity::kRate:
      return runs.at(0).rate;
    case Quantity::kSlices:
      return runs.at(0).slices_percent;
    case Quantity::kSpread:
      return spread(runs);
    case Quantity::kSpeedUp:
      return runs.at(0).rate / runs.at(1).rate;
    case Quantity::kAccuracyChange:
      return largest_change(runs.at(0).quality.value(), runs.at(1).quality.value());
    case Quantity::kBanksProved:
      return fewest_banks(banks, claim.name);
    case Quantity::kBanksFound:
      break;
  }
  return fewest_banks(runs, runs.front());
}

bool judges(const Quality& first) { return first.wrong_percent <= stats::kDoubtfulBad1Percent; }

// Appends a row for each chosen allocation of a case.
void add_chosen(const Claim& claim, const Case& one, const std::vector<Measured>& runs,
                std::vector<BankRow>& rows) {
  for (std::size_t i = runs.size(); i-- > 0;) {
    BankRow row;
    row.of = claim.name;
    row.banks = runs[i].banks;
    row.measured = runs[i];
    row.allocation = explore::allocation_text(board_of(one.runs[i]));
    row.command = command_of(one.runs[i]);
    rows.push_back(row);
  }
}

}  // namespace

const ClaimFinding& Findings::of(const std::string& claim) const {
  for (const ClaimFinding& finding : claims) {
    if (finding.claim.name == claim) return finding;
  }
  throw std::out_of_range(fmt::format("claim = {}: not among those that were studied", claim));
}

BoardConfig board_of(const BoardRun& run) { return platform::load_board(run.preset, run.sets); }

std::optional<Findings> study(const std::vector<Claim>& claims, const Means& means) {
  Boards boards(claims);
  std::map<std::string, std::pair<BoardRun, Quality>> scenes;  // by command
  for_each_run(claims, [&](const BoardRun& run) {
    if (run.scene) scenes[command_of(run)].first = run;
  });
  std::uint64_t after = boards.size() + scenes.size();  // of later parts, at most
  std::list<BankSearch> searches;
  for (const Claim& claim : claims) {
    if (claim.quantity == Quantity::kBanksProved) after += searches.emplace_back(claim, means).most;
  }
  std::uint64_t before = 0;  // boards of the parts that have ended
  // Returns the progress of a part. At its begin it has `most` boards to simulate, at most.
  const auto part = [&](std::uint64_t most) {
    after -= most;
    return [&](std::uint64_t done, std::uint64_t most_left) {
      return means.keep_going(before + done, most_left + after);
    };
  };

  Findings findings;
  for (BankSearch& searched : searches) {
    const files::TemporaryFolder folder;
    explore::SweepOptions sweep;
    sweep.store = (folder.path() / "allocations.db").string();
    std::uint64_t simulated = 0;
    const auto keep_going = part(searched.most);
    const bool is_whole = explore::simulate(searched.search, means.evaluate, sweep,
                                            [&](const explore::SearchProgress& progress) {
                                              simulated = progress.done;
                                              return keep_going(progress.done, progress.most_left);
                                            });
    if (!is_whole) return std::nullopt;
    before += simulated;
    add_best(searched, means, findings.banks);
  }
  const auto keep_simulating = part(boards.size());
  if (!boards.simulate(means,
                       [&](std::uint64_t done) { return keep_simulating(done, boards.size() - done); }))
    return std::nullopt;
  before += boards.size();
  const auto keep_going = part(scenes.size());
  std::uint64_t done = 0;
  for (auto& [command, scene] : scenes) {
    if (!keep_going(done, scenes.size() - done)) return std::nullopt;
    scene.second = means.quality(board_of(scene.first), *scene.first.scene);
    ++done;
  }

  for (const Claim& claim : claims) {
    ClaimFinding found = {claim, {}, Verdict::kOpen};
    std::vector<Verdict> verdicts;
    for (const Case& one : claim.cases) {
      CaseFinding finding;
      finding.of = one;
      for (const BoardRun& run : one.runs) {
        if (claim.quantity == Quantity::kBanksProved) continue;
        finding.runs.push_back(boards.of(run));
        if (run.scene) finding.runs.back().quality = scenes.at(command_of(run)).second;
      }
      finding.modelled = modelled_value(claim, finding.runs, findings.banks);
      const bool is_judged =
          claim.quantity != Quantity::kAccuracyChange || judges(finding.runs.at(0).quality.value());
      if (is_judged) finding.verdict = verdict_of(claim, one.printed, finding.modelled);
      if (claim.quantity == Quantity::kBanksFound) add_chosen(claim, one, finding.runs, findings.banks);
      verdicts.push_back(finding.verdict);
      found.cases.push_back(std::move(finding));
    }
    found.verdict = verdict_of_all(verdicts);
    findings.claims.push_back(std::move(found));
  }
  return findings;
}

std::vector<CostRow> cost_rows(const ClaimFinding& found) {
  std::vector<CostRow> rows;
  std::set<std::string> commands;
  for (const CaseFinding& finding : found.cases) {
    for (std::size_t j = 0; j < finding.runs.size(); ++j) {
      const BoardRun& run = finding.of.runs[j];
      const Measured& measured = finding.runs[j];
      if (!commands.insert(command_of(run)).second) continue;
      rows.push_back({run.scene.value().name, name_of_cost(run), measured.quality.value(),
                      change_of(finding.runs[0].quality.value(), measured.quality.value()),
                      measured.slices_percent, j == 1 ? std::optional(finding.verdict) : std::nullopt,
                      command_of(run)});
    }
  }
  return rows;
}

std::vector<SceneFinding> scenes_of(const ClaimFinding& found) {
  std::vector<SceneFinding> scenes;
  for (const CaseFinding& finding : found.cases) {
    const Scene& scene = finding.of.runs[0].scene.value();
    const auto is_it = [&](const SceneFinding& known) { return known.scene.name == scene.name; };
    if (std::any_of(scenes.begin(), scenes.end(), is_it)) continue;
    const Quality first = finding.runs[0].quality.value();
    scenes.push_back({scene, first.wrong_percent, judges(first)});
  }
  return scenes;
}

std::string command_of(const BoardRun& run) {
  if (run.scene) {
    std::string text = fmt::format("stereotlm run {} --source preloaded", words_of(run));
    for (const std::string& option : run.scene->options) text += ' ' + files::shell_word(option);
    return text;
  }
  const explore::PointRun point_run = {run.camera, 0, ""};
  const std::uint64_t frames = explore::frames_of(point_run, board_of(run));
  return fmt::format("stereotlm run {}{} --timing-only --frames {}", words_of(run),
                     run.camera ? "" : " --source preloaded", frames);
}

std::vector<std::string> commands_of(const Claim& claim, const Case& one) {
  const BoardRun& first = one.runs.front();
  switch (claim.quantity) {
    case Quantity::kRate:
      return {command_of(first)};
    case Quantity::kSlices:
      return {fmt::format("stereotlm bounds {}", words_of(first))};
    case Quantity::kAccuracyChange:
      return {command_of(first), command_of(one.runs.at(1))};
    case Quantity::kBanksProved:
      return {fmt::format("stereotlm allocate {} --source preloaded --banks {} --out banks.db",
                          words_of(first), board_of(first).banks.size())};
    case Quantity::kSpread:
    case Quantity::kSpeedUp:
    case Quantity::kBanksFound:
      break;
  }
  std::vector<std::string> all;
  for (const BoardRun& run : one.runs) all.push_back(command_of(run));
  return all;
}

std::optional<ClockRange> clock_for(const Claim& claim, const CaseFinding& finding) {
  const BoardRun& run = finding.of.runs.front();
  if (claim.quantity != Quantity::kRate || run.camera) return std::nullopt;
  const double mhz_for_a_frame =
      board_of(run).fpga.clock_mhz / finding.modelled;  // the cycles of a frame do not depend on the clock
  return ClockRange{(finding.of.printed - claim.half_digit) * mhz_for_a_frame,
                    (finding.of.printed + claim.half_digit) * mhz_for_a_frame};
}

std::optional<double> deviation_percent(const Claim& claim, const CaseFinding& finding) {
  const bool counts_banks =
      claim.quantity == Quantity::kBanksProved || claim.quantity == Quantity::kBanksFound;
  if (counts_banks || finding.of.printed == 0) return std::nullopt;
  return 100 * (finding.modelled / finding.of.printed - 1);
}

}  // namespace stereotlm::paper
