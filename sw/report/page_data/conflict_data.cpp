#include "sw/report/page_data/conflict_data.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <numeric>

#include "models/fpga/frame_geometry.h"
#include "sw/report/conflicts_csv.h"
#include "sw/report/page_data/packed_column.h"

namespace stereotlm::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<const char*, fpga::FrameConflicts::kAccessKinds> kAccessKindNames = {
    "core", "capture", "upload", "read-back"};

// Columns of rows.csv and of conflicts.csv.
enum RowColumn : std::size_t { kFrameOfRow, kFirstRow, kLastRow, kCycles, kFirstStalls };
enum TileColumn : std::size_t { kTileRow, kTileLastRow, kTileColumn, kTileLastColumn, kTileCycles, kPort };

template <typename Number>
Json packed(const std::vector<Number>& values) {
  PackedColumn column;
  for (const Number value : values) column.add(static_cast<std::int64_t>(value));
  return column.json();
}

std::size_t parts_of(std::size_t whole, std::size_t part) { return (whole + part - 1) / part; }

}  // namespace

ConflictData::ConflictData(const platform::BoardConfig& board)
    : board_(board),
      grid_(fpga::FrameGeometry(platform::core_config(board)), fpga::ConflictRecorder::kMostTiles),
      rows_csv_("rows.csv", rows_csv_head(board)),
      tiles_csv_("conflicts.csv", conflicts_csv_head()),
      lines_(1 + grid_.rows) {
  for (Line& line : lines_) line.accesses.resize(board.banks.size());
}

// The fill has no row.
std::size_t ConflictData::line_of(std::string_view first_row) const {
  if (first_row.empty()) return 0;
  return std::min<std::size_t>(1 + rows_csv_.number(first_row) / grid_.rows_of_tile, grid_.rows);
}

void ConflictData::add_rows(std::string_view text) {
  rows_csv_.read(text, [this](const CsvLines::Cells& cells) {
    frames_ = 1 + rows_csv_.number(cells[kFrameOfRow]);
    Line& line = lines_[line_of(cells[kFirstRow])];
    line.cycles += rows_csv_.number(cells[kCycles]);
    std::size_t column = kFirstStalls + fpga::kRequesters;
    for (fpga::FrameConflicts::BankAccesses& accesses : line.accesses) {
      for (std::uint64_t& of_kind : accesses) of_kind += rows_csv_.number(cells[column++]);
    }
  });
}

void ConflictData::add_tiles(std::string_view text) {
  tiles_csv_.read(text, [this](const CsvLines::Cells& cells) {
    const char* const first = cells[kPort].data();
    const std::string_view cause(first, static_cast<std::size_t>(cells[kPort + 3].data() - 1 - first));
    auto found = stalls_.find(cause);
    if (found == stalls_.end()) found = stalls_.emplace(cause, 1 + grid_.rows * grid_.columns).first;
    std::size_t tile = 0;
    if (!cells[kTileRow].empty()) {
      const std::size_t column = tiles_csv_.number(cells[kTileColumn]) / grid_.columns_of_tile;
      tile = 1 + (line_of(cells[kTileRow]) - 1) * grid_.columns + std::min(column, grid_.columns - 1);
    }
    found->second[tile] += tiles_csv_.number(cells[kPort + 3]);
  });
}

// How many recorded tiles, side by side and one below the other, are one tile of the page.
std::pair<std::size_t, std::size_t> ConflictData::put_together() const {
  const std::size_t most = std::min(kMostTiles, kMostValues / std::max<std::size_t>(1, stalls_.size()));
  std::size_t across = 1;
  std::size_t down = 1;
  while (parts_of(grid_.columns, across) * parts_of(grid_.rows, down) > most)
    (across * grid_.columns_of_tile <= down * grid_.rows_of_tile ? across : down) *= 2;
  return {across, down};
}

std::vector<std::uint64_t> ConflictData::larger_tiles(const std::vector<std::uint64_t>& cycles) const {
  const auto [across, down] = put_together();
  const std::size_t columns = parts_of(grid_.columns, across);
  std::vector<std::uint64_t> sums(columns * parts_of(grid_.rows, down));
  for (std::size_t tile = 0; tile + 1 < cycles.size(); ++tile)
    sums[tile / grid_.columns / down * columns + tile % grid_.columns / across] += cycles[tile + 1];
  return sums;
}

Json ConflictData::rows_json() const {
  std::vector<std::uint64_t> cycles;
  for (const Line& line : lines_) cycles.push_back(line.cycles);
  Json accesses = Json::array();
  for (std::size_t bank = 0; bank < board_.banks.size(); ++bank) {
    for (std::size_t kind = 0; kind < kAccessKindNames.size(); ++kind) {
      std::vector<std::uint64_t> amounts;
      for (const Line& line : lines_) amounts.push_back(line.accesses[bank][kind]);
      if (std::all_of(amounts.begin(), amounts.end(), [](std::uint64_t amount) { return amount == 0; }))
        continue;
      accesses.push_back(
          {{"bank", board_.banks[bank].name}, {"by", kAccessKindNames[kind]}, {"accesses", packed(amounts)}});
    }
  }
  return {{"lines", grid_.rows},
          {"height", grid_.rows_of_tile},
          {"cycles", packed(cycles)},
          {"accesses", std::move(accesses)}};
}

Json ConflictData::stall_json(const std::string& cause, const std::vector<std::uint64_t>& cycles) const {
  const std::size_t port_end = cause.find(',');
  const std::size_t bank_end = cause.rfind(',');
  std::vector<std::uint64_t> rows = {cycles[0]};
  for (auto row = cycles.begin() + 1; row != cycles.end(); row += static_cast<std::ptrdiff_t>(grid_.columns))
    rows.push_back(std::accumulate(row, row + static_cast<std::ptrdiff_t>(grid_.columns), std::uint64_t{0}));
  return {{"port", cause.substr(0, port_end)},
          {"bank", cause.substr(port_end + 1, bank_end - port_end - 1)},
          {"by", cause.substr(bank_end + 1)},
          {"rows", packed(rows)},
          {"tiles", packed(larger_tiles(cycles))}};
}

Json ConflictData::json() const {
  const auto [across, down] = put_together();
  Json stalls = Json::array();
  for (const auto& [cause, cycles] : stalls_) stalls.push_back(stall_json(cause, cycles));
  return {{"frames", frames_},
          {"rows", rows_json()},
          {"tiles",
           {{"columns", parts_of(grid_.columns, across)},
            {"rows", parts_of(grid_.rows, down)},
            {"width", across * grid_.columns_of_tile},
            {"height", down * grid_.rows_of_tile}}},
          {"stalls", std::move(stalls)}};
}

}  // namespace stereotlm::report
