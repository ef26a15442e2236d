#include "sw/cli/allocation_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <tuple>
#include <variant>

#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"
#include "sw/explore/plan/points.h"
#include "sw/files/text_forms.h"

namespace stereotlm::cli {
namespace {

using explore::AllocationOutcome;
using explore::BestOfAll;
using explore::BestPlacement;
using platform::BoardConfig;
using Json = nlohmann::ordered_json;

bool counts(const BestPlacement& best) { return best.tied > 0; }

double percent_of(double rate, double best) { return 100 * rate / best; }

// Rounds up, so that a bound that is printed is still a bound.
double rounded_up(double value, int decimals) {
  const double scale = std::pow(10, decimals);
  return std::ceil(value * scale) / scale;
}

BoardConfig witness_of(const AllocationReport& report, const explore::Placement& witness) {
  return explore::placed(report.board, witness);
}

std::uint64_t frames_of(const AllocationReport& report) {
  return explore::frames_of(report.search.run(), report.board);
}

std::string rate_text(const AllocationReport& report, const AllocationOutcome& outcome, int decimals = 3) {
  const std::string rate = fmt::format("{:.{}f}", outcome.frames_per_second, decimals);
  return report.search.run().camera ? fmt::format("{} ± {:.{}f}", rate, outcome.uncertainty, decimals) : rate;
}

// The values of --set that give a board the allocation of `board`: "allocation.left_lut=bank0", ..
std::vector<std::string> sets_of(const BoardConfig& board) {
  constexpr std::string_view kSection = "allocation.";
  std::vector<std::string> sets;
  for (const platform::BoardValue& value : platform::values_of(board)) {
    if (value.path.compare(0, kSection.size(), kSection) == 0)
      sets.push_back(value.path + "=" + std::get<std::string>(value.value));
  }
  return sets;
}

// The command that runs a placement, and gives its rate.
std::vector<std::string> command_of(const AllocationReport& report, const explore::Placement& witness) {
  std::vector<std::string> words = {"stereotlm", "run"};
  words.insert(words.end(), report.board_words.begin(), report.board_words.end());
  if (!report.search.run().camera) words.insert(words.end(), {"--source", "preloaded"});
  words.insert(words.end(), {"--timing-only", "--frames", std::to_string(frames_of(report))});
  for (const std::string& set : sets_of(witness_of(report, witness)))
    words.insert(words.end(), {"--set", set});
  return words;
}

// An upper bound for the rate of every placement whose rate is unknown, if it is above that of all others.
std::optional<double> open_rate(const AllocationReport& report) {
  double rate = 0;
  for (const auto& [banks, bound] : report.search.open_bounds(report.bound)) rate = std::max(rate, bound);
  constexpr double kRounding = 1e-9;  // bounds and rates are rounded quotients
  if (rate <= report.best->possible_frames_per_second * (1 + kRounding)) return std::nullopt;
  return rate;
}

// The fewest decimals, at least three, that show a difference of two rates.
int decimals_of(double one, double other) {
  int decimals = 3;
  while (fmt::format("{:.{}f}", one, decimals) == fmt::format("{:.{}f}", other, decimals)) ++decimals;
  return decimals;
}

// The lines that state how many allocations were tried, and why no others are needed.
std::string space_text(const AllocationReport& report) {
  const explore::AllocationSearch& search = report.search;
  std::string text =
      fmt::format("{}: {} buffers in at most {} of {} banks: {} different allocations, {} of them fit\n",
                  report.board.name, platform::buffers(report.board).size(), report.most_banks,
                  report.board.banks.size(), search.placements(), search.fitting());
  if (search.by_frames()) {
    return text +
           fmt::format(
               "{} boards of one frame give all rates: with {} and without turnaround, the cycles of a "
               "frame\ndepend only on which of its own buffers share a bank\n",
               search.size(), report.board.fpga.arbiter.policy);
  }
  if (search.run().camera) {
    const std::uint64_t turn = platform::allocation_period_frames(report.board);
    const std::uint64_t window = frames_of(report) - turn;
    text += fmt::format(
        "frames/s: steady, over {} frames, ± what these leave open (a tenth of it with --frames {});\n"
        "an allocation that loses a pixel does not count\n",
        window, 10 * window + turn);
  } else {
    text += fmt::format(
        "each allocation is a run of {} frames, because a frame changes the state of arbiters or "
        "banks\n",
        frames_of(report));
  }
  return text +
         "not simulated, or not to the end: allocations that are slower than another of as many banks\n";
}

std::string table(const AllocationReport& report) {
  std::string text = fmt::format("{:>5} {:>12} {:>10} {:>16} {:>9} {:>10} {:>6}  one of them\n", "banks",
                                 "allocations", "simulated", "best frames/s", "% of best", "bound", "tied");
  for (const BestPlacement& best : report.all) {
    text += fmt::format("{:>5} {:>12} {:>10}", best.banks, best.placements, best.known + best.given_up);
    if (!counts(best)) {
      const bool all_lose = best.known > 0 && best.known == best.losing;
      text += fmt::format(" {:>16}\n", all_lose ? "all lose pixels" : "none");
      continue;
    }
    const BoardConfig one = witness_of(report, best.witness);
    text += fmt::format(" {:>16} {:>9.2f} {:>10.3f} {:>6}  {}\n", rate_text(report, best.outcome),
                        percent_of(best.outcome.frames_per_second, report.best->highest.frames_per_second),
                        report.bound(one), best.tied, explore::allocation_text(one));
  }
  return text;
}

// The fewest banks that keep keep_percent of the best rate.
const BestPlacement& kept_of(const AllocationReport& report) {
  return *std::find_if(report.all.begin(), report.all.end(), [&](const BestPlacement& best) {
    return counts(best) && best.outcome.frames_per_second * 100 >=
                               report.best->highest.frames_per_second * report.keep_percent;
  });
}

// The lines with the best rate of a whole search, and with what fewer banks cost.
std::string best_text(const AllocationReport& report) {
  const BestOfAll& top = *report.best;
  const BestPlacement* fewer = nullptr;  // the best with fewer banks than `top`
  for (const BestPlacement& best : report.all) {
    if (best.banks >= top.banks || !counts(best)) continue;
    if (fewer == nullptr || best.outcome.frames_per_second > fewer->outcome.frames_per_second) fewer = &best;
  }
  int decimals = 3;
  std::string rest;
  if (fewer != nullptr) {
    decimals = decimals_of(top.highest.frames_per_second, fewer->outcome.frames_per_second);
    rest = ": the best with fewer gives " + rate_text(report, fewer->outcome, decimals);
  } else {
    rest = report.all.front().banks < top.banks ? ", the fewest with an allocation that counts"
                                                : ", the fewest that hold the buffers";
  }
  const BestPlacement& kept = kept_of(report);
  return fmt::format(
             "The best with these kinds of banks, clocks and priority is {} frames/s; {}.\n",
             rate_text(report, top.highest, decimals),
             top.tied > 1 ? fmt::format("{} allocations tie", top.tied) : "no other allocation ties") +
         fmt::format("It needs {} banks ({} frames/s){}.\n", top.banks,
                     rate_text(report, top.outcome, decimals), rest) +
         fmt::format("{:g} % of it is kept with {} banks ({} frames/s, {:.2f} %), and not with fewer.\n",
                     report.keep_percent, kept.banks, rate_text(report, kept.outcome),
                     percent_of(kept.outcome.frames_per_second, top.highest.frames_per_second));
}

// The line that states how much better another allocation can be at most.
std::string certificate_text(const AllocationReport& report) {
  const BestOfAll& top = *report.best;
  const double best = top.highest.frames_per_second;
  if (const std::optional<double> open = open_rate(report)) {
    return fmt::format(
        "At most {:.2f} % better can exist: no allocation whose rate is unknown has a bound above {:.3f} "
        "frames/s.\n",
        rounded_up(percent_of(*open, best) - 100, 2), rounded_up(*open, 3));
  }
  const double most = top.possible_frames_per_second;
  return fmt::format("No allocation that uses at most {} banks gives more{}.\n", report.most_banks,
                     most > best ? fmt::format(" than {:.3f} frames/s", rounded_up(most, 3)) : "");
}

std::string result_text(const AllocationReport& report) {
  if (!report.best)
    return report.is_whole ? "No allocation counts.\n" : "Interrupted before an allocation was known.\n";
  if (report.is_whole) return best_text(report) + certificate_text(report);
  return fmt::format("Interrupted. The best so far is {} frames/s, with {} banks.\n",
                     rate_text(report, report.best->outcome), report.best->banks) +
         certificate_text(report);
}

// The lines with the numbers of allocations that do not count: they lose pixels, or could not be simulated.
std::string not_counted_text(const AllocationReport& report) {
  std::uint64_t losing = 0;
  std::uint64_t failed = 0;
  for (const BestPlacement& best : report.all) {
    losing += best.losing;
    failed += best.failed;
  }
  std::string text;
  if (losing > 0)
    text += fmt::format("{} of those simulated to the end lose pixels, and do not count.\n", losing);
  if (failed > 0) {
    text += fmt::format("{} could not be simulated, and do not count. The first:\n  {}\n", failed,
                        report.search.first_failure());
    if (!report.store.empty())
      text += fmt::format("To try again:\n  sqlite3 {} \"DELETE FROM points WHERE status = 'failed'\"\n",
                          files::shell_word(report.store));
  }
  return text;
}

std::string pixels_text(const AllocationReport& report) {
  if (!report.pixels || report.pixels->allocations < 2) return "";
  return fmt::format("The disparities of these {} allocations are the same, pixel by pixel, in {} frames.\n",
                     report.pixels->allocations, report.pixels->frames);
}

std::string command_text(const AllocationReport& report) {
  if (!report.best) return "";
  std::string text =
      fmt::format("This command runs the best allocation, and prints {} frames/s as {}:\n  {}\n",
                  rate_text(report, report.best->outcome), report.search.run().camera ? "steady" : "core",
                  files::shell_command(command_of(report, report.best->witness)));
  if (report.written) text += *report.written + ": the board with the best allocation\n";
  return text;
}

// A rate as stats.json names it.
Json rate_document(const AllocationReport& report, const AllocationOutcome& outcome) {
  if (!report.search.run().camera) return {{"core", outcome.frames_per_second}};
  return {{"steady", outcome.frames_per_second}, {"steady_uncertainty", outcome.uncertainty}};
}

Json row_document(const AllocationReport& report, const BestPlacement& best) {
  Json row = {{"banks", best.banks},
              {"allocations", best.placements},
              {"simulated", best.known + best.given_up},
              {"given_up", best.given_up},
              {"losing_pixels", best.losing},
              {"failed", best.failed},
              {"tied", best.tied}};
  if (!counts(best)) return row;
  const BoardConfig one = witness_of(report, best.witness);
  row["frames_per_second"] = rate_document(report, best.outcome);
  row["bound_frames_per_second"] = report.bound(one);
  row["sets"] = sets_of(one);
  return row;
}

Json best_document(const AllocationReport& report) {
  const BestOfAll& top = *report.best;
  const double highest = top.highest.frames_per_second;
  const double most = open_rate(report).value_or(top.possible_frames_per_second);
  return {{"banks", top.banks},
          {"frames_per_second", rate_document(report, top.outcome)},
          {"tied", top.tied},
          {"highest_frames_per_second", rate_document(report, top.highest)},
          {"possible_frames_per_second", most},
          {"possible_gain_percent", percent_of(most - highest, highest)},
          {"sets", sets_of(witness_of(report, top.witness))},
          {"command", command_of(report, top.witness)}};
}

}  // namespace

std::string allocation_report_text(const AllocationReport& report) {
  return space_text(report) + table(report) + result_text(report) + not_counted_text(report) +
         pixels_text(report) + command_text(report);
}

Json allocation_report_document(const AllocationReport& report) {
  const explore::AllocationSearch& search = report.search;
  Json document = {{"schema", 1},
                   {"state", report.is_whole ? "complete" : "interrupted"},
                   {"board", report.board.name},
                   {"source", search.run().camera ? "camera" : "preloaded"},
                   {"frames", frames_of(report)},
                   {"most_banks", report.most_banks},
                   {"allocations", search.placements()},
                   {"fitting_allocations", search.fitting()}};
  if (report.best) document["best"] = best_document(report);
  if (report.best && report.is_whole) {
    const BestPlacement& kept = kept_of(report);
    document["keeping"] = {
        {"least_percent", report.keep_percent},
        {"banks", kept.banks},
        {"percent", percent_of(kept.outcome.frames_per_second, report.best->highest.frames_per_second)}};
  }
  document["banks"] = Json::array();
  for (const BestPlacement& best : report.all) document["banks"].push_back(row_document(report, best));
  if (report.pixels)
    document["equal_disparities"] = {{"allocations", report.pixels->allocations},
                                     {"frames", report.pixels->frames}};
  if (const std::string failure = search.first_failure(); !failure.empty())
    document["first_failure"] = failure;
  if (report.written) document["written"] = *report.written;
  return document;
}

}  // namespace stereotlm::cli
