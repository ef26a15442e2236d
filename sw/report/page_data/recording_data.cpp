#include "sw/report/page_data/recording_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "models/fpga/frame_geometry.h"
#include "models/fpga/record/conflict_recorder.h"
#include "platform/figures/audit.h"
#include "platform/figures/bounds.h"
#include "platform/figures/derived_figures.h"
#include "platform/records/conflicts.h"
#include "platform/records/timeline_records.h"
#include "sw/runs/run_results.h"
#include "sw/stats/record_csv.h"
#include "sw/stats/stats_json.h"

namespace stereotlm::report {
namespace {

using Json = nlohmann::ordered_json;
using Amounts = std::vector<std::uint64_t>;

}  // namespace

// Reads the lines of a CSV file that `run` has recorded, which quotes nothing.
class CsvLines {
 public:
  // `head`: the first line, which all others must equal in the number of cells.
  CsvLines(std::string path, const std::string& head)
      : path_(std::move(path)), head_(head.substr(0, head.find('\n'))) {
    split(head_);
    names_.assign(cells_.begin(), cells_.end());
  }

  // Reads whole lines, those of the head first, and calls `line` for each behind the head.
  void read(std::string_view text, const std::function<void()>& line) {
    while (!text.empty()) {
      const std::size_t size = text.find('\n');
      ++line_;
      if (size == std::string_view::npos) fail("must end with a newline");
      std::string_view next = text.substr(0, size);
      text.remove_prefix(size + 1);
      if (!next.empty() && next.back() == '\r') next.remove_suffix(1);               // an editor has added it
      if (line_ == 1 && next.substr(0, 3) == "\xEF\xBB\xBF") next.remove_prefix(3);  // byte order mark
      if (line_ == 1) {
        if (next != head_) fail(fmt::format("must be the head '{}'", head_));
        continue;
      }
      split(next);
      if (cells_.size() != names_.size())
        fail(fmt::format("{} cells: must be {}, as in the head", cells_.size(), names_.size()));
      line();
    }
  }
  // To be called at the end of the file, with the identities of the whole file. They name its last line.
  void finish(const platform::Audit& audit) const {
    if (line_ == 0) throw std::runtime_error(fmt::format("{}:1: missing: the head '{}'", path_, head_));
    if (!audit.failed().empty()) fail(audit.failed().front());
  }

  const std::vector<std::string>& names() const { return names_; }
  // Of the line that `line` has been called for. Columns count from 0.
  std::string_view cell(std::size_t column) const { return cells_[column]; }
  // The text of several cells, with the commas between them.
  std::string_view cells(std::size_t first, std::size_t count) const {
    const std::string_view& last = cells_[first + count - 1];
    const char* const begin = cells_[first].data();
    return {begin, static_cast<std::size_t>(last.data() + last.size() - begin)};
  }
  std::uint64_t number(std::size_t column, std::uint64_t most = INT64_MAX, std::uint64_t least = 0) const {
    const std::string_view cell = cells_[column];
    std::uint64_t number = 0;
    if (cell != "0") {  // most are
      const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), number);
      if (error != std::errc() || end != cell.data() + cell.size() || cell.front() == '0')
        number = UINT64_MAX;
    }
    if (number < least || number > most)
      refuse(column, fmt::format("must be an integer of {}..{}", least, most));
    return number;
  }
  // The index of the cell among the names.
  std::size_t index(std::size_t column, const std::vector<std::string>& names) const {
    const auto found = std::find(names.begin(), names.end(), cells_[column]);
    if (found == names.end()) refuse(column, fmt::format("must be one of {}", fmt::join(names, ", ")));
    return static_cast<std::size_t>(found - names.begin());
  }
  [[noreturn]] void refuse(std::size_t column, const std::string& rule) const {
    fail(fmt::format("{} = {}: {}", names_[column], cells_[column], rule));
  }

 private:
  void split(std::string_view line) {
    cells_.clear();
    std::size_t end = 0;
    do {
      end = line.find(',');
      cells_.push_back(line.substr(0, end));
      if (end != std::string_view::npos) line.remove_prefix(end + 1);
    } while (end != std::string_view::npos);
  }
  [[noreturn]] void fail(const std::string& text) const {
    throw std::runtime_error(fmt::format("{}:{}: {}", path_, line_, text));
  }

  std::string path_;
  std::string head_;
  std::vector<std::string> names_;  // of the columns
  std::uint64_t line_ = 0;          // number of the line that is read; the first is 1
  std::vector<std::string_view> cells_;
};

namespace {

// Columns of rows.csv, conflicts.csv, timeline.csv and latency.csv.
enum RowColumn : std::size_t { kFrameOfRow, kFirstRow, kCycles = 3, kFirstStalls };
enum TileColumn : std::size_t { kTileRow, kTileColumn = 2, kTileCycles = 4, kPort, kBank, kBy, kStalls };
enum EventColumn : std::size_t { kKind, kClass, kFrame, kCameraFrame, kStart, kEnd, kWords, kPixels, kWhy };
enum LatencyColumn : std::size_t { kLatencyFrame, kLatencyCameraFrame, kCaptured, kFirstPart };

std::size_t parts_of(std::size_t whole, std::size_t part) { return (whole + part - 1) / part; }

const char* name_of(platform::EventKind kind) {
  return platform::kEventKindNames[static_cast<std::size_t>(kind)];
}

// -1: none.
std::int64_t number_of(const std::optional<std::uint64_t>& frame) {
  return frame ? static_cast<std::int64_t>(*frame) : -1;
}

double real(std::uint64_t number) { return static_cast<double>(number); }

}  // namespace

// Where in the picture the ports stall: sums over all recorded frames, of rows.csv and conflicts.csv. A line
// is a line of tiles; [0] is the fill, before the first one.
class ConflictData {
 public:
  ConflictData(const platform::BoardConfig& board, const std::filesystem::path& folder)
      : board_(board),
        grid_(fpga::FrameGeometry(platform::core_config(board)), fpga::ConflictRecorder::kMostTiles),
        rows_csv_((folder / "rows.csv").string(), stats::rows_csv_head(board)),
        tiles_csv_((folder / "conflicts.csv").string(), stats::conflicts_csv_head()),
        strips_(1, ","),
        cycles_(1 + grid_.rows),
        accesses_(board.banks.size() * kKinds, cycles_) {
    const auto rows = static_cast<std::size_t>(board.matcher.rows);
    for (std::size_t strip = 0; strip < parts_of(static_cast<std::size_t>(board.image.height), rows); ++strip)
      strips_.push_back(stats::csv_range(strip, rows, board.image.height));
    for (const platform::BankConfig& bank : board.banks) banks_.push_back(bank.name);
    const fpga::Requesters requesters(platform::core_ports(board));
    for (std::size_t cause = 0; cause < requesters.causes(); ++cause)
      causes_.push_back(requesters.name(cause));
    requesters_.assign(causes_.begin(), causes_.begin() + static_cast<std::ptrdiff_t>(requesters.size()));
    stalls_.assign(requesters.size(), cycles_);
    stalls_of_tiles_ = stalls_;
    sums_.stalls.resize(requesters.size());
    sums_.accesses.resize(banks_.size());
  }

  void add_rows(std::string_view text) {
    rows_csv_.read(text, [this] {
      const std::size_t strip = row_lines_++ % strips_.size();
      if (strip == 0) frame_cycles_.push_back(0);
      rows_csv_.number(kFrameOfRow, frame_cycles_.size() - 1, frame_cycles_.size() - 1);
      if (rows_csv_.cells(kFirstRow, 2) != strips_[strip])
        rows_csv_.refuse(kFirstRow, fmt::format("must be the rows '{}' of the next line", strips_[strip]));
      const std::size_t line = strip == 0 ? 0 : 1 + (strip - 1) / grid_.strips_of_tile;
      const std::uint64_t cycles = rows_csv_.number(kCycles);
      frame_cycles_.back() += cycles;
      cycles_[line] += cycles;
      std::size_t column = kFirstStalls;
      for (std::size_t requester = 0; requester < requesters_.size(); ++requester) {
        const std::uint64_t stalls = rows_csv_.number(column++, cycles);
        stalls_[requester][line] += stalls;
        sums_.stalls[requester] += stalls;
      }
      for (std::size_t i = 0; i < accesses_.size(); ++i) {
        const std::uint64_t accesses = rows_csv_.number(column++, 2 * cycles);
        accesses_[i][line] += accesses;
        sums_.accesses[i / kKinds] += accesses;
      }
    });
  }

  void add_tiles(std::string_view text) {
    tiles_csv_.read(text, [this] {
      const std::size_t tile = tile_of_line();
      const std::array<std::size_t, 3> cause = {tiles_csv_.index(kPort, requesters_),
                                                tiles_csv_.index(kBank, banks_),
                                                tiles_csv_.index(kBy, causes_)};
      const std::uint64_t cycles = tiles_csv_.number(kStalls, tiles_csv_.number(kTileCycles), 1);
      sums_.blame[cause] += cycles;
      stalls_of_tiles_[cause[0]][tile == 0 ? 0 : 1 + (tile - 1) / grid_.columns] += cycles;
      const std::string_view name = tiles_csv_.cells(kPort, 3);
      auto found = tiles_.find(name);
      if (found == tiles_.end()) found = tiles_.emplace(name, 1 + grid_.rows * grid_.columns).first;
      found->second[tile] += cycles;
    });
  }

  // Whether the run may have recorded only its first frames.
  bool may_be_part() const { return frame_cycles_.size() == runs::kRecordedFrames; }

  // Checks the identities of the whole files with the figures of their run.
  void check(const platform::Statistics& statistics) {
    const bool is_part = may_be_part() && frame_cycles_.size() < statistics.frames;
    platform::Audit audit;
    sums_.frames = frame_cycles_.size();
    const auto pipeline = static_cast<std::uint64_t>(board_.fpga.pipeline_latency_cycles);
    for (std::size_t frame = 0; frame < std::min(sums_.frames, statistics.frames); ++frame) {
      audit.equal(fmt::format("recorded: cycles of frame {}", frame), frame_cycles_[frame] + pipeline,
                  "frame_cycles", statistics.frame_cycles[frame]);
      sums_.cycles += frame_cycles_[frame];
    }
    if (!is_part) sums_.check_rows(fpga::Requesters(platform::core_ports(board_)), statistics, audit);
    rows_csv_.finish(audit);
    platform::Audit of_tiles;
    if (!is_part) sums_.check_tiles(fpga::Requesters(platform::core_ports(board_)), statistics, of_tiles);
    for (std::size_t line = 0; line < cycles_.size(); ++line) {
      const std::string name =
          line == 0 ? "recorded: fill" : fmt::format("recorded: row {} of tiles", line - 1);
      for (std::size_t requester = 0; requester < requesters_.size(); ++requester) {
        of_tiles.equal(fmt::format("{}: stalls of {}", name, requesters_[requester]),
                       stalls_of_tiles_[requester][line], "those in rows.csv", stalls_[requester][line]);
      }
    }
    tiles_csv_.finish(of_tiles);
  }

  Json json() const {
    constexpr std::array<const char*, kKinds> kKindNames = {"core", "capture", "upload", "read-back"};
    Json accesses = Json::array();
    for (std::size_t i = 0; i < accesses_.size(); ++i) {
      if (std::all_of(accesses_[i].begin(), accesses_[i].end(), [](std::uint64_t each) { return each == 0; }))
        continue;
      accesses.push_back(
          {{"bank", banks_[i / kKinds]}, {"by", kKindNames[i % kKinds]}, {"accesses", accesses_[i]}});
    }
    const std::size_t most = std::min(RecordingData::kMostTiles,
                                      RecordingData::kMostValues / std::max<std::size_t>(1, tiles_.size()));
    // Its tiles are `across` recorded ones wide and `down` high.
    const fpga::TileGrid shown(fpga::FrameGeometry(platform::core_config(board_)), most);
    const std::size_t across = shown.columns_of_tile / grid_.columns_of_tile;
    const std::size_t down = shown.rows_of_tile / grid_.rows_of_tile;
    Json stalls = Json::array();
    for (const auto& [cause, cycles] : tiles_) {
      Amounts by_line(cycles_.size());
      Amounts by_tile(shown.columns * shown.rows);
      by_line[0] = cycles[0];
      for (std::size_t tile = 0; tile + 1 < cycles.size(); ++tile) {
        by_line[1 + tile / grid_.columns] += cycles[tile + 1];
        by_tile[tile / grid_.columns / down * shown.columns + tile % grid_.columns / across] +=
            cycles[tile + 1];
      }
      const std::size_t bank = cause.find(',') + 1;
      const std::size_t by = cause.rfind(',') + 1;
      stalls.push_back({{"port", cause.substr(0, bank - 1)},
                        {"bank", cause.substr(bank, by - bank - 1)},
                        {"by", cause.substr(by)},
                        {"rows", by_line},
                        {"tiles", by_tile}});
    }
    return {{"frames", frame_cycles_.size()},
            {"rows",
             {{"lines", grid_.rows},
              {"height", grid_.rows_of_tile},
              {"cycles", cycles_},
              {"accesses", std::move(accesses)}}},
            {"tiles",
             {{"columns", shown.columns},
              {"rows", shown.rows},
              {"width", shown.columns_of_tile},
              {"height", shown.rows_of_tile}}},
            {"stalls", std::move(stalls)}};
  }

 private:
  static constexpr std::size_t kKinds = fpga::FrameConflicts::kAccessKinds;

  // The tile that the line is of.
  std::size_t tile_of_line() const {
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

  const platform::BoardConfig& board_;
  fpga::TileGrid grid_;
  CsvLines rows_csv_;
  CsvLines tiles_csv_;
  // Names in conflicts.csv.
  std::vector<std::string> requesters_;
  std::vector<std::string> banks_;
  std::vector<std::string> causes_;
  std::vector<std::string> strips_;  // the cells of their rows in rows.csv; [0]: the fill
  std::uint64_t row_lines_ = 0;      // lines of rows.csv
  Amounts frame_cycles_;             // [frame]: cycles of its lines
  platform::ConflictSums sums_;
  Amounts cycles_;                                     // [line]
  std::vector<Amounts> accesses_;                      // [bank and kind][line]
  std::vector<Amounts> stalls_;                        // [requester][line], in rows.csv
  std::vector<Amounts> stalls_of_tiles_;               // the same in conflicts.csv
  std::map<std::string, Amounts, std::less<>> tiles_;  // ["port,bank,by"][tile]; [0]: the fill
};

// What happens when in the computer: events and latencies of timeline.csv and latency.csv. The events of a
// long run are those of three periods; sums cover all of it.
class TimelineData {
 public:
  TimelineData(const platform::BoardConfig& board, const std::filesystem::path& folder)
      : events_csv_((folder / "timeline.csv").string(), stats::timeline_csv_head()),
        latencies_csv_((folder / "latency.csv").string(), stats::latency_csv_head()),
        board_(board) {}

  void add_events(std::string_view text) {
    events_csv_.read(text, [this] {
      const auto number = [this](EventColumn column, std::uint64_t least = 0) {
        return events_csv_.number(column, INT64_MAX, least);
      };
      const auto number_if_any = [&](EventColumn column) {
        return events_csv_.cell(column).empty() ? std::nullopt : std::optional(number(column));
      };
      platform::TimelineEvent event = event_of_line();
      event.frame = number_if_any(kFrame);
      event.camera_frame = number_if_any(kCameraFrame);
      event.begin_ps = number(kStart);
      event.end_ps = number(kEnd, std::max(event.begin_ps, end_ps()));
      const bool is_capture = event.kind == platform::EventKind::kCapture;
      const bool moves = is_capture || event.kind == platform::EventKind::kUpload ||
                         event.kind == platform::EventKind::kReadBack || events_csv_.cell(kClass) == "cycles";
      event.words = events_csv_.number(kWords, moves ? INT64_MAX : 0);
      event.dropped_pixels = events_csv_.number(kPixels, is_capture ? INT64_MAX : 0);
      events_.push_back(event);
    });
  }

  void add_latencies(std::string_view text) {
    latencies_csv_.read(text, [this] {
      Latency latency;
      for (std::size_t column = 0; column < latency.size(); ++column)
        latency[column] = latencies_csv_.number(column);
      latencies_csv_.number(kLatencyFrame, latencies_.size(), latencies_.size());
      const std::uint64_t sum =
          std::accumulate(latency.begin() + kFirstPart, latency.end() - 1, std::uint64_t{0});
      latencies_csv_.number(latency.size() - 1, sum, sum);
      latencies_.push_back(latency);
    });
  }

  // `may_be_part`: whether the events may end before those of the run.
  void check(const platform::Statistics& statistics, bool may_be_part) const {
    platform::Audit of_latencies;
    of_latencies.equal("recorded: latencies", latencies_.size(), "frames", statistics.frames);
    latencies_csv_.finish(of_latencies);
    platform::Audit of_events;
    platform::TimelineSums sums(board_);
    for (const platform::TimelineEvent& event : events_) {
      sums.add(event);
      if (!event.frame || *event.frame >= latencies_.size()) continue;
      of_events.equal(fmt::format("recorded: frame {}: camera_frame", *event.frame),
                      event.camera_frame.value_or(UINT64_MAX), "that in latency.csv",
                      latencies_[static_cast<std::size_t>(*event.frame)][kLatencyCameraFrame]);
    }
    if (!may_be_part) sums.check(statistics, of_events);
    events_csv_.finish(of_events);
    std::vector<platform::Delivery> deliveries;
    for (const Latency& latency : latencies_)
      deliveries.push_back({latency[kCaptured], latency[kCaptured] + latency.back()});
    platform::Statistics derived = statistics;
    platform::derive_delivery_figures(deliveries, platform::allocation_period_frames(board_), derived);
    platform::Audit of_figures;
    for (const std::string& difference :
         stats::stats_differences(stats::stats_json(statistics, {}), stats::stats_json(derived, {}),
                                  "stats.json", "from the latencies"))
      of_figures.fail("recorded: " + difference);
    latencies_csv_.finish(of_figures);
  }

  std::uint64_t last_camera_frame() const { return latencies_.back()[kLatencyCameraFrame]; }

  Json json() const {
    return {{"events", events_json()}, {"waits", waits_json()}, {"latency", latency_json()}};
  }

 private:
  using Period = std::pair<std::uint64_t, std::uint64_t>;  // ps
  using Latency =
      std::array<std::uint64_t, platform::kLatencyParts.size() + 4>;  // the columns of latency.csv

  std::uint64_t end_ps() const { return events_.empty() ? 0 : events_.back().end_ps; }

  // An event with the names of the line.
  platform::TimelineEvent event_of_line() const {
    const std::string_view kind = events_csv_.cell(kKind);
    const std::string_view why = events_csv_.cell(kWhy);
    for (const platform::EventName& known : platform::kEventNames) {
      if (kind == name_of(known.kind) && events_csv_.cell(kClass) == known.what && why == known.why)
        return {known.kind, known.what, {}, {}, 0, 0, 0, 0, known.why};
    }
    events_csv_.refuse(kClass, fmt::format("must be a class of {} with why = {}", kind, why));
  }

  // The periods to show: all of a run with few events; else its beginning, the time around its slowest frame,
  // and its end, which may overlap.
  std::vector<Period> periods() const {
    if (events_.size() <= RecordingData::kMostEvents) return {{0, end_ps()}};
    constexpr std::size_t kPart = RecordingData::kMostEvents / 3;
    const auto end_of = [this](std::size_t event) {
      return events_[std::min(event, events_.size() - 1)].end_ps;
    };
    std::vector<Period> found = {{0, end_of(kPart)}, {end_of(events_.size() - kPart), end_ps()}};
    const auto slowest =
        std::max_element(latencies_.begin(), latencies_.end(),
                         [](const Latency& a, const Latency& b) { return a.back() < b.back(); });
    if (slowest != latencies_.end()) {
      const std::uint64_t middle_ps = (*slowest)[kCaptured] + slowest->back() / 2;
      const auto at = std::lower_bound(
          events_.begin(), events_.end(), middle_ps,
          [](const platform::TimelineEvent& event, std::uint64_t time_ps) { return event.end_ps < time_ps; });
      const auto middle = static_cast<std::size_t>(at - events_.begin());
      found.emplace_back(end_of(middle - std::min(middle, kPart / 2)), end_of(middle + kPart / 2));
    }
    std::sort(found.begin(), found.end());
    return found;
  }

  Json events_json() const {
    const std::vector<Period> shown = periods();
    Json rows = Json::array();
    for (const platform::TimelineEvent& event : events_) {
      const bool is_shown = std::any_of(shown.begin(), shown.end(), [&event](const Period& period) {
        return event.end_ps >= period.first && event.begin_ps <= period.second;
      });
      if (is_shown) {
        rows.push_back({name_of(event.kind), event.what, number_of(event.frame),
                        number_of(event.camera_frame), event.begin_ps, event.end_ps, event.words,
                        event.dropped_pixels, event.why});
      }
    }
    Json json = {{"names", events_csv_.names()}, {"rows", std::move(rows)}, {"all", events_.size()}};
    json["periods_ps"] = Json::array();
    for (const auto& [begin, end] : shown) json["periods_ps"].push_back({begin, end});
    return json;
  }

  // The sums of all recorded waits, by who waits and why.
  Json waits_json() const {
    std::map<std::pair<std::string, std::string>, std::uint64_t> sums;
    for (const platform::TimelineEvent& event : events_) {
      if (event.kind == platform::EventKind::kWait)
        sums[{event.what, event.why}] += event.end_ps - event.begin_ps;
    }
    Json json = Json::array();
    for (const auto& [name, sum_ps] : sums)
      json.push_back({{"class", name.first}, {"why", name.second}, {"ps", sum_ps}});
    return json;
  }

  // At most kMostLatencies frames. Of more, they are chosen at equal distances in the order of the latency,
  // with the least and the greatest.
  Json latency_json() const {
    std::vector<const Latency*> order;
    for (const Latency& latency : latencies_) order.push_back(&latency);
    std::stable_sort(order.begin(), order.end(),
                     [](const Latency* a, const Latency* b) { return a->back() < b->back(); });
    const std::size_t rows = std::min(order.size(), RecordingData::kMostLatencies);
    const std::vector<std::string> names = latencies_csv_.names();
    Json shown = Json::array();
    for (std::size_t row = 0; row < rows; ++row)
      shown.push_back(*order[rows < 2 ? row : row * (order.size() - 1) / (rows - 1)]);
    Json means = Json::object();
    for (std::size_t column = kFirstPart; column < names.size(); ++column) {
      double sum = 0;
      for (const Latency& latency : latencies_) sum += real(latency[column]);
      means[names[column]] = sum / real(std::max<std::size_t>(1, latencies_.size()));
    }
    return {{"names", names}, {"rows", std::move(shown)}, {"all", latencies_.size()}, {"means_ps", means}};
  }

  CsvLines events_csv_;
  CsvLines latencies_csv_;
  const platform::BoardConfig& board_;
  std::vector<platform::TimelineEvent> events_;  // by their ends
  std::vector<Latency> latencies_;
};

RecordingData::RecordingData(const platform::BoardConfig& board, bool camera,
                             const std::filesystem::path& folder)
    : folder_(folder),
      conflicts_(std::make_unique<ConflictData>(board, folder)),
      timeline_(camera ? std::make_unique<TimelineData>(board, folder) : nullptr) {}

RecordingData::~RecordingData() = default;

void RecordingData::add(const std::string& name, std::string_view text) {
  if (name == "rows.csv") conflicts_->add_rows(text);
  if (name == "conflicts.csv") conflicts_->add_tiles(text);
  if (timeline_ && name == "timeline.csv") timeline_->add_events(text);
  if (timeline_ && name == "latency.csv") timeline_->add_latencies(text);
}

bool RecordingData::add_folder(const platform::Statistics& statistics) {
  std::vector<std::string> names = {"rows.csv", "conflicts.csv"};
  if (timeline_) names.insert(names.end(), {"timeline.csv", "latency.csv"});
  for (const std::string& name : names) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(folder_ / name, ignored)) return false;
  }
  for (const std::string& name : names) {
    std::ifstream file(folder_ / name, std::ios::binary);
    for (std::string line; std::getline(file, line);) add(name, file.eof() ? line : line + '\n');
  }
  check(statistics);
  return true;
}

void RecordingData::check(const platform::Statistics& statistics) const {
  conflicts_->check(statistics);
  if (timeline_) timeline_->check(statistics, conflicts_->may_be_part());
}

std::uint64_t RecordingData::last_camera_frame() const { return timeline_->last_camera_frame(); }

Json RecordingData::json() const {
  Json json = conflicts_->json();
  if (timeline_) json.update(timeline_->json());
  return json;
}

}  // namespace stereotlm::report
