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

constexpr std::size_t kMostBands = 8;  // of rows in the table
constexpr double kMost = 0.8;          // the share of the stalls that a place must have

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

// The place of shortest_run(); nullopt if that is most of it. `length`: rows or columns of a value; `whole`:
// those of the picture.
std::optional<Range> place_of(const std::vector<std::uint64_t>& values, std::size_t length, int whole) {
  const auto [first, end] = shortest_run(values);
  if (static_cast<double>(end - first) >= 0.75 * static_cast<double>(values.size())) return std::nullopt;
  return Range{static_cast<int>(first * length),
               static_cast<int>(std::min(end * length, static_cast<std::size_t>(whole))) - 1};
}

ConflictSummary::Wait wait_of(const platform::BoardConfig& board, const fpga::TileGrid& grid,
                              const fpga::ConflictRecorder::Stalls& stalls, std::uint64_t cycles) {
  ConflictSummary::Wait wait;
  wait.port = fpga::requester_name(stalls.requester);
  wait.bank = board.banks[stalls.bank].name;
  wait.by = fpga::requester_name(stalls.by);
  wait.cycles = sum_of(stalls.cycles);
  wait.cycles_percent = percent_of(wait.cycles, cycles);
  std::vector<std::uint64_t> rows(grid.rows);
  std::vector<std::uint64_t> columns(grid.columns);
  for (std::size_t tile = 1; tile < stalls.cycles.size(); ++tile) {
    rows[(tile - 1) / grid.columns] += stalls.cycles[tile];
    columns[(tile - 1) % grid.columns] += stalls.cycles[tile];
  }
  wait.is_in_fill = sum_of(rows) == 0;
  if (wait.is_in_fill) return wait;
  wait.rows = place_of(rows, grid.rows_of_tile, board.image.height);
  wait.columns = place_of(columns, grid.columns_of_tile, board.image.width);
  return wait;
}

// The banks with accesses, by index.
std::vector<std::size_t> used_banks(const fpga::FrameConflicts& sums) {
  std::vector<std::size_t> banks;
  for (std::size_t bank = 0; bank < sums.banks; ++bank) {
    for (std::size_t strip = 0; strip < sums.strips.size(); ++strip) {
      if (sum_of(sums.accesses[strip * sums.banks + bank]) == 0) continue;
      banks.push_back(bank);
      break;
    }
  }
  return banks;
}

// The band of strips first..end-1, without its rows.
ConflictSummary::Band band_of(const fpga::FrameConflicts& sums, const std::vector<std::size_t>& banks,
                              std::size_t first, std::size_t end) {
  std::uint64_t cycles = 0;
  std::uint64_t stalls = 0;
  std::vector<std::uint64_t> accesses(banks.size());
  for (std::size_t strip = first; strip < end; ++strip) {
    cycles += sums.strips[strip].cycles;
    stalls += sum_of(sums.strips[strip].stalls);
    for (std::size_t index = 0; index < banks.size(); ++index)
      accesses[index] += sum_of(sums.accesses[strip * sums.banks + banks[index]]);
  }
  ConflictSummary::Band band;
  band.waits_percent = percent_of(stalls, cycles);
  for (const std::uint64_t each : accesses) band.banks_percent.push_back(percent_of(each, cycles));
  return band;
}

void add_bands(const platform::BoardConfig& board, const fpga::FrameConflicts& sums,
               ConflictSummary& summary) {
  const std::vector<std::size_t> banks = used_banks(sums);
  for (const std::size_t bank : banks) summary.banks.push_back(board.banks[bank].name);
  summary.bands.push_back(band_of(sums, banks, 0, 1));
  const std::size_t strips = sums.strips.size() - 1;
  const std::size_t height = (strips + kMostBands - 1) / kMostBands;
  const auto rows = static_cast<std::size_t>(board.matcher.rows);
  for (std::size_t first = 1; first <= strips; first += height) {
    const std::size_t end = std::min(first + height, strips + 1);
    summary.bands.push_back(band_of(sums, banks, first, end));
    const std::size_t last = std::min((end - 1) * rows, static_cast<std::size_t>(board.image.height)) - 1;
    summary.bands.back().rows = {static_cast<int>((first - 1) * rows), static_cast<int>(last)};
  }
}

std::string range_text(const Range& range) { return fmt::format("{}..{}", range.first, range.last); }

std::string where(const ConflictSummary::Wait& wait) {
  if (wait.is_in_fill) return "before the first row of results";
  std::string text;
  for (const auto& [name, range] : {std::pair("rows", wait.rows), std::pair("columns", wait.columns)}) {
    if (!range) continue;
    text +=
        fmt::format("{}{:.0f} % in {} {}", text.empty() ? "" : ", ", 100 * kMost, name, range_text(*range));
  }
  return text.empty() ? "all over the picture" : text;
}

nlohmann::ordered_json json_of(const ConflictSummary::Wait& wait) {
  nlohmann::ordered_json json = {{"port", wait.port},
                                 {"bank", wait.bank},
                                 {"by", wait.by},
                                 {"cycles", wait.cycles},
                                 {"cycles_percent", wait.cycles_percent},
                                 {"before_first_row", wait.is_in_fill}};
  if (wait.rows) {
    json["first_row"] = wait.rows->first;
    json["last_row"] = wait.rows->last;
  }
  if (wait.columns) {
    json["first_column"] = wait.columns->first;
    json["last_column"] = wait.columns->last;
  }
  return json;
}

nlohmann::ordered_json json_of(const ConflictSummary::Band& band, const std::vector<std::string>& banks) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  if (band.rows) {
    json["first_row"] = band.rows->first;
    json["last_row"] = band.rows->last;
  }
  json["waits_percent"] = band.waits_percent;
  nlohmann::ordered_json& all = json["banks"] = nlohmann::ordered_json::array();
  for (std::size_t bank = 0; bank < banks.size(); ++bank)
    all.push_back({{"name", banks[bank]}, {"accesses_percent", band.banks_percent[bank]}});
  return json;
}

}  // namespace

void StripSums::add(const fpga::FrameConflicts& frame) {
  if (sums_.strips.empty()) {
    sums_ = frame;
    return;
  }
  for (std::size_t strip = 0; strip < sums_.strips.size(); ++strip) {
    fpga::StripConflicts& sum = sums_.strips[strip];
    sum.cycles += frame.strips[strip].cycles;
    for (std::size_t requester = 0; requester < sum.stalls.size(); ++requester)
      sum.stalls[requester] += frame.strips[strip].stalls[requester];
  }
  for (std::size_t place = 0; place < sums_.accesses.size(); ++place) {
    for (std::size_t kind = 0; kind < sums_.accesses[place].size(); ++kind)
      sums_.accesses[place][kind] += frame.accesses[place][kind];
  }
}

ConflictSummary conflict_summary(const platform::BoardConfig& board, const fpga::ConflictRecorder& recorder,
                                 const fpga::FrameConflicts& sums) {
  ConflictSummary summary;
  summary.board = board.name;
  summary.frames = recorder.frames();
  summary.cycles = sum_of(recorder.tile_cycles());
  for (const fpga::ConflictRecorder::Stalls* stalls : recorder.stalls())
    summary.waits.push_back(wait_of(board, recorder.grid(), *stalls, summary.cycles));
  std::stable_sort(summary.waits.begin(), summary.waits.end(),
                   [](const auto& a, const auto& b) { return a.cycles > b.cycles; });
  add_bands(board, sums, summary);
  return summary;
}

std::string conflicts_text(const ConflictSummary& summary) {
  std::string text = fmt::format("core         {} cycles in {} frame{}\n", summary.cycles, summary.frames,
                                 summary.frames == 1 ? "" : "s");
  if (summary.waits.empty()) text += "waits        none\n";
  for (const ConflictSummary::Wait& wait : summary.waits) {
    text += fmt::format("waits        {}: {} cycles ({:.2f} %), {}\n",
                        stats::wait_text(wait.port, wait.bank, wait.by), wait.cycles, wait.cycles_percent,
                        where(wait));
  }
  text += "rows              waits %";
  for (const std::string& bank : summary.banks) text += fmt::format(" {:>9}", bank + " %");
  text += '\n';
  for (const ConflictSummary::Band& band : summary.bands) {
    text += fmt::format("{:<15} {:>9.2f}", band.rows ? range_text(*band.rows) : "fill", band.waits_percent);
    for (const double percent : band.banks_percent) text += fmt::format(" {:>9.2f}", percent);
    text += '\n';
  }
  return text;
}

nlohmann::ordered_json conflicts_document(const ConflictSummary& summary) {
  nlohmann::ordered_json document = {
      {"schema", 1}, {"board", summary.board}, {"frames", summary.frames}, {"cycles", summary.cycles}};
  nlohmann::ordered_json& waits = document["waits"] = nlohmann::ordered_json::array();
  for (const ConflictSummary::Wait& wait : summary.waits) waits.push_back(json_of(wait));
  nlohmann::ordered_json& bands = document["rows"] = nlohmann::ordered_json::array();
  for (const ConflictSummary::Band& band : summary.bands) bands.push_back(json_of(band, summary.banks));
  return document;
}

}  // namespace stereotlm::report
