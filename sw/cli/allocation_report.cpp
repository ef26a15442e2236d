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
#include "sw/files/text_forms.h"

namespace stereotlm::cli {
namespace {

using platform::BoardConfig;
using Json = nlohmann::ordered_json;

bool counts(const BestAllocations& best) { return !best.ties.empty(); }

double percent_of(double rate, double best) { return 100 * rate / best; }

// Rounds up, so that a bound that is printed is still a bound.
double rounded_up(double value, int decimals) {
  const double scale = std::pow(10, decimals);
  return std::ceil(value * scale) / scale;
}

const AllocationRate& rate_of(const BestAllocations& best) { return best.ties.front().rate; }

std::string rate_text(const AllocationReport& report, const AllocationRate& its, int decimals = 3) {
  const std::string rate = fmt::format("{:.{}f}", its.frames_per_second, decimals);
  const bool is_open = report.run.camera && !its.is_exact;
  return is_open ? fmt::format("{} ± {:.{}f}", rate, its.uncertainty, decimals) : rate;
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

// The command that runs an allocation, and gives its rate.
std::vector<std::string> command_of(const AllocationReport& report, const BoardConfig& allocated) {
  std::vector<std::string> words = {"stereotlm", "run"};
  words.insert(words.end(), report.board_words.begin(), report.board_words.end());
  if (!report.run.camera) words.insert(words.end(), {"--source", "preloaded"});
  words.insert(words.end(), {"--timing-only", "--frames", std::to_string(report.run.frames)});
  for (const std::string& set : sets_of(allocated)) words.insert(words.end(), {"--set", set});
  return words;
}

// The bound of those that are not decided, if it is above all rates that are known.
std::optional<double> open_rate(const AllocationReport& report, const BestOfAll& top) {
  if (report.open_bound <= top.possible_frames_per_second) return std::nullopt;
  return report.open_bound;
}

// The fewest decimals, 3 to 12, that show a difference of two rates.
int decimals_of(double one, double other) {
  int decimals = 3;
  while (decimals < 12 && fmt::format("{:.{}f}", one, decimals) == fmt::format("{:.{}f}", other, decimals))
    ++decimals;
  return decimals;
}

// The lines that state how many allocations there are, and what their rates are.
std::string space_text(const AllocationReport& report) {
  const std::string text =
      fmt::format("{}: {} buffers in at most {} of {} banks: {} different allocations, {} simulated\n",
                  report.board.name, platform::buffers(report.board).size(), report.most_banks,
                  report.board.banks.size(), report.allocations(), report.simulated);
  if (!report.run.camera) return text;
  const std::uint64_t turn = platform::allocation_period_frames(report.board);
  const std::uint64_t window = report.run.frames - turn;
  return text +
         fmt::format(
             "frames/s: in the long run, where it is proven; else steady, over {} frames, ± what these leave "
             "open\n(a tenth of it with --frames {}); an allocation that loses a pixel does not count\n",
             window, 10 * window + turn);
}

std::string table(const AllocationReport& report, const std::optional<BestOfAll>& top) {
  std::string text = fmt::format("{:>5} {:>12} {:>16} {:>9} {:>10} {:>6}  one of them\n", "banks",
                                 "allocations", "best frames/s", "% of best", "bound", "tied");
  for (const BestAllocations& best : report.all) {
    text += fmt::format("{:>5} {:>12}", best.banks, best.allocations);
    if (!counts(best)) {
      text += fmt::format(" {:>16}\n", report.is_whole ? "all lose pixels" : "not known");
      continue;
    }
    text += fmt::format(" {:>16} {:>9.2f} {:>10.3f} {:>6}  {}\n", rate_text(report, rate_of(best)),
                        percent_of(rate_of(best).frames_per_second, top->highest.frames_per_second),
                        best.bound, best.tied(), allocation_text(best.ties.front().first));
  }
  return text;
}

// The fewest banks that keep keep_percent of the best rate.
const BestAllocations& kept_of(const AllocationReport& report, const BestOfAll& top) {
  return *std::find_if(report.all.begin(), report.all.end(), [&](const BestAllocations& best) {
    return counts(best) &&
           rate_of(best).frames_per_second * 100 >= top.highest.frames_per_second * report.keep_percent;
  });
}

// The lines with the best rate of a whole search, and with what fewer banks cost.
std::string best_text(const AllocationReport& report, const BestOfAll& top) {
  const AllocationRate* fewer = nullptr;  // the best with fewer banks than `top`
  for (const BestAllocations& best : report.all) {
    if (best.banks >= top.banks || !counts(best)) continue;
    if (fewer == nullptr || rate_of(best).frames_per_second > fewer->frames_per_second)
      fewer = &rate_of(best);
  }
  int decimals = 3;
  std::string rest;
  if (fewer != nullptr) {
    decimals = decimals_of(top.highest.frames_per_second, fewer->frames_per_second);
    rest = ": the best with fewer gives " + rate_text(report, *fewer, decimals);
  } else {
    rest = report.all.front().banks < top.banks ? ", the fewest with an allocation that counts"
                                                : ", the fewest that hold the buffers";
  }
  const BestAllocations& kept = kept_of(report, top);
  return fmt::format(
             "The best with these kinds of banks, clocks and priority is {} frames/s; {}.\n",
             rate_text(report, top.highest, decimals),
             top.tied > 1 ? fmt::format("{} allocations tie", top.tied) : "no other allocation ties") +
         fmt::format("It needs {} banks ({} frames/s){}.\n", top.banks,
                     rate_text(report, top.fastest->rate, decimals), rest) +
         fmt::format("{:g} % of it is kept with {} banks ({} frames/s, {:.2f} %), and not with fewer.\n",
                     report.keep_percent, kept.banks, rate_text(report, rate_of(kept)),
                     percent_of(rate_of(kept).frames_per_second, top.highest.frames_per_second));
}

// The line that states how much better another allocation can be at most.
std::string certificate_text(const AllocationReport& report, const BestOfAll& top) {
  const double best = top.highest.frames_per_second;
  if (const std::optional<double> open = open_rate(report, top)) {
    return fmt::format(
        "At most {:.2f} % better can exist: no allocation whose rate is unknown has a bound above {:.3f} "
        "frames/s.\n",
        rounded_up(percent_of(*open, best) - 100, 2), rounded_up(*open, 3));
  }
  const double most = top.possible_frames_per_second;
  return fmt::format("No allocation that uses at most {} banks gives more{}.\n", report.most_banks,
                     most > best ? fmt::format(" than {:.3f} frames/s", rounded_up(most, 3)) : "");
}

std::string result_text(const AllocationReport& report, const std::optional<BestOfAll>& top) {
  if (!top)
    return report.is_whole ? "No allocation counts.\n" : "Interrupted before an allocation was known.\n";
  if (report.is_whole) return best_text(report, *top) + certificate_text(report, *top);
  return fmt::format("Interrupted. The best so far is {} frames/s, with {} banks.\n",
                     rate_text(report, top->fastest->rate), top->banks) +
         certificate_text(report, *top);
}

std::string pixels_text(const AllocationReport& report) {
  if (!report.pixels || report.pixels->allocations < 2) return "";
  return fmt::format("The disparities of these {} allocations are the same, pixel by pixel, in {} frames.\n",
                     report.pixels->allocations, report.pixels->frames);
}

std::string command_text(const AllocationReport& report, const std::optional<BestOfAll>& top) {
  if (!top) return "";
  std::string text =
      fmt::format("This command runs the best allocation, and prints {} frames/s as {}:\n  {}\n",
                  rate_text(report, top->fastest->rate),
                  !report.run.camera            ? "core"
                  : top->fastest->rate.is_exact ? "long run"
                                                : "steady",
                  files::shell_command(command_of(report, top->fastest->first)));
  if (report.written) text += *report.written + ": the board with the best allocation\n";
  return text;
}

// A rate as stats.json names it.
Json rate_document(const AllocationReport& report, const AllocationRate& rate) {
  if (!report.run.camera) return {{"core", rate.frames_per_second}};
  if (rate.is_exact) return {{"exact", rate.frames_per_second}};
  return {{"steady", rate.frames_per_second}, {"steady_uncertainty", rate.uncertainty}};
}

Json row_document(const AllocationReport& report, const BestAllocations& best) {
  Json row = {{"banks", best.banks}, {"allocations", best.allocations}, {"tied", best.tied()}};
  if (!counts(best)) return row;
  row["frames_per_second"] = rate_document(report, rate_of(best));
  row["bound_frames_per_second"] = best.bound;
  row["sets"] = sets_of(best.ties.front().first);
  return row;
}

Json best_document(const AllocationReport& report, const BestOfAll& top) {
  const double highest = top.highest.frames_per_second;
  const double most = open_rate(report, top).value_or(top.possible_frames_per_second);
  return {{"banks", top.banks},
          {"frames_per_second", rate_document(report, top.fastest->rate)},
          {"tied", top.tied},
          {"highest_frames_per_second", rate_document(report, top.highest)},
          {"possible_frames_per_second", most},
          {"possible_gain_percent", percent_of(most - highest, highest)},
          {"sets", sets_of(top.fastest->first)},
          {"command", command_of(report, top.fastest->first)}};
}

}  // namespace

std::uint64_t BestAllocations::tied() const {
  std::uint64_t count = 0;
  for (const RatedAllocations& tie : ties) count += tie.count;
  return count;
}

std::uint64_t AllocationReport::allocations() const {
  std::uint64_t count = 0;
  for (const BestAllocations& best : all) count += best.allocations;
  return count;
}

std::optional<BestOfAll> AllocationReport::best() const {
  double to_reach = 0;
  for (const BestAllocations& best : all) {
    for (const RatedAllocations& tie : best.ties) to_reach = std::max(to_reach, tie.possible.least);
  }
  BestOfAll top;
  for (const BestAllocations& best : all) {
    for (const RatedAllocations& tie : best.ties) {
      if (tie.possible.most < to_reach) continue;
      if (top.fastest == nullptr) {
        top.fastest = &tie;
        top.banks = best.banks;
      }
      if (tie.rate.frames_per_second > top.highest.frames_per_second) top.highest = tie.rate;
      top.possible_frames_per_second =
          std::max({top.possible_frames_per_second, tie.possible.most, tie.rate.frames_per_second});
      top.tied += tie.count;
    }
  }
  return top.fastest == nullptr ? std::nullopt : std::optional(top);
}

std::string allocation_text(const BoardConfig& board) {
  std::string text;
  std::optional<platform::Buffer> last;
  for (const platform::PlacedBuffer& buffer : platform::buffers(board)) {
    if (buffer.buffer != last) text += (text.empty() ? "" : ", ") + std::string(name_of(buffer.buffer));
    text += ' ' + platform::bank_text(buffer.bank);
    last = buffer.buffer;
  }
  return text;
}

std::string allocation_report_text(const AllocationReport& report) {
  const std::optional<BestOfAll> top = report.best();
  return space_text(report) + table(report, top) + result_text(report, top) + pixels_text(report) +
         command_text(report, top);
}

Json allocation_report_document(const AllocationReport& report) {
  Json document = {{"schema", 1},
                   {"state", report.is_whole ? "complete" : "interrupted"},
                   {"board", report.board.name},
                   {"source", report.run.camera ? "camera" : "preloaded"},
                   {"frames", report.run.frames},
                   {"most_banks", report.most_banks},
                   {"allocations", report.allocations()},
                   {"simulated", report.simulated}};
  const std::optional<BestOfAll> top = report.best();
  if (top) document["best"] = best_document(report, *top);
  if (top && report.is_whole) {
    const BestAllocations& kept = kept_of(report, *top);
    document["keeping"] = {
        {"least_percent", report.keep_percent},
        {"banks", kept.banks},
        {"percent", percent_of(rate_of(kept).frames_per_second, top->highest.frames_per_second)}};
  }
  document["banks"] = Json::array();
  for (const BestAllocations& best : report.all) document["banks"].push_back(row_document(report, best));
  if (report.pixels)
    document["equal_disparities"] = {{"allocations", report.pixels->allocations},
                                     {"frames", report.pixels->frames}};
  if (report.written) document["written"] = *report.written;
  return document;
}

}  // namespace stereotlm::cli
