#include "sw/report/conflicts_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>
#include <vector>

#include "sw/stats/console_table.h"

namespace stereotlm::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostBands = 8;  // of rows in the table
constexpr std::size_t kMostWaits = 24;
constexpr double kMost = 0.8;  // the share of the stalls that a place must have

template <typename Values>
std::uint64_t sum_of(const Values& values) {
  return std::accumulate(values.begin(), values.end(), std::uint64_t{0});
}

double percent_of(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : 100 * static_cast<double>(part) / static_cast<double>(whole);
}

// The first of the shortest runs of neighbours that have kMost of all: [first, end).
std::pair<std::size_t, std::size_t> shortest_run(const std::vector<std::uint64_t>& values) {
  const double wanted = kMost * static_cast<double>(sum_of(values));
  std::pair<std::size_t, std::size_t> best = {0, values.size()};
  std::uint64_t inside = 0;
  for (std::size_t first = 0, end = 0; first < values.size(); inside -= values[first++]) {
    while (end < values.size() && static_cast<double>(inside) < wanted) inside += values[end++];
    if (static_cast<double>(inside) < wanted) break;
    if (end - first < best.second - best.first) best = {first, end};
  }
  return best;
}

// Adds the rows or columns of shortest_run() as "first_NAME" and "last_NAME", unless they are most of the
// picture. `length`: rows or columns of a value; `whole`: those of the picture.
void add_place(const std::string& name, const std::vector<std::uint64_t>& values, std::size_t length,
               int whole, Json& json) {
  const auto [first, end] = shortest_run(values);
  if (static_cast<double>(end - first) >= 0.75 * static_cast<double>(values.size())) return;
  json["first_" + name] = first * length;
  json["last_" + name] = std::min(end * length, static_cast<std::size_t>(whole)) - 1;
}

Json wait_of(const platform::BoardConfig& board, const fpga::TileGrid& grid,
             const fpga::ConflictRecorder::Stalls& stalls, std::uint64_t cycles) {
  std::vector<std::uint64_t> rows(grid.rows);
  std::vector<std::uint64_t> columns(grid.columns);
  for (std::size_t tile = 1; tile < stalls.cycles.size(); ++tile) {
    rows[(tile - 1) / grid.columns] += stalls.cycles[tile];
    columns[(tile - 1) % grid.columns] += stalls.cycles[tile];
  }
  const bool is_in_fill = sum_of(rows) == 0;
  const fpga::Requesters requesters(platform::core_ports(board));
  Json wait = {{"port", requesters.name(stalls.requester)},
               {"bank", board.banks[stalls.bank].name},
               {"by", requesters.name(stalls.by)},
               {"cycles", sum_of(stalls.cycles)},
               {"cycles_percent", percent_of(sum_of(stalls.cycles), cycles)},
               {"before_first_row", is_in_fill}};
  if (is_in_fill) return wait;
  add_place("row", rows, grid.rows_of_tile, board.image.height, wait);
  add_place("column", columns, grid.columns_of_tile, board.image.width, wait);
  return wait;
}

// The banks with accesses, by index.
std::vector<std::size_t> used_banks(const fpga::FrameConflicts& sums) {
  std::vector<std::size_t> banks;
  for (std::size_t bank = 0; bank < sums.banks; ++bank) {
    std::uint64_t accesses = 0;
    for (std::size_t strip = 0; strip < sums.strips.size(); ++strip)
      accesses += sum_of(sums.accesses[strip * sums.banks + bank]);
    if (accesses > 0) banks.push_back(bank);
  }
  return banks;
}

// Adds to a band what happens in the strips first..end-1.
void add_strips(const platform::BoardConfig& board, const fpga::FrameConflicts& sums, std::size_t first,
                std::size_t end, Json& band) {
  std::uint64_t cycles = 0;
  std::uint64_t stalls = 0;
  std::vector<std::uint64_t> accesses(sums.banks);
  for (std::size_t strip = first; strip < end; ++strip) {
    cycles += sums.strips[strip].cycles;
    stalls += sum_of(sums.strips[strip].stalls);
    for (std::size_t bank = 0; bank < sums.banks; ++bank)
      accesses[bank] += sum_of(sums.accesses[strip * sums.banks + bank]);
  }
  band["waits_percent"] = percent_of(stalls, cycles);
  band["banks"] = Json::array();
  for (const std::size_t bank : used_banks(sums)) {
    band["banks"].push_back(
        {{"name", board.banks[bank].name}, {"accesses_percent", percent_of(accesses[bank], cycles)}});
  }
}

// The fill, and bands of rows from top to bottom.
Json bands_of(const platform::BoardConfig& board, const fpga::FrameConflicts& sums) {
  Json bands = Json::array({Json::object()});
  add_strips(board, sums, 0, 1, bands.back());
  const std::size_t strips = sums.strips.size() - 1;
  const std::size_t height = (strips + kMostBands - 1) / kMostBands;
  const auto rows = static_cast<std::size_t>(board.matcher.rows);
  for (std::size_t first = 1; first <= strips; first += height) {
    const std::size_t end = std::min(first + height, strips + 1);
    const std::size_t last = std::min((end - 1) * rows, static_cast<std::size_t>(board.image.height)) - 1;
    bands.push_back({{"first_row", (first - 1) * rows}, {"last_row", last}});
    add_strips(board, sums, first, end, bands.back());
  }
  return bands;
}

// The rows or columns of a place; empty if it has none.
std::string range_text(const Json& json, const std::string& name) {
  if (!json.contains("first_" + name)) return "";
  return fmt::format("{}..{}", json["first_" + name].get<int>(), json["last_" + name].get<int>());
}

std::string where(const Json& wait) {
  if (wait["before_first_row"].get<bool>()) return "before the first row of results";
  std::string text;
  for (const std::string name : {"row", "column"}) {
    const std::string range = range_text(wait, name);
    if (range.empty()) continue;
    text += fmt::format("{}{:.0f} % in {}s {}", text.empty() ? "" : ", ", 100 * kMost, name, range);
  }
  return text.empty() ? "all over the picture" : text;
}

}  // namespace

void add_frame(const fpga::FrameConflicts& frame, fpga::FrameConflicts& sums) {
  if (sums.strips.empty()) {
    sums = frame;
    return;
  }
  for (std::size_t strip = 0; strip < sums.strips.size(); ++strip) {
    fpga::StripConflicts& sum = sums.strips[strip];
    sum.cycles += frame.strips[strip].cycles;
    for (std::size_t requester = 0; requester < sum.stalls.size(); ++requester)
      sum.stalls[requester] += frame.strips[strip].stalls[requester];
  }
  for (std::size_t place = 0; place < sums.accesses.size(); ++place) {
    for (std::size_t kind = 0; kind < sums.accesses[place].size(); ++kind)
      sums.accesses[place][kind] += frame.accesses[place][kind];
  }
}

Json conflicts_document(const platform::BoardConfig& board, const fpga::ConflictRecorder& recorder,
                        const fpga::FrameConflicts& sums) {
  const std::uint64_t cycles = sum_of(recorder.tile_cycles());
  std::vector<Json> waits;
  for (const fpga::ConflictRecorder::Stalls* stalls : recorder.stalls())
    waits.push_back(wait_of(board, recorder.grid(), *stalls, cycles));
  std::stable_sort(waits.begin(), waits.end(),
                   [](const Json& a, const Json& b) { return a["cycles"] > b["cycles"]; });
  return {{"schema", 1},      {"board", board.name}, {"frames", recorder.frames()},
          {"cycles", cycles}, {"waits", waits},      {"rows", bands_of(board, sums)}};
}

std::string conflicts_text(const Json& document) {
  const auto frames = document["frames"].get<std::uint64_t>();
  std::string text = fmt::format("core         {} cycles in {} frame{}\n",
                                 document["cycles"].get<std::uint64_t>(), frames, frames == 1 ? "" : "s");
  if (document["waits"].empty()) text += "waits        none\n";
  const std::size_t waits = document["waits"].size();
  for (std::size_t number = 0; number < std::min(waits, kMostWaits); ++number) {
    const Json& wait = document["waits"][number];
    text +=
        fmt::format("waits        {}: {} cycles ({:.2f} %), {}\n",
                    stats::wait_text(wait["port"], wait["bank"], wait["by"]),
                    wait["cycles"].get<std::uint64_t>(), wait["cycles_percent"].get<double>(), where(wait));
  }
  if (waits > kMostWaits)
    text += fmt::format("waits        {} others, less; all: --json\n", waits - kMostWaits);
  text += "rows              waits %";
  const auto head_of = [](const Json& bank) { return platform::bank_text(bank["name"]) + " %"; };
  for (const Json& bank : document["rows"].front()["banks"]) text += fmt::format(" {:>9}", head_of(bank));
  text += '\n';
  for (const Json& band : document["rows"]) {
    const std::string rows = range_text(band, "row");
    text += fmt::format("{:<15} {:>9.2f}", rows.empty() ? "fill" : rows, band["waits_percent"].get<double>());
    for (const Json& bank : band["banks"])
      text += fmt::format(" {:>{}.2f}", bank["accesses_percent"].get<double>(),
                          std::max<std::size_t>(9, head_of(bank).size()));
    text += '\n';
  }
  return text;
}

}  // namespace stereotlm::report
