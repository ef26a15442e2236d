#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "tests/support/plain_cycle_input.h"

// The timing of the FPGA core, cycle by cycle, written from contract sections 2, 7 and 8 alone (8: lanes,
// stripes, SDRAM; models/contract.md will get it when the models have them). It shares no code with the
// models, which tests compare with it. It keeps a time stamp for every event to which the contract gives a
// time, and applies every rule in every cycle.
//
// Ports have numbers: left_lut.0 .. left_lut.P-1 (P lanes), right_lut.0 .., the pixel ports likewise, result,
// host. Then come the causes of stalls that are no port: turnaround, row (an SDRAM opens one), refresh.
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
  std::uint64_t row = 0;
  std::uint64_t refresh = 0;
  std::uint64_t idle = 0;
  std::uint64_t contended = 0;
};

// What takes energy (contract 9.2).
struct PlainBankWork {
  std::uint64_t accesses = 0;
  std::uint64_t rows_opened = 0;
  std::uint64_t refreshes = 0;
};

// The cause of a lost cycle.
struct PlainBlame {
  std::size_t port = 0;  // the victim
  int bank = 0;
  std::size_t by = 0;  // the port that was granted, or another cause

  friend bool operator<(const PlainBlame& a, const PlainBlame& b) {
    return std::tie(a.port, a.bank, a.by) < std::tie(b.port, b.bank, b.by);
  }
};

// A row of results is complete with the write of its last word.
struct PlainRowEnd {
  std::uint64_t cycles = 0;           // of the frame up to and including that write
  std::vector<std::uint64_t> stalls;  // of each port, in these cycles
};

// What the host's port is used for.
enum class PlainTraffic { kCapture, kUpload, kReadBack };

// Where in the picture, and when in a frame, ports stall. A tile is four columns of a strip of R rows. A
// cycle belongs to the tile whose results leave next. Tile 0 is the fill: the cycles up to the one in which
// column C - 1 is consumed (C: contract section 2). Cycles after the last results belong to the last tile.
//
// `waiter` and `by` are numbers: of a port (in place of the host: one for each PlainTraffic), then of
// turnaround, row, refresh.
struct PlainLoss {
  std::size_t waiter = 0;
  int bank = 0;
  std::size_t by = 0;

  friend bool operator<(const PlainLoss& a, const PlainLoss& b) {
    return std::tie(a.waiter, a.bank, a.by) < std::tie(b.waiter, b.bank, b.by);
  }
};
struct PlainTile {
  std::uint64_t cycles = 0;
  std::map<PlainLoss, std::uint64_t> lost;
};
// A strip of R rows in one frame; the first one is the fill.
struct PlainStrip {
  std::uint64_t cycles = 0;
  std::vector<std::uint64_t> lost;                     // of each waiter
  std::vector<std::array<std::uint64_t, 4>> accesses;  // [bank]: of the core, and by PlainTraffic
};

// Counters are sums over the counted cycles of all frames: 0 .. frame_cycles - 1 - pipeline_latency_cycles.
struct PlainCycleResult {
  bool hang = false;                        // a frame did not end in max_frame_cycles; the figures end there
  std::vector<std::uint64_t> frame_cycles;  // of the frames that ended
  std::vector<std::vector<PlainRowEnd>> rows;   // of the same frames
  std::vector<std::vector<PlainStrip>> strips;  // of each frame
  std::vector<PlainTile> tiles;                 // sums over the frames
  std::uint64_t counted_cycles = 0;
  std::vector<std::string> names;           // of the ports, then turnaround, row, refresh
  std::vector<PlainPortStates> ports;       // by their numbers
  std::vector<PlainBankStates> banks;       // in the order of PlainCycleInput::banks
  std::vector<PlainBankWork> counted_work;  // likewise, in the counted cycles
  std::vector<PlainBankWork> work;          // in all cycles
  std::vector<bool> used_banks;             // those that hold a word of a buffer
  // In all cycles: to left_image, right_image, disparity, left_lut, right_lut.
  std::array<std::uint64_t, 5> buffer_accesses{};
  std::map<PlainBlame, std::uint64_t> blame;  // without zero rows
};

// A word that the local bus requests in a cycle.
struct PlainHostRequest {
  PlainWord at;
  bool write = false;
  PlainTraffic traffic = PlainTraffic::kReadBack;
};

class PlainCore {
 public:
  // `input` outlives the core.
  explicit PlainCore(const PlainCycleInput& input);
  ~PlainCore();

  // The next step is cycle 0 of a frame, which uses entry `frame` of each list, modulo its length.
  void start_frame(int frame);
  // From start_frame() to the last result write.
  bool runs() const;
  // Steps cycle number `now`, greater than the last one. Cycles without requests may be left out. True if the
  // host's word is granted.
  bool step(std::int64_t now, const std::optional<PlainHostRequest>& host);
  // All but `hang` and `frame_cycles`, which the caller fills in. Between two frames, up to cycle `end`.
  PlainCycleResult result(std::int64_t end = 0);

 private:
  class Cycles;
  std::unique_ptr<Cycles> cycles_;
};

// The names of the ports, then turnaround, row, refresh.
std::vector<std::string> plain_names(int lanes);

}  // namespace stereotlm::test
