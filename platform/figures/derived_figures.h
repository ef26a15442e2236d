#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "platform/config/board_config.h"
#include "platform/figures/audit.h"
#include "platform/figures/statistics.h"

namespace stereotlm::platform {

// What follows from the figures of a run alone. It holds for a run that has just ended and for one that was
// recorded.

// Sets the figures that follow from the board, the counters and the lengths of the frames: names, `frames`,
// `cycles`, shares and rates of the banks, frames_per_second.core, area. `banks` and `ports` have
// as many entries as the board.
void derive_figures(const BoardConfig& board, Statistics& statistics);

// Sets what follows from the work of the banks, the bytes of the buffers and the time: energies and shares.
// Without a computer also the time, the accesses and the bytes.
void derive_energy(const BoardConfig& board, Statistics& statistics);

// Times of a delivered frame.
struct Delivery {
  std::uint64_t capture_ps = 0;  // time of the first pixel
  std::uint64_t host_ps = 0;     // time at which the host has handled the end of its read-back
};

// The frames in the window of the steady rate of `frames` deliveries; 0: too few. `turn`:
// allocation_period_frames().
std::uint64_t steady_frames(std::uint64_t frames, std::uint64_t turn);

// The steady rate of a run with these deliveries; nullopt if they are too few. `turn`:
// allocation_period_frames().
std::optional<SteadyRate> steady_rate(const std::vector<Delivery>& deliveries, std::uint64_t turn);

// Sets what follows from the deliveries of a computer, at least one: frames_per_second.system and .steady,
// capture_to_host_ms, and the time of the energy. `turn`: allocation_period_frames().
void derive_delivery_figures(const std::vector<Delivery>& deliveries, std::uint64_t turn,
                             Statistics& statistics);

// Checks the identities among the figures of the core, and of the computer around it.
void audit_core(const Statistics& statistics, Audit& audit);
void audit_computer(const ComputerStatistics& computer, Audit& audit);
// Checks that each access of a bank is one of a buffer.
void audit_energy(const Statistics& statistics, Audit& audit);

// The accesses of the core's ports to the banks: [port][bank]. A port makes equally many in each frame, and
// frame f uses entry f mod length of its list. Those to a striped buffer are divided among its banks by the
// slots of their rows: exact, but for pictures that a table does not read row by row.
std::vector<std::vector<std::uint64_t>> core_accesses(const BoardConfig& board, const Statistics& statistics);
// Checks that the accesses of the banks are those of the core's ports and of the host.
void audit_accesses(const BoardConfig& board, const Statistics& statistics, Audit& audit);

}  // namespace stereotlm::platform
