#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "platform/statistics.h"
#include "sw/stats/accuracy.h"

namespace stereotlm::stats {

// The clocks of a board, and the width of its PCI bus, by which the table converts cycles to rates.
struct BoardClocks {
  double fpga_mhz = 40;
  double pci_mhz = 33.333;
  double local_mhz = 40;
  int pci_width_bits = 32;
};

// What the table shows beside the statistics.
struct TableExtras {
  // Frames per second of the core if no port waited for a bank; nullopt: no port waits.
  std::optional<double> waitless_frames_per_second = std::nullopt;
  std::optional<double> answered_percent = std::nullopt;  // pixels of the last frame with a disparity
  std::optional<Accuracy> accuracy = std::nullopt;
};

// What a run or a page says of torn pictures: "captures lose 7 pixels: ..". Empty if no pixel is lost.
std::string lost_pixels_text(std::uint64_t pixels);

// The table that a run prints:
// - Frames per second and their bounds.
// - For each bank its traffic, and the share of the cycles in which it is busy (`busy %`).
// - Who waits longest at which bank for whom, and the frame rate that all waits cost.
// - For a computer: each PCI master's traffic, the share of the clocks that its data takes (`data %`) and its
//   mean wait for the bus; the use of both buses; dropped camera frames by reason; the latency.
// - How much of the last frame is answered, and the accuracy, if given.
// Lines have at most 100 columns; a name of more than 24 characters is shortened. Text is ASCII except names and ±.
std::string console_table(const platform::Statistics& statistics, const BoardClocks& clocks,
                          const TableExtras& extras = {});

}  // namespace stereotlm::stats
