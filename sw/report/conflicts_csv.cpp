#include "sw/report/conflicts_csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <vector>

namespace stereotlm::report {
namespace {

constexpr std::array<const char*, fpga::FrameConflicts::kAccessKinds> kAccessNames = {"core", "capture",
                                                                                      "upload", "read_back"};

// "first,last" of a part of a whole.
std::string range(std::size_t index, std::size_t length, int whole) {
  const std::size_t last = std::min((index + 1) * length, static_cast<std::size_t>(whole)) - 1;
  return fmt::format("{},{}", index * length, last);
}

// Appends a comma and a number. It is faster than fmt, and rows.csv has a line for each row of each frame.
void append(std::string& text, std::uint64_t number) {
  const fmt::format_int digits(number);
  text += ',';
  text.append(digits.data(), digits.size());
}

}  // namespace

std::string rows_csv_head(const platform::BoardConfig& board) {
  std::string text = "frame,first_row,last_row,cycles";
  for (std::size_t requester = 0; requester < fpga::kRequesters; ++requester) {
    std::string name = fpga::requester_name(requester);
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
  const std::string number = fmt::to_string(frame);
  for (std::size_t strip = 0; strip < conflicts.strips.size(); ++strip) {
    const fpga::StripConflicts& of_strip = conflicts.strips[strip];
    text += number + ',';
    text +=
        strip == 0 ? "," : range(strip - 1, static_cast<std::size_t>(board.matcher.rows), board.image.height);
    append(text, of_strip.cycles);
    for (const std::uint64_t stalls : of_strip.stalls) append(text, stalls);
    for (std::size_t bank = 0; bank < conflicts.banks; ++bank) {
      for (const std::uint64_t accesses : conflicts.accesses[strip * conflicts.banks + bank])
        append(text, accesses);
    }
    text += '\n';
  }
  return text;
}

std::string conflicts_csv(const platform::BoardConfig& board, const fpga::ConflictRecorder& recorder) {
  std::string text = "first_row,last_row,first_column,last_column,tile_cycles,port,bank,by,cycles\n";
  const fpga::TileGrid& grid = recorder.grid();
  const std::vector<const fpga::ConflictRecorder::Stalls*> stalls = recorder.stalls();
  for (std::size_t tile = 0; tile < recorder.tile_cycles().size(); ++tile) {
    std::string place;
    for (const fpga::ConflictRecorder::Stalls* each : stalls) {
      if (each->cycles[tile] == 0) continue;
      if (place.empty()) {
        place = tile == 0 ? ",,,"
                          : range((tile - 1) / grid.columns, grid.rows_of_tile, board.image.height) + ',' +
                                range((tile - 1) % grid.columns, grid.columns_of_tile, board.image.width);
        append(place, recorder.tile_cycles()[tile]);
      }
      fmt::format_to(std::back_inserter(text), "{},{},{},{},{}\n", place,
                     fpga::requester_name(each->requester), board.banks[each->bank].name,
                     fpga::requester_name(each->by), each->cycles[tile]);
    }
  }
  return text;
}

}  // namespace stereotlm::report
