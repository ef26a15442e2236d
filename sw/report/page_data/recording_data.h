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

#include "models/fpga/record/conflict_recorder.h"
#include "platform/audit.h"
#include "platform/config/board_config.h"
#include "platform/conflicts.h"
#include "platform/statistics.h"
#include "platform/timeline_records.h"

namespace stereotlm::report {

// Reads the lines of a CSV file that `run --record` has written, which quotes nothing. All functions throw
// std::runtime_error if something is not as `run` writes it: "PATH:LINE: column = value: rule".
class CsvLines {
 public:
  // `head`: the first line, which all others must equal in the number of cells.
  CsvLines(std::string path, const std::string& head);

  // Reads whole lines, those of the head first, and calls `line` for each behind the head.
  void read(std::string_view text, const std::function<void()>& line);
  // To be called at the end of the file, with the identities of the whole file. They name its last line.
  void finish(const platform::Audit& audit) const;

  // Of the line that `line` has been called for. Columns count from 0.
  std::string_view cell(std::size_t column) const { return cells_[column]; }
  // The text of several cells, with the commas between them.
  std::string_view cells(std::size_t first, std::size_t count) const;
  std::uint64_t number(std::size_t column, std::uint64_t most = INT64_MAX, std::uint64_t least = 0) const;
  // The index of the cell among the names.
  std::size_t index(std::size_t column, const std::vector<std::string>& names) const;
  [[noreturn]] void refuse(std::size_t column, const std::string& rule) const;

 private:
  void split(std::string_view line);
  [[noreturn]] void fail(const std::string& text) const;

  std::string path_;
  std::string head_;
  std::vector<std::string> names_;  // of the columns
  std::uint64_t line_ = 0;          // number of the line that is read; the first is 1
  std::vector<std::string_view> cells_;
};

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
  platform::ConflictSums sums_;
  std::vector<Line> lines_;  // [0]: the fill, before the first line of tiles
  // ["port,bank,by"][tile]; [0]: the fill
  std::map<std::string, std::vector<std::uint64_t>, std::less<>> stalls_;
};

// What happens when in the computer, for a page: events and latencies of timeline.csv and latency.csv. The
// events of a long run are those of three periods; sums cover all of it.
class TimelineData {
 public:
  static constexpr std::size_t kMostEvents = 4000;  // in a page, about
  static constexpr std::size_t kMostLatencies = 1000;
  static constexpr std::size_t kBins = 300;  // of the overview

  // `folder`: that of the files, for messages. `board` outlives this object.
  TimelineData(const platform::BoardConfig& board, const std::filesystem::path& folder);

  // Whole lines of the files, in their order. They throw as CsvLines does.
  void add_events(std::string_view text);
  void add_latencies(std::string_view text);
  // Checks the identities of the whole files with the figures of their run. Throws as CsvLines does.
  void check(const platform::Statistics& statistics) const;
  // The parts `events`, `overview`, `waits` and `latency` of a recording.
  nlohmann::ordered_json json() const;

 private:
  using Period = std::pair<std::uint64_t, std::uint64_t>;  // ps
  using Latency =
      std::array<std::uint64_t, platform::kLatencyParts.size() + 4>;  // the columns of latency.csv

  platform::TimelineEvent event_of_line() const;
  std::uint64_t end_ps() const { return events_.empty() ? 0 : events_.back().end_ps; }
  std::vector<Period> periods() const;
  nlohmann::ordered_json events_json() const;
  nlohmann::ordered_json overview_json() const;
  nlohmann::ordered_json waits_json() const;
  nlohmann::ordered_json latency_json() const;

  CsvLines events_csv_;
  CsvLines latencies_csv_;
  const platform::BoardConfig& board_;
  std::vector<platform::TimelineEvent> events_;  // by their ends
  std::vector<Latency> latencies_;
};

// The part `recording` of a page's data: the files that `run --record` writes, as sums and as a limited
// number of events, so that the page stays small however long the run is.
class RecordingData {
 public:
  // `camera`: with the time line of a computer. `folder`: that of the files, for messages. `board` outlives
  // this object.
  RecordingData(const platform::BoardConfig& board, bool camera, const std::filesystem::path& folder = {});

  // Whole lines of one of the files, in their order; without a time line those of the conflicts. Throws as
  // CsvLines does.
  void add(const std::string& name, std::string_view text);
  // Adds the files of the folder, and checks their identities with the figures of the run. Throws as CsvLines
  // does. Returns false, and adds nothing, if they are not there.
  bool add_folder(const platform::Statistics& statistics);

  nlohmann::ordered_json json() const;

 private:
  std::filesystem::path folder_;
  ConflictData conflicts_;
  std::optional<TimelineData> timeline_;
};

}  // namespace stereotlm::report
