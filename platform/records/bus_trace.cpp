#include "platform/records/bus_trace.h"

#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <tuple>

#include "models/memory/memory_config.h"
#include "platform/config/computer_parts.h"

namespace stereotlm::platform {
namespace {

constexpr std::array<const char*, 4> kSourceNames = {"posted", "read", "dma0", "dma1"};
constexpr std::uint64_t kLastPs = std::uint64_t{1} << 60U;  // later than any run

std::size_t index_of(pci::LocalBusSource source) { return static_cast<std::size_t>(source); }

// kNever if no run reaches the cycle.
std::uint64_t begin_of_cycle(const Clock& clock, std::uint64_t cycle) {
  return cycle < clock.edge_at_or_after(kLastPs) ? clock.edge_ps(cycle) : kNever;
}

}  // namespace

BusTrace::BusTrace(const BoardConfig& board, const fpga::CycleWindow& window, BusObserver& observer)
    : observer_(observer),
      core_clock_(board.fpga.clock_mhz),
      local_clock_(board.bridge.local_clock_mhz),
      frame_(window.frame) {
  for (const BankConfig& bank : board.banks) banks_.push_back(bank.name);
  if (frame_) return;
  if (window.unit != fpga::CycleWindow::Unit::kCycles)
    throw std::invalid_argument("window: rows without a frame: must name the frame of the rows");
  begin_ps_ = begin_of_cycle(core_clock_, window.first);
  if (window.last != UINT64_MAX) end_ps_ = begin_of_cycle(core_clock_, window.last + 1);
}

void BusTrace::hand_out(std::uint64_t now_ps) {
  settle_posted(now_ps);
  if (show_words_) show_words_(now_ps);
  for (Fifo& fifo : fifos_) fifo.settle(now_ps);
  // The order in which the two buses and the queues report depends on the fidelity.
  std::sort(bursts_.begin(), bursts_.end(), [](const EndedBurst& a, const EndedBurst& b) {
    return std::tie(a.burst.end_ps, a.burst.bus) < std::tie(b.burst.end_ps, b.burst.bus);
  });
  std::stable_sort(levels_.begin(), levels_.end(), [](const QueueLevel& a, const QueueLevel& b) {
    return std::make_tuple(a.time_ps, std::string_view(a.queue)) <
           std::make_tuple(b.time_ps, std::string_view(b.queue));
  });
  // The end of the frame of the window may have become known since they came.
  for (const EndedBurst& ended : bursts_) {
    if (ended.free_ps <= now_ps && is_in_window(ended.burst)) observer_.burst(ended.burst);
  }
  for (const QueueLevel& level : levels_) {
    if (level.time_ps <= now_ps && is_in_window(level)) observer_.level(level);
  }
  bursts_.erase(std::remove_if(bursts_.begin(), bursts_.end(),
                               [=](const EndedBurst& ended) { return ended.free_ps <= now_ps; }),
                bursts_.end());
  levels_.erase(std::remove_if(levels_.begin(), levels_.end(),
                               [=](const QueueLevel& level) { return level.time_ps <= now_ps; }),
                levels_.end());
}

bool BusTrace::is_in_window(const BusBurst& burst) const {
  return burst.end_ps > begin_ps_ && burst.request_ps < end_ps_;
}

bool BusTrace::is_in_window(const QueueLevel& level) const {
  return level.time_ps > begin_ps_ && level.time_ps <= end_ps_;
}

void BusTrace::add(const BusBurst& burst, std::uint64_t free_ps) {
  if (is_in_window(burst)) bursts_.push_back({burst, free_ps});
}

void BusTrace::add(const QueueLevel& level) {
  if (is_in_window(level)) levels_.push_back(level);
}

void BusTrace::Fifo::add(std::uint64_t& last_ps, std::uint64_t time_ps, std::int64_t words) {
  if (time_ps <= last_ps) return;
  last_ps = time_ps;
  changes_.push_back({time_ps, words});
}

void BusTrace::Fifo::settle(std::uint64_t now_ps) {
  std::sort(changes_.begin(), changes_.end(),
            [](const Change& a, const Change& b) { return a.time_ps < b.time_ps; });
  auto change = changes_.begin();
  while (change != changes_.end() && change->time_ps <= now_ps) {
    const std::uint64_t time_ps = change->time_ps;
    for (; change != changes_.end() && change->time_ps == time_ps; ++change) words_ += change->words;
    trace_.add({name_, time_ps, static_cast<std::uint64_t>(words_)});
  }
  changes_.erase(changes_.begin(), change);
}

void BusTrace::pci_burst_ended(const pci::EndedPciBurst& burst) {
  add({BusBurst::Bus::kPci, kPciMasterNames[burst.master],
       burst.window ? kPciTargetNames[*burst.window] : "none", burst.write, burst.address, burst.words,
       burst.request_ps, burst.address_ps, burst.data_ps, burst.end_ps},
      burst.end_ps);
}

void BusTrace::words_posted(std::uint64_t now_ps, std::size_t words) {
  settle_posted(now_ps);
  posted_.push_back({now_ps, words});
  posted_words_ += words;
  add({kSourceNames[index_of(pci::LocalBusSource::kPosted)], now_ps, posted_words_});
}

void BusTrace::transfer_waits(std::uint64_t now_ps, pci::LocalBusSource source) {
  waits_ps_[index_of(source)] = now_ps;
}

void BusTrace::burst_begins(std::uint64_t now_ps, pci::LocalBusSource source, std::size_t words) {
  settle_posted(now_ps);
  source_ = source;
  const std::uint64_t waits_ps =
      source == pci::LocalBusSource::kPosted ? take_posted(words) : waits_ps_[index_of(source)];
  request_ps_ = local_clock_.edge_ps(local_clock_.edge_at_or_after(waits_ps));
}

// A burst takes the oldest posted words. Returns the time since which the first of them waits.
std::uint64_t BusTrace::take_posted(std::size_t words) {
  const std::uint64_t waits_ps = posted_.front().time_ps;
  while (words != 0) {
    const std::size_t taken = std::min(words, posted_.front().words);
    words -= taken;
    posted_.front().words -= taken;
    if (posted_.front().words == 0) posted_.pop_front();
  }
  return waits_ps;
}

// The words of the last posted burst have left if their time has come.
void BusTrace::settle_posted(std::uint64_t now_ps) {
  if (leaving_.time_ps > now_ps) return;
  posted_words_ -= leaving_.words;
  add({kSourceNames[index_of(pci::LocalBusSource::kPosted)], leaving_.time_ps, posted_words_});
  leaving_ = {};
}

void BusTrace::local_burst_ended(const fpga::EndedLocalBurst& burst) {
  add({BusBurst::Bus::kLocal, kSourceNames[index_of(source_)], local_target(burst.address), burst.write,
       burst.address, burst.words, request_ps_, burst.address_ps, burst.data_ps, burst.end_ps},
      burst.free_ps);
}

const char* BusTrace::local_target(std::uint64_t address) const {
  return address >= fpga::kLocalRegisters ? "registers" : banks_[memory::bank_of_address(address)].c_str();
}

void BusTrace::frame_begun(std::uint64_t strobe_ps) {
  if (frame_ == frames_ended_) begin_ps_ = strobe_ps;
}

void BusTrace::frame_ended(const fpga::FrameTimes& times) {
  if (frame_ == frames_ended_) end_ps_ = core_clock_.edge_ps(times.done_cycle);
  ++frames_ended_;
}

}  // namespace stereotlm::platform
