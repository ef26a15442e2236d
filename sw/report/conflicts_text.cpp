#include "sw/report/conflicts_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "sw/report/wait_text.h"

namespace stereotlm::report {
namespace {

constexpr std::size_t kMostBands = 8;  // of rows in the table
constexpr double kMost = 0.8;          // the share of the stalls that a place must have

std::uint64_t sum_of(const std::vector<std::uint64_t>& values) {
  return std::accumulate(values.begin(), values.end(), std::uint64_t{0});
}

double percent_of(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : 100 * static_cast<double>(part) / static_cast<double>(whole);
}

// The shortest run of neighbours that has kMost of all: [first, end).
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

// "80 % in rows 12..40"; empty if that is most of the rows.
std::string place_of(const char* name, const std::vector<std::uint64_t>& values, std::size_t length,
                     int whole) {
  const auto [first, end] = shortest_run(values);
  if (static_cast<double>(end - first) >= 0.75 * static_cast<double>(values.size())) return {};
  const std::size_t last = std::min(end * length, static_cast<std::size_t>(whole)) - 1;
  return fmt::format("{:.0f} % in {} {}..{}", 100 * kMost, name, first * length, last);
}

std::string where(const platform::BoardConfig& board, const fpga::TileGrid& grid,
                  const std::vector<std::uint64_t>& tiles) {
  std::vector<std::uint64_t> rows(grid.rows);
  std::vector<std::uint64_t> columns(grid.columns);
  for (std::size_t tile = 1; tile < tiles.size(); ++tile) {
    rows[(tile - 1) / grid.columns] += tiles[tile];
    columns[(tile - 1) % grid.columns] += tiles[tile];
  }
  if (sum_of(rows) == 0) return "before the first row of results";
  const std::string of_rows = place_of("rows", rows, grid.rows_of_tile, board.image.height);
  const std::string of_columns = place_of("columns", columns, grid.columns_of_tile, board.image.width);
  if (of_rows.empty() && of_columns.empty()) return "all over the picture";
  return of_rows + (of_rows.empty() || of_columns.empty() ? "" : ", ") + of_columns;
}

std::string table_of_rows(const platform::BoardConfig& board, const fpga::FrameConflicts& sums) {
  std::vector<std::size_t> banks;
  for (std::size_t bank = 0; bank < sums.banks; ++bank) {
    bool is_used = false;
    for (std::size_t strip = 0; strip < sums.strips.size(); ++strip) {
      const auto& accesses = sums.accesses[strip * sums.banks + bank];
      is_used = is_used ||
                std::any_of(accesses.begin(), accesses.end(), [](std::uint64_t each) { return each != 0; });
    }
    if (is_used) banks.push_back(bank);
  }
  std::string text = "rows              waits %";
  for (const std::size_t bank : banks) text += fmt::format(" {:>9}", board.banks[bank].name + " %");
  text += '\n';
  const std::size_t strips = sums.strips.size() - 1;
  const std::size_t band = (strips + kMostBands - 1) / kMostBands;
  const auto line = [&](const std::string& name, std::size_t first, std::size_t end) {
    std::uint64_t cycles = 0;
    std::uint64_t stalls = 0;
    std::vector<std::uint64_t> accesses(banks.size());
    for (std::size_t strip = first; strip < end; ++strip) {
      cycles += sums.strips[strip].cycles;
      const auto& of_strip = sums.strips[strip].stalls;
      stalls = std::accumulate(of_strip.begin(), of_strip.end(), stalls);
      for (std::size_t index = 0; index < banks.size(); ++index) {
        const auto& of_bank = sums.accesses[strip * sums.banks + banks[index]];
        accesses[index] = std::accumulate(of_bank.begin(), of_bank.end(), accesses[index]);
      }
    }
    text += fmt::format("{:<15} {:>9.2f}", name, percent_of(stalls, cycles));
    for (const std::uint64_t each : accesses) text += fmt::format(" {:>9.2f}", percent_of(each, cycles));
    text += '\n';
  };
  line("fill", 0, 1);
  for (std::size_t first = 1; first <= strips; first += band) {
    const std::size_t end = std::min(first + band, strips + 1);
    const auto rows = static_cast<std::size_t>(board.matcher.rows);
    const std::size_t last = std::min((end - 1) * rows, static_cast<std::size_t>(board.image.height)) - 1;
    line(fmt::format("{}..{}", (first - 1) * rows, last), first, end);
  }
  return text;
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

std::string conflicts_text(const platform::BoardConfig& board, const fpga::ConflictRecorder& recorder,
                           const fpga::FrameConflicts& sums) {
  const std::uint64_t cycles = sum_of(recorder.tile_cycles());
  std::string text = fmt::format("core         {} cycles in {} frame{}\n", cycles, recorder.frames(),
                                 recorder.frames() == 1 ? "" : "s");
  std::vector<const fpga::ConflictRecorder::Stalls*> stalls = recorder.stalls();
  std::stable_sort(stalls.begin(), stalls.end(),
                   [](const auto* a, const auto* b) { return sum_of(a->cycles) > sum_of(b->cycles); });
  if (stalls.empty()) text += "waits        none\n";
  for (const fpga::ConflictRecorder::Stalls* each : stalls) {
    const std::uint64_t lost = sum_of(each->cycles);
    const std::string wait = wait_text(fpga::requester_name(each->requester), board.banks[each->bank].name,
                                       fpga::requester_name(each->by));
    text += fmt::format("waits        {}: {} cycles ({:.2f} %), {}\n", wait, lost, percent_of(lost, cycles),
                        where(board, recorder.grid(), each->cycles));
  }
  return text + table_of_rows(board, sums);
}

}  // namespace stereotlm::report
