#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "models/fpga/conflict_recorder.h"
#include "platform/config/board_config.h"
#include "platform/conflicts.h"
#include "platform/statistics.h"
#include "sw/report/page_data/csv_lines.h"

namespace stereotlm::report {

// Where in the picture the ports stall, for a page: sums over all frames of rows.csv and conflicts.csv.
class ConflictData {
 public:
  // Values of all maps of stalls together, and of one map, in a page. Tiles are put together until a map has
  // no more.
  static constexpr std::size_t kMostValues = 100'000;
  static constexpr std::size_t kMostTiles = 20'000;

  // `folder`: that of the files, for messages.
  ConflictData(const platform::BoardConfig& board, const std::filesystem::path& folder);

  // Whole lines of the files, in their order. They throw as CsvLines does.
  void add_rows(std::string_view text);
  void add_tiles(std::string_view text);
  // Checks the identities of the whole files with the figures of their run. Throws as CsvLines does.
  void check(const platform::Statistics& statistics);
  // The parts `frames`, `rows`, `tiles` and `stalls` of a recording.
  nlohmann::ordered_json json() const;

 private:
  struct Line {
    std::uint64_t cycles = 0;                                        // in rows.csv
    std::uint64_t tile_cycles = 0;                                   // in conflicts.csv
    std::vector<fpga::FrameConflicts::BankAccesses> accesses;        // [bank]
    std::array<std::uint64_t, fpga::kRequesters> stalls{};           // [requester]: in rows.csv
    std::array<std::uint64_t, fpga::kRequesters> stalls_of_tiles{};  // [requester]: in conflicts.csv
  };

  std::size_t tile_of_line() const;
  std::pair<std::size_t, std::size_t> put_together() const;
  nlohmann::ordered_json rows_json() const;
  nlohmann::ordered_json stall_json(const std::string& cause, const std::vector<std::uint64_t>& cycles) const;
  // Sums over rectangles of tiles.
  std::vector<std::uint64_t> larger_tiles(const std::vector<std::uint64_t>& cycles) const;

  const platform::BoardConfig& board_;
  fpga::TileGrid grid_;
  CsvLines rows_csv_;
  CsvLines tiles_csv_;
  // Names in conflicts.csv.
  std::vector<std::string> requesters_;
  std::vector<std::string> banks_;
  std::vector<std::string> causes_;
  std::vector<std::string> strips_;          // the cells of their rows in rows.csv; [0]: the fill
  std::uint64_t row_lines_ = 0;              // lines of rows.csv
  std::vector<std::uint64_t> frame_cycles_;  // [frame]: cycles of its lines
  // The tile and the cause of the last line of conflicts.csv.
  std::optional<std::pair<std::size_t, std::array<std::size_t, 3>>> last_place_;
  std::uint64_t tile_cycles_ = 0;  // of that line
  platform::ConflictSums sums_;
  std::vector<Line> lines_;  // [0]: the fill, before the first line of tiles
  // ["port,bank,by"][tile]; [0]: the fill
  std::map<std::string, std::vector<std::uint64_t>, std::less<>> stalls_;
};

}  // namespace stereotlm::report
