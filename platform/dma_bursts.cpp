#include "platform/dma_bursts.h"

#include <algorithm>
#include <cstring>

#include "models/memory/crossbar_address.h"
#include "models/time_ps.h"
#include "platform/computer_parts.h"
#include "platform/device_map.h"

namespace stereotlm::platform {
namespace {

// Each time is rounded to whole ps. So the ends of the two bursts of a step may come closer by this number of ps
// than those of another step.
constexpr std::uint64_t kRounding = 4;

}  // namespace

DmaBursts::DmaBursts(pci::PciBusControl& pci_bus, pci::BridgeControl& bridge, FastBoard& board,
                     unsigned char* host_memory, std::uint64_t host_memory_bytes, bool has_pixels)
    : buses_{pci_bus, board.local_bus()},
      bridge_(bridge),
      board_(board),
      host_memory_(host_memory),
      host_base_(DeviceMap().host_memory),
      host_end_(host_base_ + host_memory_bytes),
      has_pixels_(has_pixels) {}

bool DmaBursts::skip(std::uint64_t now_ps, std::uint64_t end_ps) {
  pci::DmaChannel* const channel = bridge_.lone_channel();
  if (channel == nullptr || !buses_.pci.decides_next()) return false;
  const auto here = beginning(now_ps, *channel);
  if (!here) return false;
  const std::size_t burst_words = channel->on_pci().words.size();
  if (!(*here == beginning_)) {
    step_.reset();
  } else if (!step_) {
    step_ = recorded(burst_words);
  }
  beginning_ = *here;
  if (!step_) {
    before_ = {now_ps, buses_.pci.counts(kBridge), buses_.counts()};
    return false;
  }
  // All words of the skipped steps are moved before any other event, and before another master can have the
  // bus.
  const std::uint64_t request = buses_.pci.earliest_request_beside(pci::PciBusControl::mask_of(kBridge));
  if (request != kNever) end_ps = std::min(end_ps, buses_.pci_clock().edge_ps(request) + 1);
  if (end_ps <= now_ps) return false;
  const std::uint64_t first = pace().edge_at_or_after(now_ps);
  const std::uint64_t clocks = pace().edge_at_or_after(end_ps) - 1 - first;
  const std::size_t bursts_left = (channel->moving().words - channel->written()) / burst_words;
  if (bursts_left < 2) return false;
  const std::uint64_t steps = std::min<std::uint64_t>(clocks / period(), bursts_left - 1);
  if (steps == 0) return false;
  apply(now_ps, *channel, steps);
  skipped_ += steps;
  return true;
}

// The beginning of the step that the channel takes at `now_ps`; nothing if the step cannot be skipped.
std::optional<DmaBursts::Beginning> DmaBursts::beginning(std::uint64_t now_ps,
                                                         const pci::DmaChannel& channel) const {
  const std::uint64_t request = buses_.pci.request_clock(kBridge);
  if (request != buses_.pci_clock().edge_at_or_after(now_ps)) return std::nullopt;
  const auto& [to_pci, pci_address, local_address, words, next] = channel.moving();
  const std::uint64_t bytes = 4 * words;
  if (pci_address < host_base_ || pci_address + bytes > host_end_) return std::nullopt;
  const std::size_t bank = memory::bank_of_address(local_address);
  if (memory::bank_of_address(local_address + bytes - 4) != bank ||
      !board_.serves_one_word_per_cycle(local_address, bytes))
    return std::nullopt;
  const pci::PciBusControl::Position position = buses_.pci.position();
  return Beginning{
      channel.number(), to_pci, bank, bridge_.turn(), position.last_granted, position.free_clock > request};
}

// The step that began in the state before_ and has just ended; nothing if others had a bus too, or if steps like
// this one cannot be skipped.
std::optional<DmaBursts::Step> DmaBursts::recorded(std::size_t burst_words) const {
  const BusCounts buses = buses_.counts().since(before_.buses);
  pci::PciBusControl::MasterCounts counts = buses_.pci.counts(kBridge);
  counts.subtract(before_.counts);
  if (buses.transactions != 1 || buses.bursts != 1 || counts.words != burst_words) return std::nullopt;
  const std::uint64_t local_begin = buses_.local_clock().edge_at_or_after(before_.now_ps);
  Step step;
  step.pci_free = buses_.pci.position().free_clock - buses_.pci_clock().edge_at_or_after(before_.now_ps);
  step.local_free = buses_.local.idle_clock() + 1 - local_begin;
  step.first_word = buses_.local.request_clock() - local_begin;
  step.wait_clocks = counts.wait_clocks;
  step.pci_busy = buses.pci_busy;
  step.local_busy = buses.local_busy;
  return keeps_pace(step) ? std::optional(step) : std::nullopt;
}

// Whether the bus that ended last does so too where the other one begins up to a clock later.
bool DmaBursts::keeps_pace(const Step& step) const {
  const Clock& pci = buses_.pci_clock();
  const Clock& local = buses_.local_clock();
  const std::uint64_t pci_clocks = step.pci_free - 1;  // to the end of the burst
  return beginning_.waits_for_pci ? local.edge_ps(step.local_free + 1) + kRounding <= pci.edge_ps(pci_clocks)
                                  : pci.edge_ps(pci_clocks + 1) + kRounding <= local.edge_ps(step.local_free);
}

void DmaBursts::apply(std::uint64_t now_ps, pci::DmaChannel& channel, std::size_t steps) {
  const std::uint64_t first = pace().edge_at_or_after(now_ps);
  const std::uint64_t last_ps = pace().edge_ps(first + (steps - 1) * period());  // the last step begins
  const std::uint64_t end_ps = pace().edge_ps(first + steps * period());
  const std::size_t burst_words = channel.on_pci().words.size();
  const std::size_t words = steps * burst_words;
  const std::uint64_t first_local = buses_.local_clock().edge_at_or_after(now_ps);
  const std::uint64_t last_local = buses_.local_clock().edge_at_or_after(last_ps);
  const pci::BridgeTransfer& on_local_bus = channel.on_local_bus();
  std::uint32_t* const in_bank =
      board_.skip_words(on_local_bus.write, on_local_bus.address, words, first_local + step_->first_word,
                        last_local + step_->first_word + burst_words);
  if (board_.is_recorded()) {
    bursts_.clear();
    for (std::size_t step = 0; step < steps; ++step) {
      const std::uint64_t local =
          buses_.local_clock().edge_at_or_after(pace().edge_ps(first + step * period()));
      bursts_.push_back({local + step_->first_word, burst_words});
    }
    board_.record_skipped(on_local_bus.write, on_local_bus.address, 0, bursts_);
  }
  buses_.local.skip_bursts(steps, steps * step_->local_busy, last_local + step_->local_free - 1);
  move_words(channel, words, in_bank);
  buses_.pci.skip_bursts(kBridge, {steps, words, steps * step_->wait_clocks, 0, 0});
  buses_.pci.skip_to(
      {buses_.pci.position().last_granted, buses_.pci_clock().edge_at_or_after(last_ps) + step_->pci_free},
      steps * step_->pci_busy);
  bridge_.skip_dma(end_ps, channel, steps);
}

// The words of the first burst are in the channel already, and those of the burst behind the skipped ones are
// there in the end.
void DmaBursts::move_words(pci::DmaChannel& channel, std::size_t words, std::uint32_t* in_bank) {
  const bool to_pci = channel.moving().to_pci;
  std::vector<std::uint32_t>& burst = (to_pci ? channel.on_pci() : channel.on_local_bus()).words;
  const std::size_t bytes_of_burst = 4 * burst.size();
  auto* const bank = reinterpret_cast<unsigned char*>(in_bank);
  const std::size_t written = channel.written();
  const unsigned char* from = to_pci ? bank : host_words(channel, written);
  if (!to_pci || has_pixels_) {
    unsigned char* to = to_pci ? host_words(channel, written - burst.size()) : bank;
    std::memcpy(to, burst.data(), bytes_of_burst);
    std::memcpy(to + bytes_of_burst, from, 4 * words - bytes_of_burst);
  }
  std::memcpy(burst.data(), from + 4 * words - bytes_of_burst, bytes_of_burst);
}

}  // namespace stereotlm::platform
