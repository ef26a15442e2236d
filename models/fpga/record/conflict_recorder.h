#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "models/address_range.h"
#include "models/fpga/core_config.h"
#include "models/fpga/core_ports.h"
#include "models/fpga/frame_geometry.h"
#include "models/fpga/record/requesters.h"
#include "models/memory/arbitration.h"

namespace stereotlm::fpga {

// How the image is divided into tiles. A tile is a group of four columns of one strip of results. Tiles are
// larger if there would be more of them than wanted.
struct TileGrid {
  TileGrid(const FrameGeometry& geometry, std::size_t most_tiles);

  std::size_t columns;          // tiles side by side
  std::size_t rows;             // tiles one below the other
  std::size_t columns_of_tile;  // pixels; the last tile may be narrower
  std::size_t rows_of_tile;     // pixels; the last tile may be lower
  std::size_t groups_of_tile;   // groups of four columns side by side in a tile
  std::size_t strips_of_tile;
};

// Who stalls at which bank because of whom.
struct StallCause {
  std::size_t requester = 0;
  std::size_t bank = 0;
  std::size_t by = 0;  // a requester, or another cause
};

// The cycles of a strip of results in one frame: from the end of the strip before to the cycle that completes
// its own last group.
struct StripConflicts {
  std::uint64_t cycles = 0;
  std::vector<std::uint64_t> stalls;  // [requester]
  // Of the ports of the core, in their order, at each of their banks.
  struct Grants {
    memory::Port port = 0;
    std::size_t bank = 0;
    std::uint64_t cycles = 0;
  };
  std::vector<Grants> grants;
};

// One frame. Strip 0 is the fill: the cycles before the first group with results. The last strip has the
// cycles up to the last write of the frame.
struct FrameConflicts {
  // Accesses of a bank: those of the core, then those of each HostTraffic.
  static constexpr std::size_t kAccessKinds = 1 + kHostTraffics;
  using BankAccesses = std::array<std::uint64_t, kAccessKinds>;
  struct Stalls {
    std::size_t strip = 0;
    std::size_t cause = 0;  // index in `causes`
    std::uint64_t cycles = 0;
  };

  std::uint64_t number = 0;       // of the frame, among those of the core
  std::uint64_t first_cycle = 0;  // since power-up
  std::vector<StripConflicts> strips;
  std::size_t banks = 0;
  std::vector<BankAccesses> accesses;  // [strip * banks + bank]
  std::vector<StallCause> causes;      // of all frames up to this one
  std::vector<Stalls> stalls;          // by strip, then by cause; no zeros
};

// Records where in the picture, and when in a frame, the ports stall. The cycles after the matcher has
// completed a group of four columns, up to and including the completion of the next group, belong to the tile
// whose results leave with that next group. The cycles before the first group with results are the fill;
// those after the last group belong to the last tile. So fill and tiles together have the counted cycles of
// the frame.
//
// The ports read ahead: when the results of column x leave, the lanes fetch for column x + C (C of contract
// section 2).
//
// Tiles are summed over all frames. Strips are handed out frame by frame. Plain C++; used at every fidelity,
// with the same numbers.
class ConflictRecorder {
 public:
  static constexpr std::size_t kMostTiles = std::size_t{1} << 18U;

  // `captured`: the addresses that the capture boards write to.
  ConflictRecorder(const CoreConfig& config, const std::vector<memory::SsramBankConfig>& banks,
                   std::vector<AddressRange> captured, std::size_t most_tiles = kMostTiles);

  // Frames from number `frames` on are not recorded.
  void record_only(std::uint64_t frames) { frames_wanted_ = frames; }

  // For FrameRun. A frame whose start returns false is not recorded: nothing else may be called for it.
  // `arbitration` is that of the core, with the routes of the frame.
  bool start_frame(std::uint64_t cycle, const memory::Arbitration& arbitration);
  void end_frame(std::uint64_t end_cycle);

  // In `cycles` cycles of the next group a port was granted (`by` is memory::kGranted), or it stalled because
  // of `by`, a port or another cause. Of the host's port only words that contend with the frame.
  void hear(memory::Port port, std::size_t bank, std::size_t by, std::uint64_t cycles = 1);
  // The same for the ports of one cycle.
  void step(memory::PortMask requests, memory::PortMask granted, const memory::Arbitration& arbitration) {
    memory::for_each_port(requests, [&](memory::Port port) {
      const bool is_granted = memory::has(granted, port);
      hear(port, arbitration.bank_of(port),
           is_granted ? memory::kGranted : arbitration.cause_of(port, granted));
    });
  }
  // The group has been completed in the cycle before `next_cycle`.
  void end_group(std::uint64_t next_cycle);

  // For HostPort. The traffic of a burst, and that of the words which take part in the arbitration from now
  // on.
  HostTraffic traffic_of(bool write, std::uint64_t address) const;
  void set_host_traffic(HostTraffic traffic) { traffic_ = traffic; }
  // In these cycles of the running frame the host was granted words of an uncontended bank. If not `granted`,
  // it was refused a word because of `cause`: memory::kTurnaround, ..
  void hear_apart(HostTraffic traffic, std::size_t bank, std::uint64_t cycle, std::uint64_t cycles,
                  bool granted, std::size_t cause = memory::kTurnaround);

  // Of a port, or of another cause.
  std::size_t requester_of_port(std::size_t port) const { return requesters_.of_port(port, traffic_); }
  HostTraffic host_traffic() const { return traffic_; }
  const Requesters& requesters() const { return requesters_; }
  // The strip of the running frame to which the next cycle belongs.
  std::size_t strip() const { return strip_; }

  // The frames that have ended since the last call. They fill memory until they are taken.
  std::vector<FrameConflicts> take_frames() { return std::exchange(ended_, {}); }

  std::uint64_t frames_begun() const { return frames_begun_; }
  // Sums over the frames that have ended.
  std::uint64_t frames() const { return frames_; }
  const TileGrid& grid() const { return grid_; }
  // [tile]: [0] is the fill; then the tiles, row by row.
  const std::vector<std::uint64_t>& tile_cycles() const { return tile_cycles_; }
  // The stall cycles of one cause.
  struct Stalls : StallCause {
    std::vector<std::uint64_t> cycles;  // [tile]
  };
  // Those that have occurred, by requester, bank and `by`.
  std::vector<const Stalls*> stalls() const;

 private:
  struct Served {
    std::uint64_t cycle;
    std::uint64_t cycles;
    std::size_t bank;
    HostTraffic traffic;
    bool granted;
    std::size_t cause;  // of a wait
  };

  // The first tile of a strip.
  std::size_t tile_of(std::size_t strip) const {
    return strip == 0 ? 0 : 1 + (strip - 1) / grid_.strips_of_tile * grid_.columns;
  }
  // The tile of the next group, or of the last one if it has ended.
  std::size_t tile() const {
    return strip_tile_ + (strip_ == 0 ? 0 : std::min(group_, groups_of_strip_ - 1) >> group_shift_);
  }
  // The index in ends_.
  std::size_t place_of(std::size_t strip, std::size_t group) const {
    return strip == 0 ? 0 : 1 + (strip - 1) * grid_.columns + (group >> group_shift_);
  }
  // The first cycle after a strip that has ended.
  std::uint64_t end_of(std::size_t strip) const { return ends_[place_of(strip, groups_of_strip_ - 1)]; }
  // The index in stalls_.
  std::size_t cause_of(std::size_t requester, std::size_t bank, std::size_t by) {
    const std::size_t index = indices_[(requester * banks_ + bank) * requesters_.causes() + by];
    return index != 0 ? index - 1 : first_cause(requester, bank, by);
  }
  std::size_t first_cause(std::size_t requester, std::size_t bank, std::size_t by);
  FrameConflicts::BankAccesses& accesses_of(std::size_t strip, std::size_t bank) {
    return frame_.accesses[strip * banks_ + bank];
  }
  std::uint64_t& host_accesses(std::size_t strip, std::size_t bank, HostTraffic traffic) {
    return accesses_of(strip, bank)[1 + static_cast<std::size_t>(traffic)];
  }
  void count_strip();
  void end_strip();
  std::size_t tiles() const { return 1 + grid_.columns * grid_.rows; }
  void count_served();

  FrameGeometry geometry_;
  Requesters requesters_;
  std::size_t banks_;
  std::vector<AddressRange> captured_;
  TileGrid grid_;
  unsigned group_shift_;        // a tile has 2^group_shift_ groups side by side
  std::size_t groups_of_fill_;  // the first one may have fewer than four columns
  std::size_t groups_of_strip_;
  std::size_t strips_;  // the fill among them
  std::uint64_t frames_wanted_ = UINT64_MAX;
  HostTraffic traffic_ = HostTraffic::kCapture;

  // The running frame.
  bool is_recording_ = false;
  std::uint64_t first_cycle_ = 0;
  std::size_t strip_ = 0;       // of the next group
  std::size_t group_ = 0;       // number of the next group in its strip
  std::size_t strip_tile_ = 0;  // the first tile of this strip
  // In the strip of the next group: of each port of the core, at each of its banks.
  std::vector<StripConflicts::Grants> grants_;
  std::vector<std::size_t> grants_place_;  // [port][bank]: in grants_
  // [place_of()]: the first cycle after the part of a tile in its strip.
  std::vector<std::uint64_t> ends_;
  std::vector<Served> served_;
  FrameConflicts frame_;

  std::uint64_t frames_begun_ = 0;
  std::uint64_t frames_ = 0;
  std::vector<FrameConflicts> ended_;
  std::vector<std::uint64_t> tile_cycles_;
  std::vector<Stalls> stalls_;           // in the order of their first cycles
  std::vector<std::uint64_t> of_strip_;  // [index in stalls_]: cycles in the strip of the next group
  std::vector<std::size_t> indices_;     // [requester][bank][by]: 1 + the index in stalls_; 0: none yet
};

}  // namespace stereotlm::fpga
