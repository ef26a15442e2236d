#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <numeric>

#include "models/fpga/frame_geometry.h"
#include "platform/audit.h"
#include "sw/report/page_data/recording_data.h"
#include "sw/stats/record_csv.h"

namespace stereotlm::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<const char*, fpga::FrameConflicts::kAccessKinds> kAccessKindNames = {
    "core", "capture", "upload", "read-back"};

// Columns of rows.csv and of conflicts.csv.
enum RowColumn : std::size_t { kFrameOfRow, kFirstRow, kLastRow, kCycles, kFirstStalls };
enum TileColumn : std::size_t {
  kTileRow,
  kTileLastRow,
  kTileColumn,
  kTileLastColumn,
  kTileCycles,
  kPort,
  kBank,
  kBy,
  kStalls
};

std::size_t parts_of(std::size_t whole, std::size_t part) { return (whole + part - 1) / part; }

}  // namespace

ConflictData::ConflictData(const platform::BoardConfig& board, const std::filesystem::path& folder)
    : board_(board),
      grid_(fpga::FrameGeometry(platform::core_config(board)), fpga::ConflictRecorder::kMostTiles),
      rows_csv_((folder / "rows.csv").string(), stats::rows_csv_head(board)),
      tiles_csv_((folder / "conflicts.csv").string(), stats::conflicts_csv_head()),
      strips_(1, ","),
      lines_(1 + grid_.rows) {
  const auto rows = static_cast<std::size_t>(board.matcher.rows);
  for (std::size_t strip = 0; strip < parts_of(static_cast<std::size_t>(board.image.height), rows); ++strip)
    strips_.push_back(stats::csv_range(strip, rows, board.image.height));
  for (Line& line : lines_) line.accesses.resize(board.banks.size());
  for (const platform::BankConfig& bank : board.banks) banks_.push_back(bank.name);
  for (std::size_t requester = 0; requester < fpga::kRequesters; ++requester)
    requesters_.emplace_back(fpga::requester_name(requester));
  causes_ = requesters_;
  causes_.emplace_back(fpga::requester_name(fpga::kTurnaroundToBlame));
  sums_.accesses.resize(board.banks.size());
}

void ConflictData::add_rows(std::string_view text) {
  rows_csv_.read(text, [this] {
    const std::size_t strip = row_lines_++ % strips_.size();
    if (strip == 0) frame_cycles_.push_back(0);
    rows_csv_.number(kFrameOfRow, frame_cycles_.size() - 1, frame_cycles_.size() - 1);
    if (rows_csv_.cells(kFirstRow, 2) != strips_[strip])
      rows_csv_.refuse(kFirstRow, fmt::format("must be the rows '{}' of the next line", strips_[strip]));
    Line& line = lines_[strip == 0 ? 0 : 1 + (strip - 1) / grid_.strips_of_tile];
    const std::uint64_t cycles = rows_csv_.number(kCycles);
    frame_cycles_.back() += cycles;
    line.cycles += cycles;
    std::size_t column = kFirstStalls;
    for (std::size_t requester = 0; requester < requesters_.size(); ++requester) {
      const std::uint64_t stalls = rows_csv_.number(column++, cycles);
      line.stalls[requester] += stalls;
      sums_.stalls[requester] += stalls;
    }
    for (std::size_t bank = 0; bank < banks_.size(); ++bank) {
      for (std::uint64_t& of_kind : line.accesses[bank]) {
        const std::uint64_t accesses = rows_csv_.number(column++, 2 * cycles);
        of_kind += accesses;
        sums_.accesses[bank] += accesses;
      }
    }
  });
}

// The tile that the line is of.
std::size_t ConflictData::tile_of_line() const {
  std::size_t tile = 0;
  if (!tiles_csv_.cell(kTileRow).empty()) {
    const auto index = [this](TileColumn column, std::size_t length, std::size_t parts) {
      return tiles_csv_.number(column, length * parts - 1) / length;
    };
    tile = 1 + index(kTileRow, grid_.rows_of_tile, grid_.rows) * grid_.columns +
           index(kTileColumn, grid_.columns_of_tile, grid_.columns);
  }
  const std::string place = stats::csv_tile(board_, grid_, tile);
  if (tiles_csv_.cells(kTileRow, 4) != place)
    tiles_csv_.refuse(kTileRow, fmt::format("must be the place of a tile, such as '{}'", place));
  return tile;
}

void ConflictData::add_tiles(std::string_view text) {
  tiles_csv_.read(text, [this] {
    const std::size_t tile = tile_of_line();
    const std::array<std::size_t, 3> cause = {tiles_csv_.index(kPort, requesters_),
                                              tiles_csv_.index(kBank, banks_),
                                              tiles_csv_.index(kBy, causes_)};
    const std::uint64_t cycles = tiles_csv_.number(kStalls, tiles_csv_.number(kTileCycles), 1);
    sums_.blame[cause] += cycles;
    lines_[tile == 0 ? 0 : 1 + (tile - 1) / grid_.columns].stalls_of_tiles[cause[0]] += cycles;
    const std::string_view name = tiles_csv_.cells(kPort, 3);
    auto found = stalls_.find(name);
    if (found == stalls_.end()) found = stalls_.emplace(name, 1 + grid_.rows * grid_.columns).first;
    found->second[tile] += cycles;
  });
}

void ConflictData::check(const platform::Statistics& statistics) {
  platform::Audit audit;
  sums_.frames = frame_cycles_.size();
  const auto pipeline = static_cast<std::uint64_t>(board_.fpga.pipeline_latency_cycles);
  for (std::size_t frame = 0; frame < std::min(sums_.frames, statistics.frames); ++frame) {
    audit.equal(fmt::format("recorded: cycles of frame {}", frame), frame_cycles_[frame] + pipeline,
                "frame_cycles", statistics.frame_cycles[frame]);
    sums_.cycles += frame_cycles_[frame];
  }
  sums_.check_rows(statistics, audit);
  rows_csv_.finish(audit);
  platform::Audit of_tiles;
  sums_.check_tiles(statistics, of_tiles);
  for (std::size_t row = 0; row < lines_.size(); ++row) {
    const Line& line = lines_[row];
    const std::string name = row == 0 ? "recorded: fill" : fmt::format("recorded: row {} of tiles", row - 1);
    for (std::size_t requester = 0; requester < requesters_.size(); ++requester) {
      of_tiles.equal(fmt::format("{}: stalls of {}", name, requesters_[requester]),
                     line.stalls_of_tiles[requester], "those in rows.csv", line.stalls[requester]);
    }
  }
  tiles_csv_.finish(of_tiles);
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
          {{"bank", board_.banks[bank].name}, {"by", kAccessKindNames[kind]}, {"accesses", amounts}});
    }
  }
  return {{"lines", grid_.rows},
          {"height", grid_.rows_of_tile},
          {"cycles", cycles},
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
          {"rows", rows},
          {"tiles", larger_tiles(cycles)}};
}

Json ConflictData::json() const {
  const auto [across, down] = put_together();
  Json stalls = Json::array();
  for (const auto& [cause, cycles] : stalls_) stalls.push_back(stall_json(cause, cycles));
  return {{"frames", frame_cycles_.size()},
          {"rows", rows_json()},
          {"tiles",
           {{"columns", parts_of(grid_.columns, across)},
            {"rows", parts_of(grid_.rows, down)},
            {"width", across * grid_.columns_of_tile},
            {"height", down * grid_.rows_of_tile}}},
          {"stalls", std::move(stalls)}};
}

}  // namespace stereotlm::report
