#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "tests/support/plain_cycle_input.h"

// The timing of the FPGA core as a plain loop over cycles, written from contract section 2 alone, for frames
// with `--source preloaded`. It shares no code with the models and exists to be compared with them, so it
// keeps a time stamp for everything that the page dates and looks at every rule in every cycle.
namespace stereotlm::test {

struct PlainPortStates {
  std::uint64_t granted = 0;
  std::uint64_t stalled = 0;
  std::uint64_t passed = 0;
  std::uint64_t idle = 0;
  std::uint64_t blocked = 0;
  std::uint64_t starved = 0;
};

struct PlainBankStates {
  std::uint64_t reads = 0;
  std::uint64_t writes = 0;
  std::uint64_t busy = 0;
  std::uint64_t turnaround = 0;
  std::uint64_t idle = 0;
  std::uint64_t contended = 0;
};

// Who lost a cycle, where, and to whom.
struct PlainBlame {
  PlainPort port = PlainPort::kHost;  // the victim
  int bank = 0;
  std::optional<PlainPort> by;  // the port that was granted; nullopt: turnaround

  friend bool operator<(const PlainBlame& a, const PlainBlame& b) {
    return std::tie(a.port, a.bank, a.by) < std::tie(b.port, b.bank, b.by);
  }
};

// A row of results is whole with the write of its last word.
struct PlainRowEnd {
  std::uint64_t cycles = 0;                             // of its frame, that write's included
  std::array<std::uint64_t, kPlainPortCount> stalls{};  // of these cycles, in the order of PlainPort
};

// Counters are sums over the frames and cover the counted cycles, 0 .. frame_cycles - 1 -
// pipeline_latency_cycles of each frame.
struct PlainCycleResult {
  bool hang = false;                        // a frame did not end in max_frame_cycles; the figures end there
  std::vector<std::uint64_t> frame_cycles;  // of the frames that ended
  std::vector<std::vector<PlainRowEnd>> rows;  // of the same frames
  std::uint64_t counted_cycles = 0;
  std::array<PlainPortStates, kPlainPortCount> ports;  // in the order of PlainPort
  std::vector<PlainBankStates> banks;                  // in the order of PlainCycleInput::banks
  std::map<PlainBlame, std::uint64_t> blame;           // without zero rows

  const PlainPortStates& port(PlainPort which) const { return ports[static_cast<std::size_t>(which)]; }
  std::uint64_t blamed(PlainPort victim, int bank, std::optional<PlainPort> by) const {
    const auto row = blame.find(PlainBlame{victim, bank, by});
    return row == blame.end() ? 0 : row->second;
  }
};

inline constexpr std::uint64_t kPlainMaxFrameCycles = 50'000'000;

// Runs `frames` frames, at least one, one after the other. A frame whose last write is not granted within its
// first max_frame_cycles cycles is a hang. Throws std::invalid_argument if the input is not sound.
PlainCycleResult run_plain_cycle_loop(const PlainCycleInput& input, int frames,
                                      std::uint64_t max_frame_cycles = kPlainMaxFrameCycles);

// The number of slots of one frame, empty ones included.
std::size_t plain_slot_count(const PlainCycleInput& input);

}  // namespace stereotlm::test
