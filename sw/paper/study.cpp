#include "sw/paper/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "models/kernels/matching_cost.h"
#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"
#include "sw/explore/plan/knobs.h"
#include "sw/explore/search/allocation_run.h"
#include "sw/explore/search/allocation_search.h"
#include "sw/files/shell_word.h"
#include "sw/files/temporary_folder.h"
#include "sw/stats/accuracy.h"

namespace stereotlm::paper {
namespace {

using platform::BoardConfig;

// Rates are quotients: a relative difference below this is rounding.
constexpr double kRounding = 1e-9;

bool reaches(double rate, double best) { return rate >= best * (1 - kRounding); }

int banks_of(const BoardConfig& board) {
  std::vector<std::string> names;
  for (const platform::PlacedBuffer& buffer : platform::buffers(board)) names.push_back(buffer.bank);
  std::sort(names.begin(), names.end());
  return static_cast<int>(std::unique(names.begin(), names.end()) - names.begin());
}

std::string identity_of(const BoardRun& run) {
  std::string text = run.preset + (run.camera ? " camera" : " preloaded");
  for (const std::string& set : run.sets) text += ' ' + set;
  return text;
}

// The words that name the board on a command line: "fpl2003 --set matcher.window=7".
std::string words_of(const BoardRun& run) {
  std::string text = run.preset;
  for (const std::string& set : run.sets) text += " --set " + files::shell_word(set);
  return text;
}

// All different runs of the claims: with `camera` the runs of the computer, else the runs of the core alone.
class Runs {
 public:
  Runs(const std::vector<Claim>& claims, bool camera) : run_{camera, 0, ""} {
    for (const Claim& claim : claims) {
      if (claim.quantity == Quantity::kBanksProved) continue;
      for (const Case& one : claim.cases) {
        for (const BoardRun& run : one.runs) {
          if (run.camera != camera || !numbers_.emplace(identity_of(run), boards_.size()).second) continue;
          boards_.push_back(platform::load_board(run.preset, run.sets));
        }
      }
    }
  }

  std::size_t size() const { return boards_.size(); }
  explore::BoardPoints points() const { return {boards_, run_}; }

  Measured of(const BoardRun& run, explore::Batch& batch) const {
    const std::size_t number = numbers_.at(identity_of(run));
    const explore::StoredRow& row = batch.row_of(points().point(number));
    const bool camera = run_.camera;
    if (camera &&
        row.integer("cameras.left.dropped_pixels") + row.integer("cameras.right.dropped_pixels") > 0)
      throw std::runtime_error(fmt::format("{}: captures lose pixels", command_of(run)));
    const std::string bound = camera ? "bound.system" : "bound.core";
    Measured measured;
    measured.rate = row.real(camera ? "frames_per_second.steady" : "frames_per_second.core");
    if (camera) measured.delivered = row.real("frames_per_second.system");
    measured.bound = row.real(bound);
    measured.limited_by = row.text(bound + "_limited_by");
    measured.slices_percent = row.real("area.slices_percent");
    measured.banks = banks_of(boards_[number]);
    return measured;
  }

 private:
  explore::PointRun run_;
  std::vector<BoardConfig> boards_;
  std::map<std::string, std::size_t> numbers_;
};

// All different runs of the claims with a scene.
class SceneRuns {
 public:
  explicit SceneRuns(const std::vector<Claim>& claims) {
    for (const Claim& claim : claims) {
      for (const Case& one : claim.cases) {
        for (const BoardRun& run : one.runs) {
          if (run.scene) runs_.emplace(command_of(run), run);
        }
      }
    }
  }

  std::size_t size() const { return runs_.size(); }

  // Returns false if `keep_going` has ended the runs.
  bool simulate(const Means& means, const std::function<bool(std::uint64_t done)>& keep_going) {
    for (const auto& [command, run] : runs_) {
      if (!keep_going(qualities_.size())) return false;
      qualities_[command] = means.quality(platform::load_board(run.preset, run.sets), *run.scene);
    }
    return true;
  }

  // nullopt for a run without scene.
  std::optional<Quality> of(const BoardRun& run) const {
    return run.scene ? std::optional(qualities_.at(command_of(run))) : std::nullopt;
  }

 private:
  std::map<std::string, BoardRun> runs_;  // by command
  std::map<std::string, Quality> qualities_;
};

// The progress of a study, whose parts are its searches and runs.
class Progress {
 public:
  // `most`: upper limit for the number of boards of all parts.
  Progress(std::uint64_t most, const Means& means) : after_(most), means_(means) {}
  // `most`: upper limit for the number of boards of the next part. The limit of the constructor includes it.
  void begin_part(std::uint64_t most) { after_ -= most; }
  // Reports the progress of the running part.
  bool keep_going(std::uint64_t done, std::uint64_t most_left) const {
    return means_.keep_going(before_ + done, most_left + after_);
  }
  void end_part(std::uint64_t done) { before_ += done; }

 private:
  std::uint64_t before_ = 0;
  std::uint64_t after_;  // upper limit for the boards of later parts
  const Means& means_;
};

// Searches the best allocation of the core alone for each number of banks.
class BankSearch {
 public:
  BankSearch(const Claim& claim, const Means& means)
      : claim_(claim),
        means_(means),
        board_(load(claim.cases.front().runs.front())),
        search_(board_, static_cast<int>(board_.banks.size()), kAlone,
                [this](const BoardConfig& one) { return bound(one).core; }),
        most_(search_.most_left()) {}

  // Upper limit for the number of boards to simulate.
  std::uint64_t most() const { return most_; }

  // Returns false if keep_going() has ended the search.
  bool simulate(Progress& progress) {
    const files::TemporaryFolder folder;
    explore::SweepOptions sweep;
    sweep.store = (folder.path() / "allocations.db").string();
    sweep.version = means_.version;
    sweep.jobs = means_.jobs;
    std::uint64_t simulated = 0;
    progress.begin_part(most_);
    const bool is_whole =
        explore::simulate(search_, means_.evaluate, sweep, [&](const explore::SearchProgress& search) {
          simulated = search.done;
          return progress.keep_going(search.done, search.most_left);
        });
    progress.end_part(simulated);
    return is_whole;
  }

  // The best allocation for each number of banks. To be called after simulate().
  std::vector<BankRow> rows() const {
    std::vector<BankRow> rows;
    for (const explore::BestPlacement& best : search_.best()) {
      if (best.known != best.placements) {
        throw std::logic_error(
            fmt::format("{} banks: {} of {} allocations are known", best.banks, best.known, best.placements));
      }
      const BoardConfig one = explore::placed(board_, best.witness);
      BankRow row;
      row.of = claim_.name;
      row.banks = best.banks;
      row.allocations = best.placements;
      row.reached_by = best.tied;
      row.measured.rate = best.outcome.frames_per_second;
      row.measured.bound = bound(one).core;
      row.measured.limited_by = bound(one).core_limited_by;
      row.measured.banks = best.banks;
      row.allocation = explore::allocation_text(one);
      row.command = commands_of(claim_, claim_.cases.front()).front();
      rows.push_back(row);
    }
    return rows;
  }

 private:
  inline static const explore::PointRun kAlone = {false, 0, ""};

  static BoardConfig load(const BoardRun& run) { return platform::load_board(run.preset, run.sets); }
  platform::Bound bound(const BoardConfig& one) const { return means_.bound(one); }

  const Claim& claim_;
  const Means& means_;
  BoardConfig board_;
  explore::AllocationSearch search_;
  std::uint64_t most_;
};

// The smallest number of banks among the rows of a claim that reach the best rate of these rows.
int fewest_banks(const std::vector<BankRow>& rows, const std::string& claim) {
  double best = 0;
  int fewest = 0;
  for (const BankRow& row : rows) {
    if (row.of == claim) best = std::max(best, row.measured.rate);
  }
  for (const BankRow& row : rows) {
    if (row.of == claim && reaches(row.measured.rate, best) && (fewest == 0 || row.banks < fewest))
      fewest = row.banks;
  }
  return fewest;
}

// The smallest number of banks among the runs that reach the rate of the first run.
int fewest_banks(const std::vector<Measured>& runs) {
  int fewest = runs.front().banks;
  for (const Measured& run : runs) {
    if (reaches(run.rate, runs.front().rate)) fewest = std::min(fewest, run.banks);
  }
  return fewest;
}

double spread(const std::vector<Measured>& runs) {
  const auto by_rate = [](const Measured& a, const Measured& b) { return a.rate < b.rate; };
  const auto [least, most] = std::minmax_element(runs.begin(), runs.end(), by_rate);
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
  const kernels::MatchingCost cost = platform::load_board(run.preset, run.sets).matcher.cost;
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
  return fewest_banks(runs);
}

bool judges(const Quality& first) { return first.wrong_percent <= stats::kDoubtfulBad1Percent; }

Verdict verdict_of_case(const Claim& claim, const Case& one, const CaseFinding& finding) {
  const double modelled = finding.modelled;
  if (claim.quantity == Quantity::kAccuracyChange && !judges(finding.runs.at(0).quality.value()))
    return Verdict::kOpen;
  const bool is_proved = claim.quantity == Quantity::kBanksProved;
  if (!is_proved && claim.quantity != Quantity::kBanksFound)
    return verdict_of(claim.rule, one.printed, modelled);
  return verdict_of_need(static_cast<int>(one.printed), static_cast<int>(modelled), is_proved);
}

// Appends a row for each chosen allocation of a case.
void add_chosen(const Claim& claim, const Case& one, const std::vector<Measured>& runs,
                std::vector<BankRow>& rows) {
  for (std::size_t i = runs.size(); i-- > 0;) {
    const BoardConfig board = platform::load_board(one.runs[i].preset, one.runs[i].sets);
    BankRow row;
    row.of = claim.name;
    row.banks = runs[i].banks;
    row.measured = runs[i];
    row.allocation = explore::allocation_text(board);
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

std::optional<Findings> study(const std::vector<Claim>& claims, const Means& means) {
  const Runs runs_of[] = {{claims, false}, {claims, true}};
  SceneRuns scene_runs(claims);
  std::uint64_t most = runs_of[0].size() + runs_of[1].size() + scene_runs.size();
  std::vector<BankSearch> searches;
  for (const Claim& claim : claims) {
    if (claim.quantity == Quantity::kBanksProved) most += searches.emplace_back(claim, means).most();
  }
  Progress progress(most, means);
  Findings findings;
  for (BankSearch& search : searches) {
    if (!search.simulate(progress)) return std::nullopt;
    const std::vector<BankRow> rows = search.rows();
    findings.banks.insert(findings.banks.end(), rows.begin(), rows.end());
  }
  explore::Batch batches[2];
  for (const int i : {0, 1}) {
    progress.begin_part(runs_of[i].size());
    const bool is_whole =
        batches[i].run(runs_of[i].points(), means.evaluate, means.version, means.jobs,
                       [&](const explore::SweepCounts& counts) {
                         return progress.keep_going(counts.done(), counts.total - counts.done());
                       });
    if (!is_whole) return std::nullopt;
    progress.end_part(runs_of[i].size());
  }
  progress.begin_part(scene_runs.size());
  const bool is_whole = scene_runs.simulate(
      means, [&](std::uint64_t done) { return progress.keep_going(done, scene_runs.size() - done); });
  if (!is_whole) return std::nullopt;
  progress.end_part(scene_runs.size());
  for (const Claim& claim : claims) {
    ClaimFinding found = {claim, {}, Verdict::kOpen};
    std::vector<Verdict> verdicts;
    for (const Case& one : claim.cases) {
      CaseFinding finding;
      if (claim.quantity != Quantity::kBanksProved) {
        for (const BoardRun& run : one.runs) {
          const int i = run.camera ? 1 : 0;
          finding.runs.push_back(runs_of[i].of(run, batches[i]));
          finding.runs.back().quality = scene_runs.of(run);
        }
      }
      finding.modelled = modelled_value(claim, finding.runs, findings.banks);
      finding.verdict = verdict_of_case(claim, one, finding);
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
  for (std::size_t i = 0; i < found.cases.size(); ++i) {
    const CaseFinding& finding = found.cases[i];
    for (std::size_t j = 0; j < finding.runs.size(); ++j) {
      const BoardRun& run = found.claim.cases[i].runs[j];
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
  for (std::size_t i = 0; i < found.cases.size(); ++i) {
    const Scene& scene = found.claim.cases[i].runs[0].scene.value();
    const auto is_it = [&](const SceneFinding& known) { return known.scene.name == scene.name; };
    if (std::any_of(scenes.begin(), scenes.end(), is_it)) continue;
    const Quality first = found.cases[i].runs[0].quality.value();
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
  const std::uint64_t frames = explore::frames_of(point_run, platform::load_board(run.preset, run.sets));
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
                          words_of(first), platform::load_board(first.preset, first.sets).banks.size())};
    case Quantity::kSpread:
    case Quantity::kSpeedUp:
    case Quantity::kBanksFound:
      break;
  }
  std::vector<std::string> all;
  for (const BoardRun& run : one.runs) all.push_back(command_of(run));
  return all;
}

std::optional<ClockRange> clock_for(const Claim& claim, const Case& one, const CaseFinding& finding) {
  const BoardRun& run = one.runs.front();
  if (claim.quantity != Quantity::kRate || run.camera) return std::nullopt;
  const double mhz = platform::load_board(run.preset, run.sets).fpga.clock_mhz;
  const double mhz_for_a_frame = mhz / finding.modelled;  // the cycles of a frame do not depend on the clock
  return ClockRange{(one.printed - claim.half_digit) * mhz_for_a_frame,
                    (one.printed + claim.half_digit) * mhz_for_a_frame};
}

std::optional<double> deviation_percent(const Claim& claim, const Case& one, const CaseFinding& finding) {
  const bool counts_banks =
      claim.quantity == Quantity::kBanksProved || claim.quantity == Quantity::kBanksFound;
  if (counts_banks || one.printed == 0) return std::nullopt;
  return 100 * (finding.modelled / one.printed - 1);
}

}  // namespace stereotlm::paper
