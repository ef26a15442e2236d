#include "platform/camera_lines.h"

#include <algorithm>

#include "models/memory/memory_config.h"
#include "models/time_ps.h"
#include "platform/device_map.h"

namespace stereotlm::platform {
namespace {

constexpr std::array<std::size_t, 2> kMasters = {kLeftCapture, kRightCapture};
constexpr pci::PciBusControl::Masters kCaptures =
    pci::PciBusControl::mask_of(kLeftCapture) | pci::PciBusControl::mask_of(kRightCapture);
// Each time is rounded to whole ps, so the distance of two clocks, or of two pixels, may differ by 1 ps from
// line to line. The order of two times depends on two such distances: from the beginning of the line to each
// of the times. That makes 2 ps. The third ps keeps the two times apart.
constexpr std::int64_t kRounding = 3;
// Recording stops when the records exceed the skipped lines by this number.
constexpr std::uint64_t kFirstRecords = 64;
// But one of this number of unknown lines is always recorded, because what disturbs the lines may end.
constexpr std::uint64_t kUnknownPerRecord = 128;
// With more records it would take longer to search them than to step the line.
constexpr std::size_t kMostRecords = 512;

std::int64_t from_to(std::uint64_t from_ps, std::uint64_t to_ps) {
  return static_cast<std::int64_t>(to_ps) - static_cast<std::int64_t>(from_ps);
}

}  // namespace

CameraLines::CameraLines(pci::PciBusControl& pci_bus, pci::BridgeControl& bridge, FastBoard& board,
                         std::array<capture::CaptureControl, 2>& captures, bool has_pixels)
    : pci_bus_(pci_bus),
      local_bus_(board.local_bus()),
      bridge_(bridge),
      board_(board),
      captures_(captures),
      has_pixels_(has_pixels),
      phase_tolerance_ps_(static_cast<std::int64_t>(local_bus_.clock().edge_ps(1) /
                                                    pci_bus.clock().phases_against(local_bus_.clock()) / 2) -
                          kRounding) {}

bool CameraLines::skip(std::uint64_t now_ps, std::uint64_t end_ps) {
  bridge_.settle(now_ps);
  const auto addresses = bank_addresses();
  if (!addresses || !bridge_.is_idle()) {
    drop();
    return false;
  }
  if (is_recording_) end_record();
  const capture::CaptureFifo& fifo = captures_[0].fifo();
  if (!fifo.has_row(fifo.next_row() + 1)) return false;  // the end of the picture is stepped
  const Beginning here = beginning(now_ps);
  if (const Line* const line = find(here)) {
    if (!fits_before(*line, now_ps, end_ps)) return false;
    apply(*line, now_ps, *addresses);
    ++skipped_;
    return true;
  }
  ++unknown_;
  if (recorded_ < kFirstRecords + skipped_ || unknown_ % kUnknownPerRecord == 0)
    begin_record(now_ps, here, *addresses);
  return false;
}

// The addresses of the line's words on the local bus, if their banks serve one word a cycle.
std::optional<CameraLines::OfSides<std::uint64_t>> CameraLines::bank_addresses() const {
  const std::uint64_t bytes = 4 * words_of_line();
  OfSides<std::uint64_t> addresses{};
  for (std::size_t side = 0; side < kSides; ++side) {
    const std::uint64_t offset = captures_[side].line_address() - DeviceMap().bridge_slave;
    const auto address = bridge_.bank_address(offset, bytes);
    if (!address || !board_.serves_one_word_per_cycle(true, *address, bytes)) return std::nullopt;
    addresses[side] = *address;
  }
  return addresses;
}

CameraLines::Beginning CameraLines::beginning(std::uint64_t now_ps) const {
  const Clock& local = local_bus_.clock();
  const std::uint64_t local_ps = local.edge_ps(local.edge_at_or_after(now_ps));
  return {pci_bus_.position().last_granted, from_to(captures_[0].requested_ps(), now_ps),
          from_to(now_ps, local_ps)};
}

const CameraLines::Line* CameraLines::find(const Beginning& beginning) const {
  const auto found = std::find_if(bounds_.begin(), bounds_.end(),
                                  [&](const Bounds& bounds) { return bounds.hold(beginning); });
  return found != bounds_.end() ? &lines_[static_cast<std::size_t>(found - bounds_.begin())] : nullptr;
}

// Whether the line ends before `end_ps`, before the first request of any other master, and before the next
// line.
bool CameraLines::fits_before(const Line& line, std::uint64_t now_ps, std::uint64_t end_ps) const {
  const Clock& local = local_bus_.clock();
  const std::uint64_t idle_clock = local.edge_at_or_after(now_ps) + line.idle_clock;
  const std::uint64_t last_ps = local.edge_ps(idle_clock + 1);  // behind the end of all PCI bursts
  const std::uint64_t request = pci_bus_.earliest_request_beside(kCaptures);
  if (request != kNever && pci_bus_.clock().edge_ps(request) <= last_ps) return false;
  const capture::CaptureFifo& fifo = captures_[0].fifo();
  return last_ps < end_ps && last_ps < fifo.first_request_ps(fifo.next_row() + 1);
}

void CameraLines::apply(const Line& line, std::uint64_t now_ps, const OfSides<std::uint64_t>& addresses) {
  const std::uint64_t first = pci_bus_.decision_clock();
  const std::uint64_t first_local = local_bus_.clock().edge_at_or_after(now_ps);
  for (std::size_t side = 0; side < kSides; ++side)
    pci_bus_.skip_bursts(kMasters[side], line.sides[side].pci);
  pci_bus_.skip_to({line.pci.last_granted, first + line.pci.free_clock}, line.buses.pci_busy);
  local_bus_.skip_bursts(line.buses.bursts, line.buses.local_busy, first_local + line.idle_clock);
  set_bursts(line, first_local, addresses);
  board_.skip_bursts(bursts_);
  const std::uint64_t words = words_of_line();
  bridge_.skip_posted((bridge_.turn() + line.turns) % pci::bridge::kChannels);
  for (std::size_t side = 0; side < kSides; ++side) {
    const Line::SideLine& of_side = line.sides[side];
    bridge_.count_posted(addresses[side], words);
    unsigned char* const stored = board_.count_skipped(true, addresses[side], words);
    if (has_pixels_) captures_[side].copy_line(reinterpret_cast<std::uint32_t*>(stored));
    captures_[side].skip_line(pci_bus_.clock().edge_ps(first + of_side.end_clock), of_side.pci.transactions);
  }
}

// Sets bursts_ to the bursts of a line that begins before the clock `first_local` of the local bus.
void CameraLines::set_bursts(const Line& line, std::uint64_t first_local,
                             const OfSides<std::uint64_t>& addresses) {
  bursts_.clear();
  if (!board_.needs_each_burst(addresses[0]) && !board_.needs_each_burst(addresses[1])) {
    for (std::size_t side = 0; side < kSides; ++side)
      bursts_.push_back({true, addresses[side], first_local + line.sides[side].first_clock, words_of_line()});
    return;
  }
  auto next = addresses;
  for (const Line::LocalBurst& burst : line.bursts) {
    bursts_.push_back({true, next[burst.side], first_local + burst.first_clock, burst.words});
    next[burst.side] += 4 * burst.words;
  }
}

void CameraLines::begin_record(std::uint64_t now_ps, const Beginning& beginning,
                               const OfSides<std::uint64_t>& addresses) {
  ++recorded_;
  is_recording_ = true;
  record_ = {};
  record_.beginning = beginning;
  record_.row = captures_[0].fifo().next_row();
  record_.pci_clock = pci_bus_.decision_clock();
  record_.local_clock = local_bus_.clock().edge_at_or_after(now_ps);
  record_.addresses = addresses;
  for (std::size_t side = 0; side < kSides; ++side) {
    record_.counts[side] = pci_bus_.counts(kMasters[side]);
    record_.full_checks[side] = captures_[side].fifo().full_checks();
    record_.request_clocks[side] = record_.pci_clock;
  }
  record_.buses = BusCounts::of(pci_bus_, local_bus_);
  record_.turn = bridge_.turn();
}

void CameraLines::stepped(std::uint64_t now_ps, bool is_of_pci_bus) {
  if (is_of_pci_bus) record_pci_step(pci_bus_.clock().edge_at_or_after(now_ps));
  if (local_bus_.bursts() != record_.buses.bursts + record_.line.buses.bursts) record_local_burst();
}

void CameraLines::record_pci_step(std::uint64_t clock) {
  narrow_pixel_bounds(clock);
  narrow_local_bounds(clock);
  for (std::size_t side = 0; side < kSides; ++side) {
    Line::SideLine& of_side = record_.line.sides[side];
    pci::PciBusControl::MasterCounts so_far = pci_bus_.counts(kMasters[side]);
    so_far.subtract(record_.counts[side]);
    if (so_far.transactions != of_side.pci.transactions) of_side.end_clock = clock - record_.pci_clock;
    of_side.pci = so_far;
    // A request counts from the first clock at or after its time. A request for the next line is left out.
    const std::uint64_t requested = pci_bus_.request_clock(kMasters[side]);
    if (requested != kNever && requested != record_.request_clocks[side] &&
        !captures_[side].is_between_lines()) {
      narrow_pixel_bounds(requested - 1);
      narrow_pixel_bounds(requested);
    }
    record_.request_clocks[side] = requested;
  }
}

// Narrows the bounds: the same words must be complete at this clock of the PCI bus.
void CameraLines::narrow_pixel_bounds(std::uint64_t pci_clock) {
  const std::uint64_t time_ps = pci_bus_.clock().edge_ps(pci_clock);
  const capture::CaptureFifo::Span span = captures_[0].fifo().same_words(record_.row, time_ps);
  record_.pci_earlier_ps = std::min(record_.pci_earlier_ps, from_to(span.first_ps, time_ps) - kRounding);
  record_.pci_later_ps = std::min(record_.pci_later_ps, from_to(time_ps, span.end_ps) - kRounding);
}

// Narrows the bounds: the same clock of the local bus must be the next one at this clock of the PCI bus.
void CameraLines::narrow_local_bounds(std::uint64_t pci_clock) {
  const Clock& local = local_bus_.clock();
  const std::uint64_t time_ps = pci_bus_.clock().edge_ps(pci_clock);
  const std::uint64_t next = local.edge_at_or_after(time_ps);
  const std::uint64_t next_ps = local.edge_ps(next);
  // A clock that begins at this very time must still do so.
  const std::uint64_t last_ps = next_ps == time_ps ? time_ps : local.edge_ps(next - 1);
  record_.local_earlier_ps = std::min(record_.local_earlier_ps, from_to(time_ps, next_ps) - kRounding);
  record_.local_later_ps = std::min(record_.local_later_ps, from_to(last_ps, time_ps) - kRounding);
}

void CameraLines::record_local_burst() {
  const LocalBurst& burst = local_bus_.burst();
  const std::uint64_t first = local_bus_.first_request_clock() - record_.local_clock;
  const bool is_right = burst.address - record_.addresses[1] < 4 * words_of_line();
  const std::size_t side = is_right ? 1 : 0;
  if (burst.address == record_.addresses[side]) record_.line.sides[side].first_clock = first;
  record_.line.bursts.push_back({side, first, burst.words});
  ++record_.line.buses.bursts;
}

// Called when the next line begins. Everything is idle again.
void CameraLines::end_record() {
  is_recording_ = false;
  record_.local_earlier_ps = std::max(record_.local_earlier_ps, phase_tolerance_ps_);
  record_.local_later_ps = std::max(record_.local_later_ps, phase_tolerance_ps_);
  const BusCounts buses = BusCounts::of(pci_bus_, local_bus_).since(record_.buses);
  if (!record_is_whole(buses)) return;
  Line& line = record_.line;
  line.pci = pci_bus_.position();
  line.pci.free_clock -= record_.pci_clock;
  line.buses = buses;
  line.turns = (bridge_.turn() + pci::bridge::kChannels - record_.turn) % pci::bridge::kChannels;
  line.idle_clock = local_bus_.idle_clock() - record_.local_clock;
  Bounds bounds = {record_.beginning, record_.beginning};
  bounds.least.pci_ps -= record_.pci_earlier_ps;
  bounds.most.pci_ps += record_.pci_later_ps;
  bounds.least.local_ps -= record_.local_earlier_ps;
  bounds.most.local_ps += record_.local_later_ps;
  if (lines_.size() < kMostRecords) {
    lines_.push_back(line);
    bounds_.push_back(bounds);
  } else {
    lines_[oldest_] = line;
    bounds_[oldest_] = bounds;
    oldest_ = (oldest_ + 1) % kMostRecords;
  }
}

// Whether the record holds for later lines: all words were stored, none can have found its FIFO full, no
// other master had a bus, and the bounds hold some time. `buses`: what the buses have done in the line.
bool CameraLines::record_is_whole(const BusCounts& buses) const {
  if (captures_[0].fifo().next_row() != record_.row + 1) return false;  // the next line came before the end
  std::uint64_t transactions = 0;
  for (std::size_t side = 0; side < kSides; ++side) {
    const pci::PciBusControl::MasterCounts& counts = record_.line.sides[side].pci;
    if (counts.words != words_of_line() || counts.aborts != 0 ||
        captures_[side].fifo().full_checks() != record_.full_checks[side])
      return false;
    transactions += counts.transactions;
  }
  return buses.transactions == transactions && buses.bursts == record_.line.buses.bursts &&
         std::min({record_.pci_earlier_ps, record_.pci_later_ps, record_.local_earlier_ps,
                   record_.local_later_ps}) >= 0;
}

}  // namespace stereotlm::platform
