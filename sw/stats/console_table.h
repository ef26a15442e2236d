#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "platform/config/board_keys.h"
#include "platform/figures/bounds.h"
#include "platform/figures/statistics.h"
#include "sw/stats/accuracy.h"

namespace stereotlm::stats {

// What a port waits for: "left_pixel", "the turnaround", "a row to open". `by`: as in stats.json.
inline std::string cause_text(const std::string& by) {
  if (by == "turnaround") return "the turnaround";
  if (by == "row") return "a row to open";
  return by == "refresh" ? "a refresh" : by;
}

// "left_lut on bank0 for left_pixel"
inline std::string wait_text(const std::string& port, const std::string& bank, const std::string& by) {
  return port + " on " + platform::bank_text(bank) + " for " + cause_text(by);
}

// The port group of a port: "left_lut" of "left_lut.3".
inline std::string group_text(const std::string& port) { return port.substr(0, port.find('.')); }

// Ports, the lanes of a group as a range: "left_lut.0-2, result". `ports`: in the order of the board.
std::string ports_text(const std::vector<std::string>& ports);

// The name of a resource of the bounds, such as "bank bank0", for people: "bank0". "bank matcher" stays.
inline std::string resource_text(const std::string& resource) {
  const std::optional<std::string> bank = platform::bank_of_resource(resource);
  return bank ? platform::bank_text(*bank) : resource;
}

// The same in a sentence: "the matcher", "the cameras", "bank0".
inline std::string resource_words(const std::string& resource) {
  if (resource == "matcher") return "the matcher";
  if (resource == "camera") return "the cameras";
  if (resource == "pci") return "the PCI bus";
  if (resource == "bridge") return "the PCI bridge";
  return resource_text(resource);
}

// What stands behind the steady bound (contract section 6): " of whole pictures" if captures lose pixels;
// " over whole turns" if the rate from power-up is above the bound; else empty.
inline const char* whole_text(const platform::Statistics& run) {
  if (platform::lost_pixels(run) > 0) return " of whole pictures";
  const bool is_above = run.frames_per_second.system.value_or(0) > run.bound.system.value_or(0);
  return is_above ? " over whole turns" : "";
}

inline constexpr double kVisibleRate = 0.0005;  // frames/s: less is not seen in the table

// What stands behind a steady rate, its uncertainty and its unit, so that nobody quotes the rate alone: the
// pixels that captures lose, or that the rate is above its bound, which is then within the uncertainty.
std::string rate_remark(double rate, double bound, std::uint64_t lost_pixels);

// What the table shows beside the statistics.
struct TableExtras {
  // Frames per second of the core if no port waited for a bank; nullopt: no port waits.
  std::optional<double> waitless_frames_per_second = std::nullopt;
  std::optional<double> answered_percent = std::nullopt;  // pixels of the last frame with a disparity
  std::optional<Accuracy> accuracy = std::nullopt;
};

// What a run or a page says of torn pictures: "captures lose 7 pixels: ..". Empty if no pixel is lost.
std::string lost_pixels_text(std::uint64_t pixels);

// The table that a run of this board prints:
// - Frames per second and their bounds.
// - For each bank its traffic, the share of cycles in which it is busy (`busy %`), and that of the energy.
// - Who waits longest at which bank for whom, and the frame rate that all waits cost.
// - The energy of the memories and the traffic of the buffers, for each frame.
// - For a computer: each PCI master's traffic, the share of the clocks that its data takes (`data %`) and its
//   mean wait for the bus; the use of both buses; dropped camera frames by reason; the latency.
// - How much of the last frame is answered, and the accuracy, if given.
// Lines have at most 100 columns; a name of more than 24 characters is shortened. Text is ASCII except names
// and ±.
std::string console_table(const platform::Statistics& statistics, const platform::BoardConfig& board,
                          const TableExtras& extras = {});

}  // namespace stereotlm::stats
