#include "sw/stats/record_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstddef>
#include <iterator>
#include <optional>

namespace stereotlm::stats {
namespace {

constexpr std::ptrdiff_t kMostDigits = 20;
constexpr std::array<const char*, fpga::FrameConflicts::kAccessKinds> kAccessNames = {"core", "capture",
                                                                                      "upload", "read_back"};

// Writes a number and a character, and returns the end. Most numbers are 0.
char* put(char* to, std::uint64_t number, char behind) {
  if (number == 0) {
    *to++ = '0';
  } else {
    to = std::to_chars(to, to + kMostDigits, number).ptr;
  }
  *to++ = behind;
  return to;
}

void append(std::string& text, std::uint64_t number, char behind) {
  std::array<char, kMostDigits + 1> bytes;
  text.append(bytes.data(), put(bytes.data(), number, behind));
}

std::string text_of(const std::optional<std::uint64_t>& number) {
  return number ? fmt::to_string(*number) : std::string();
}

}  // namespace

std::string csv_range(std::size_t index, std::size_t length, int whole) {
  const std::size_t last = std::min((index + 1) * length, static_cast<std::size_t>(whole)) - 1;
  return fmt::format("{},{}", index * length, last);
}

std::string rows_csv_head(const platform::BoardConfig& board) {
  std::string text = "frame,first_row,last_row,cycles";
  const fpga::Requesters requesters(platform::core_ports(board));
  for (std::size_t requester = 0; requester < requesters.size(); ++requester) {
    std::string name = requesters.name(requester);
    std::replace_if(
        name.begin(), name.end(), [](char letter) { return letter == ' ' || letter == '-'; }, '_');
    text += fmt::format(",{}_stall_cycles", name);
  }
  for (const platform::BankConfig& bank : board.banks) {
    for (const char* name : kAccessNames) text += fmt::format(",{}_{}_accesses", bank.name, name);
  }
  return text + '\n';
}

std::string rows_csv(const platform::BoardConfig& board, std::uint64_t frame,
                     const fpga::FrameConflicts& conflicts) {
  std::string text;
  const auto rows = static_cast<std::size_t>(board.matcher.rows);
  const std::size_t numbers =
      1 + conflicts.strips.front().stalls.size() + conflicts.banks * fpga::FrameConflicts::kAccessKinds;
  std::vector<char> line(numbers * (kMostDigits + 1));
  for (std::size_t strip = 0; strip < conflicts.strips.size(); ++strip) {
    const fpga::StripConflicts& of_strip = conflicts.strips[strip];
    append(text, frame, ',');
    text += (strip == 0 ? "," : csv_range(strip - 1, rows, board.image.height)) + ',';
    char* end = put(line.data(), of_strip.cycles, ',');
    for (const std::uint64_t stalls : of_strip.stalls) end = put(end, stalls, ',');
    for (std::size_t bank = 0; bank < conflicts.banks; ++bank) {
      for (const std::uint64_t accesses : conflicts.accesses[strip * conflicts.banks + bank])
        end = put(end, accesses, ',');
    }
    end[-1] = '\n';
    text.append(line.data(), end);
  }
  return text;
}

std::string csv_tile(const platform::BoardConfig& board, const fpga::TileGrid& grid, std::size_t tile) {
  if (tile == 0) return ",,,";
  return csv_range((tile - 1) / grid.columns, grid.rows_of_tile, board.image.height) + ',' +
         csv_range((tile - 1) % grid.columns, grid.columns_of_tile, board.image.width);
}

std::string conflicts_csv_head() {
  return "first_row,last_row,first_column,last_column,tile_cycles,port,bank,by,cycles\n";
}

std::string conflicts_csv(const platform::BoardConfig& board, const fpga::ConflictRecorder& recorder) {
  std::string text = conflicts_csv_head();
  const fpga::TileGrid& grid = recorder.grid();
  const std::vector<const fpga::ConflictRecorder::Stalls*> stalls = recorder.stalls();
  std::vector<std::string> names;
  const fpga::Requesters& requesters = recorder.requesters();
  for (const fpga::ConflictRecorder::Stalls* each : stalls) {
    names.push_back(fmt::format("{},{},{},", requesters.name(each->requester), board.banks[each->bank].name,
                                requesters.name(each->by)));
  }
  const std::vector<std::uint64_t> tile_cycles = recorder.tile_cycles();
  std::string place;
  for (std::size_t tile = 0; tile < tile_cycles.size(); ++tile) {
    place.clear();
    for (std::size_t index = 0; index < stalls.size(); ++index) {
      const std::uint64_t cycles = stalls[index]->cycles[tile];
      if (cycles == 0) continue;
      if (place.empty()) {
        place = csv_tile(board, grid, tile) + ',';
        append(place, tile_cycles[tile], ',');
      }
      text += place;
      text += names[index];
      append(text, cycles, '\n');
    }
  }
  return text;
}

std::string timeline_csv_head() {
  return "kind,class,frame,camera_frame,start_ps,end_ps,words,dropped_pixels,why\n";
}

std::string timeline_csv(const std::vector<platform::TimelineEvent>& events) {
  std::string text;
  for (const platform::TimelineEvent& event : events) {
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{},{},{},{}\n",
                   platform::kEventKindNames[static_cast<std::size_t>(event.kind)], event.what,
                   text_of(event.frame), text_of(event.camera_frame), event.begin_ps, event.end_ps,
                   event.words, event.dropped_pixels, event.why);
  }
  return text;
}

std::string latency_csv_head() {
  return fmt::format("frame,camera_frame,captured_ps,{}_ps,latency_ps\n",
                     fmt::join(platform::kLatencyParts, "_ps,"));
}

std::string latency_csv(const std::vector<platform::FrameLatency>& latencies) {
  std::string text;
  for (const platform::FrameLatency& latency : latencies) {
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{}\n", latency.frame, latency.camera_frame,
                   latency.begin_ps, fmt::join(latency.parts_ps, ","), latency.sum_ps());
  }
  return text;
}

}  // namespace stereotlm::stats
