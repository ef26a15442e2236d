#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "models/fpga/conflict_recorder.h"
#include "platform/config/board_config.h"
#include "sw/report/page_data/csv_lines.h"

namespace stereotlm::report {

// Where in the picture the ports stall, for a page: sums over all frames of rows.csv and conflicts.csv.
class ConflictData {
 public:
  // Values of all maps of stalls together, and of one map, in a page. Tiles are put together until a map has
  // no more.
  static constexpr std::size_t kMostValues = 100'000;
  static constexpr std::size_t kMostTiles = 20'000;

  explicit ConflictData(const platform::BoardConfig& board);

  // Whole lines of the files, in their order. They throw as CsvLines does.
  void add_rows(std::string_view text);
  void add_tiles(std::string_view text);
  // The parts `frames`, `rows`, `tiles` and `stalls` of a recording.
  nlohmann::ordered_json json() const;

 private:
  struct Line {
    std::uint64_t cycles = 0;
    std::vector<fpga::FrameConflicts::BankAccesses> accesses;  // [bank]
  };

  std::size_t line_of(std::string_view first_row) const;
  std::pair<std::size_t, std::size_t> put_together() const;
  nlohmann::ordered_json rows_json() const;
  nlohmann::ordered_json stall_json(const std::string& cause, const std::vector<std::uint64_t>& cycles) const;
  // Sums over rectangles of tiles.
  std::vector<std::uint64_t> larger_tiles(const std::vector<std::uint64_t>& cycles) const;

  const platform::BoardConfig& board_;
  fpga::TileGrid grid_;
  CsvLines rows_csv_;
  CsvLines tiles_csv_;
  std::uint64_t frames_ = 0;
  std::vector<Line> lines_;  // [0]: the fill, before the first line of tiles
  // ["port,bank,by"][tile]; [0]: the fill
  std::map<std::string, std::vector<std::uint64_t>, std::less<>> stalls_;
};

}  // namespace stereotlm::report
