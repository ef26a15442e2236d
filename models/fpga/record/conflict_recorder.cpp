#include "models/fpga/record/conflict_recorder.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

namespace stereotlm::fpga {
namespace {

std::size_t parts_of(std::size_t whole, std::size_t part) { return (whole + part - 1) / part; }

std::size_t groups_of_strip(const FrameGeometry& geometry) {
  return static_cast<std::size_t>(geometry.columns_per_strip()) / 4;
}

std::size_t strips_of_results(const FrameGeometry& geometry) {
  return static_cast<std::size_t>((geometry.height + geometry.rows - 1) / geometry.rows);
}

}  // namespace

// Doubles the width or the height of the tiles, whichever is less, until they are few enough.
TileGrid::TileGrid(const FrameGeometry& geometry, std::size_t most_tiles)
    : groups_of_tile(1), strips_of_tile(1) {
  const auto rows_of_strip = static_cast<std::size_t>(geometry.rows);
  const auto divide = [&] {
    columns_of_tile = 4 * groups_of_tile;
    rows_of_tile = rows_of_strip * strips_of_tile;
    columns = parts_of(groups_of_strip(geometry), groups_of_tile);
    rows = parts_of(strips_of_results(geometry), strips_of_tile);
  };
  for (divide(); columns * rows > most_tiles; divide())
    (columns > 1 && (columns_of_tile <= rows_of_tile || rows == 1) ? groups_of_tile : strips_of_tile) *= 2;
}

ConflictRecorder::ConflictRecorder(const CoreConfig& config,
                                   const std::vector<memory::SsramBankConfig>& banks,
                                   std::vector<AddressRange> captured, std::size_t most_tiles)
    : geometry_(checked(config)),
      requesters_(CorePorts(config)),
      banks_(banks.size()),
      captured_(std::move(captured)),
      grid_(geometry_, most_tiles),
      group_shift_(static_cast<unsigned>(__builtin_ctzll(grid_.groups_of_tile))),
      groups_of_fill_(static_cast<std::size_t>(geometry_.result_delay_columns + 3) / 4),
      groups_of_strip_(groups_of_strip(geometry_)),
      strips_(1 + strips_of_results(geometry_)),
      ends_(1 + (strips_ - 1) * grid_.columns),
      tile_cycles_(tiles()),
      indices_(requesters_.size() * banks_ * requesters_.causes()) {}

bool ConflictRecorder::start_frame(std::uint64_t cycle, const memory::Arbitration& arbitration) {
  is_recording_ = frames_begun_++ < frames_wanted_;
  if (!is_recording_) return false;
  first_cycle_ = cycle;
  strip_ = group_ = strip_tile_ = 0;
  grants_.clear();
  grants_place_.assign(requesters_.ports().core_size() * banks_, 0);
  for (memory::Port port = 0; port < requesters_.ports().core_size(); ++port) {
    if (!arbitration.is_routed(port)) continue;
    for (std::size_t bank = 0; bank < banks_; ++bank) {
      if ((arbitration.banks_of(port) >> bank & 1U) == 0) continue;
      grants_place_[port * banks_ + bank] = grants_.size();
      grants_.push_back({port, bank, 0});
    }
  }
  served_.clear();
  frame_.number = frames_begun_ - 1;
  frame_.first_cycle = cycle;
  frame_.banks = banks_;
  frame_.strips.assign(strips_, {0, std::vector<std::uint64_t>(requesters_.size()), {}});
  frame_.accesses.assign(strips_ * banks_, {});
  frame_.stalls.clear();
  return true;
}

std::size_t ConflictRecorder::first_cause(std::size_t requester, std::size_t bank, std::size_t by) {
  stalls_.push_back({{requester, bank, by}, std::vector<std::uint64_t>(tiles())});
  of_strip_.push_back(0);
  indices_[(requester * banks_ + bank) * requesters_.causes() + by] = stalls_.size();
  return stalls_.size() - 1;
}

void ConflictRecorder::hear(memory::Port port, std::size_t bank, std::size_t by, std::uint64_t cycles) {
  if (by != memory::kGranted) {
    const std::size_t cause = cause_of(requester_of_port(port), bank, requester_of_port(by));
    stalls_[cause].cycles[tile()] += cycles;
    of_strip_[cause] += cycles;
  } else if (port == requesters_.ports().host()) {
    host_accesses(strip_, bank, traffic_) += cycles;
  } else {
    grants_[grants_place_[port * banks_ + bank]].cycles += cycles;
  }
}

void ConflictRecorder::end_group(std::uint64_t next_cycle) {
  ends_[place_of(strip_, group_)] = next_cycle;
  ++group_;
  if (group_ == (strip_ == 0 ? groups_of_fill_ : groups_of_strip_)) end_strip();
}

void ConflictRecorder::end_strip() {
  if (strip_ + 1 == strips_) return;  // the last strip ends with the frame
  count_strip();
  ++strip_;
  group_ = 0;
  strip_tile_ = tile_of(strip_);
}

// Counts the grants of the core and all stalls since the end of the strip before.
void ConflictRecorder::count_strip() {
  for (StripConflicts::Grants& grants : grants_) {
    frame_.strips[strip_].grants.push_back(grants);
    accesses_of(strip_, grants.bank)[0] += std::exchange(grants.cycles, 0);
  }
  for (std::size_t cause = 0; cause < of_strip_.size(); ++cause) {
    if (of_strip_[cause] != 0) frame_.stalls.push_back({strip_, cause, std::exchange(of_strip_[cause], 0)});
  }
}

HostTraffic ConflictRecorder::traffic_of(bool write, std::uint64_t address) const {
  if (!write) return HostTraffic::kReadBack;
  const bool is_captured = std::any_of(captured_.begin(), captured_.end(),
                                       [&](const AddressRange& range) { return range.contains(address); });
  return is_captured ? HostTraffic::kCapture : HostTraffic::kUpload;
}

void ConflictRecorder::hear_apart(HostTraffic traffic, std::size_t bank, std::uint64_t cycle,
                                  std::uint64_t cycles, bool granted, std::size_t by) {
  if (!is_recording_) return;
  if (!served_.empty()) {
    Served& last = served_.back();
    if (last.cycle + last.cycles == cycle && last.bank == bank && last.traffic == traffic &&
        last.granted == granted && last.cause == by) {
      last.cycles += cycles;
      return;
    }
  }
  served_.push_back({cycle, cycles, bank, traffic, granted, by});
}

void ConflictRecorder::end_frame(std::uint64_t end_cycle) {
  is_recording_ = false;
  count_strip();
  ends_.back() = end_cycle;
  std::uint64_t begin = first_cycle_;
  for (std::size_t strip = 0; strip < strips_; ++strip) {
    frame_.strips[strip].cycles = end_of(strip) - begin;
    std::uint64_t* tile = tile_cycles_.data() + tile_of(strip);
    for (std::size_t place = place_of(strip, 0); place <= place_of(strip, groups_of_strip_ - 1); ++place) {
      *tile++ += ends_[place] - begin;
      begin = ends_[place];
    }
  }
  count_served();
  for (const FrameConflicts::Stalls& stalls : frame_.stalls)
    frame_.strips[stalls.strip].stalls[stalls_[stalls.cause].requester] += stalls.cycles;
  frame_.causes.assign(stalls_.begin(), stalls_.end());
  ++frames_;
  ended_.push_back(std::move(frame_));
}

// Distributes the words of uncontended bursts over the strips, and their stalls over the tiles and the
// strips.
void ConflictRecorder::count_served() {
  const auto place_at = [this](std::uint64_t cycle) {
    return static_cast<std::size_t>(std::upper_bound(ends_.begin(), ends_.end(), cycle) - ends_.begin());
  };
  std::map<std::pair<std::size_t, std::size_t>, std::uint64_t> stalls;  // [strip, cause]
  std::size_t strip = 0;                                                // mostly that of the words before
  for (const Served& served : served_) {
    const std::size_t requester = requesters_.host(served.traffic);
    const std::uint64_t end = served.cycle + served.cycles;
    for (std::uint64_t cycle = served.cycle; cycle < end;) {
      if (cycle >= end_of(strip) || (strip != 0 && cycle < end_of(strip - 1)))
        strip = (place_at(cycle) + grid_.columns - 1) / grid_.columns;
      std::uint64_t until = std::min(end, end_of(strip));
      if (served.granted) {
        host_accesses(strip, served.bank, served.traffic) += until - cycle;
      } else {
        const std::size_t place = place_at(cycle);
        until = std::min(until, ends_[place]);
        const std::size_t tile = tile_of(strip) + place - place_of(strip, 0);
        const std::size_t cause =
            cause_of(requester, served.bank, requesters_.of_port(served.cause, served.traffic));
        stalls_[cause].cycles[tile] += until - cycle;
        stalls[{strip, cause}] += until - cycle;
      }
      cycle = until;
    }
  }
  if (stalls.empty()) return;
  for (const FrameConflicts::Stalls& each : frame_.stalls) stalls[{each.strip, each.cause}] += each.cycles;
  frame_.stalls.clear();
  for (const auto& [place, cycles] : stalls) frame_.stalls.push_back({place.first, place.second, cycles});
}

std::vector<const ConflictRecorder::Stalls*> ConflictRecorder::stalls() const {
  std::vector<const Stalls*> sorted;
  for (const Stalls& each : stalls_) sorted.push_back(&each);
  std::sort(sorted.begin(), sorted.end(), [](const Stalls* a, const Stalls* b) {
    return std::tie(a->requester, a->bank, a->by) < std::tie(b->requester, b->bank, b->by);
  });
  return sorted;
}

}  // namespace stereotlm::fpga
