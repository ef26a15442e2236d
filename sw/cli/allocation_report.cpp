#include "sw/cli/allocation_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <tuple>
#include <utility>
#include <variant>

#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"
#include "sw/explore/plan/points.h"
#include "sw/explore/search/allocations.h"
#include "sw/files/shell_word.h"

namespace stereotlm::cli {
namespace {

using explore::BestPlacement;
using platform::BoardConfig;
using Json = nlohmann::ordered_json;

bool counts(const BestPlacement& best) { return best.reached_by > 0; }

double percent_of(double rate, double best) { return 100 * rate / best; }

// Rounds up, so that a bound that is printed is still a bound.
double rounded_up(double value, int decimals) {
  const double scale = std::pow(10, decimals);
  return std::ceil(value * scale) / scale;
}

BoardConfig witness_of(const AllocationReport& report, const BestPlacement& best) {
  return explore::placed(report.board, best.witness);
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
std::vector<std::string> command_of(const AllocationReport& report, const BestPlacement& best) {
  std::vector<std::string> words = {"stereotlm", "run"};
  words.insert(words.end(), report.board_words.begin(), report.board_words.end());
  if (!report.search.run().camera) words.insert(words.end(), {"--source", "preloaded"});
  const std::uint64_t frames = explore::frames_of(report.search.run(), report.board);
  words.insert(words.end(), {"--timing-only", "--frames", std::to_string(frames)});
  for (const std::string& set : sets_of(witness_of(report, best))) words.insert(words.end(), {"--set", set});
  return words;
}

// An upper bound for the rate of every placement that counts, or whose rate is unknown; the best rate if none
// can be better. Bounds and rates are rounded quotients. 0 if there are no such placements.
double highest_possible_rate(const AllocationReport& report) {
  double rate = 0;
  for (const auto& [banks, bound] : report.search.open_bounds(report.bound)) rate = std::max(rate, bound);
  const BestPlacement* const top = best_of_all(report.all);
  constexpr double kRounding = 1e-9;
  return top == nullptr || rate > top->frames_per_second * (1 + kRounding) ? rate : top->frames_per_second;
}

// Two rates that differ, with as many decimals as show it; at least three.
std::pair<std::string, std::string> different_texts(double one, double other) {
  for (int decimals = 3;; ++decimals) {
    std::pair<std::string, std::string> texts = {fmt::format("{:.{}f}", one, decimals),
                                                 fmt::format("{:.{}f}", other, decimals)};
    if (texts.first != texts.second) return texts;
  }
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
    text += fmt::format(
        "frames/s: {} frames, from time 0 to the last delivery; an allocation that loses a pixel does not "
        "count\nsteady: between the first and the last delivery. It does not rank, because a late first "
        "delivery raises it\n",
        explore::frames_of(search.run(), report.board));
  } else {
    text +=
        "each allocation is a run of the first turn of its lists, because a frame changes the state of "
        "arbiters or banks\n";
  }
  return text +
         "not simulated, or not to the end: allocations that cannot reach the best rate of as many banks\n";
}

std::string table(const AllocationReport& report) {
  const bool camera = report.search.run().camera;
  const BestPlacement* const top = best_of_all(report.all);
  std::string text = fmt::format("{:>5} {:>12} {:>10} {:>14} {:>9} {:>10}", "banks", "allocations",
                                 "simulated", "best frames/s", "% of best", "bound");
  if (camera) text += fmt::format(" {:>8}", "steady");
  text += fmt::format(" {:>10}  one of them\n", "reached by");
  for (const BestPlacement& best : report.all) {
    text += fmt::format("{:>5} {:>12} {:>10}", best.banks, best.placements, best.known + best.given_up);
    if (!counts(best)) {
      const bool all_lose = best.known > 0 && best.known == best.losing;
      text += fmt::format(" {:>14}\n", all_lose ? "all lose pixels" : "none");
      continue;
    }
    const BoardConfig one = witness_of(report, best);
    text += fmt::format(" {:>14.3f} {:>9.2f} {:>10.3f}", best.frames_per_second,
                        percent_of(best.frames_per_second, top->frames_per_second), report.bound(one));
    if (camera) text += fmt::format(" {:>8.3f}", best.outcome.steady.value_or(0));
    text += fmt::format(" {:>10}  {}\n", best.reached_by, explore::allocation_text(one));
  }
  return text;
}

// The fewest banks that keep keep_percent of the best rate.
const BestPlacement& kept_of(const AllocationReport& report, const BestPlacement& top) {
  return *std::find_if(report.all.begin(), report.all.end(), [&](const BestPlacement& best) {
    return counts(best) && best.frames_per_second * 100 >= top.frames_per_second * report.keep_percent;
  });
}

// The lines with the best rate of a whole search, and with what fewer banks cost.
std::string best_text(const AllocationReport& report, const BestPlacement& top) {
  double fewer = 0;  // the best rate with fewer banks than `top`; 0: none
  for (const BestPlacement& best : report.all) {
    if (best.banks < top.banks && counts(best)) fewer = std::max(fewer, best.frames_per_second);
  }
  std::string rate = fmt::format("{:.3f}", top.frames_per_second);
  std::string rest;
  if (fewer > 0) {
    std::string fewer_text;
    std::tie(rate, fewer_text) = different_texts(top.frames_per_second, fewer);
    rest = ": the best with fewer gives " + fewer_text;
  } else {
    rest = report.all.front().banks < top.banks ? ", the fewest with an allocation that counts"
                                                : ", the fewest that hold the buffers";
  }
  const BestPlacement& kept = kept_of(report, top);
  return fmt::format("The best of all is {} frames/s, and needs {} banks{}.\n", rate, top.banks, rest) +
         fmt::format("{:g} % of it is kept with {} banks ({:.3f} frames/s, {:.2f} %), and not with fewer.\n",
                     report.keep_percent, kept.banks, kept.frames_per_second,
                     percent_of(kept.frames_per_second, top.frames_per_second));
}

// The line that states how much better another allocation can be at most.
std::string certificate_text(const AllocationReport& report, const BestPlacement& top) {
  const double most = highest_possible_rate(report);
  if (most <= top.frames_per_second)
    return fmt::format("No allocation that uses at most {} banks gives more.\n", report.most_banks);
  return fmt::format(
      "At most {:.2f} % better can exist: no allocation whose rate is unknown has a bound above {:.3f} "
      "frames/s.\n",
      rounded_up(percent_of(most, top.frames_per_second) - 100, 2), rounded_up(most, 3));
}

// The lines with the result of the search.
std::string result_text(const AllocationReport& report) {
  const BestPlacement* const top = best_of_all(report.all);
  if (top == nullptr)
    return report.is_whole ? "No allocation counts.\n" : "Interrupted before an allocation was known.\n";
  if (report.is_whole) return best_text(report, *top) + certificate_text(report, *top);
  return fmt::format("Interrupted. The best so far is {:.3f} frames/s, with {} banks.\n",
                     top->frames_per_second, top->banks) +
         certificate_text(report, *top);
}

// The lines with the numbers of allocations that do not count, because they lose pixels or could not be
// simulated.
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
    text += fmt::format(
        "{} could not be simulated, and do not count. The first:\n  {}\nTo try again:\n"
        "  sqlite3 {} \"DELETE FROM points WHERE status = 'failed'\"\n",
        failed, report.search.first_failure(), files::shell_word(report.store));
  }
  return text;
}

std::string pixels_text(const AllocationReport& report) {
  if (!report.pixels || report.pixels->allocations < 2) return "";
  return fmt::format("The disparities of these {} allocations are the same, pixel by pixel, in {} frames.\n",
                     report.pixels->allocations, report.pixels->frames);
}

// The lines with the command that runs the best allocation.
std::string command_text(const AllocationReport& report) {
  const BestPlacement* const top = best_of_all(report.all);
  if (top == nullptr) return "";
  std::string text =
      fmt::format("This command runs the best allocation, and prints {:.3f} frames/s as {}:\n  {}\n",
                  top->frames_per_second, report.search.run().camera ? "system" : "core",
                  files::shell_command(command_of(report, *top)));
  if (report.written) text += *report.written + ": the board with the best allocation\n";
  return text;
}

// The rates of a placement as stats.json names them.
Json rates_document(const AllocationReport& report, const BestPlacement& best) {
  if (!report.search.run().camera) return {{"core", best.frames_per_second}};
  return {{"system", best.frames_per_second}, {"steady", best.outcome.steady.value_or(0)}};
}

Json row_document(const AllocationReport& report, const BestPlacement& best) {
  Json row = {{"banks", best.banks},
              {"allocations", best.placements},
              {"simulated", best.known + best.given_up},
              {"given_up", best.given_up},
              {"losing_pixels", best.losing},
              {"failed", best.failed},
              {"reached_by", best.reached_by}};
  if (!counts(best)) return row;
  const BoardConfig one = witness_of(report, best);
  row["frames_per_second"] = rates_document(report, best);
  row["bound_frames_per_second"] = report.bound(one);
  row["sets"] = sets_of(one);
  return row;
}

Json best_document(const AllocationReport& report, const BestPlacement& top) {
  const double most = highest_possible_rate(report);
  return {{"banks", top.banks},
          {"frames_per_second", rates_document(report, top)},
          {"possible_frames_per_second", most},
          {"possible_gain_percent", percent_of(most - top.frames_per_second, top.frames_per_second)},
          {"sets", sets_of(witness_of(report, top))},
          {"command", command_of(report, top)}};
}

}  // namespace

const BestPlacement* best_of_all(const std::vector<BestPlacement>& all) {
  const BestPlacement* top = nullptr;
  for (const BestPlacement& best : all) {
    if (counts(best) && (top == nullptr || best.frames_per_second > top->frames_per_second)) top = &best;
  }
  return top;
}

std::string allocation_report_text(const AllocationReport& report) {
  return space_text(report) + table(report) + result_text(report) + not_counted_text(report) +
         pixels_text(report) + command_text(report);
}

Json allocation_report_document(const AllocationReport& report) {
  const explore::AllocationSearch& search = report.search;
  const BestPlacement* const top = best_of_all(report.all);
  Json document = {{"schema", 1},
                   {"state", report.is_whole ? "complete" : "interrupted"},
                   {"board", report.board.name},
                   {"source", search.run().camera ? "camera" : "preloaded"},
                   {"frames", explore::frames_of(search.run(), report.board)},
                   {"most_banks", report.most_banks},
                   {"allocations", search.placements()},
                   {"fitting_allocations", search.fitting()}};
  if (top != nullptr) document["best"] = best_document(report, *top);
  if (top != nullptr && report.is_whole) {
    const BestPlacement& kept = kept_of(report, *top);
    document["keeping"] = {{"least_percent", report.keep_percent},
                           {"banks", kept.banks},
                           {"percent", percent_of(kept.frames_per_second, top->frames_per_second)}};
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
