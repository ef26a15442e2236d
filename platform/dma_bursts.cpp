#include "platform/dma_bursts.h"

#include <algorithm>
#include <cstring>

#include "models/memory/memory_config.h"
#include "models/time_ps.h"
#include "platform/computer_parts.h"
#include "platform/device_map.h"

namespace stereotlm::platform {
namespace {

// Each time is rounded to whole ps. So the ends of the two bursts of a step may come closer by this number of
// ps than those of another step.
constexpr std::uint64_t kRounding = 4;
// Bursts that are skipped at once where the core needs each of them. Short series come again in the same
// state of the core.
constexpr std::uint64_t kMostInSeries = 16;

}  // namespace

DmaBursts::DmaBursts(pci::PciBusControl& pci_bus, pci::BridgeControl& bridge, FastBoard& board,
                     unsigned char* host_memory, std::uint64_t host_memory_bytes)
    : pci_bus_(pci_bus),
      local_bus_(board.local_bus()),
      bridge_(bridge),
      board_(board),
      host_memory_(host_memory),
      host_memory_bytes_(host_memory_bytes) {}

bool DmaBursts::skip(std::uint64_t now_ps, std::uint64_t end_ps) {
  channel_ = bridge_.lone_channel();
  if (channel_ == nullptr) return false;
  const auto here = beginning();
  if (!here) return false;
  if (*here != beginning_) {
    step_.reset();
  } else if (!step_) {
    step_ = recorded();
  }
  beginning_ = *here;
  if (!step_) {
    before_ = {now_ps, pci_bus_.counts(kBridge), BusCounts::of(pci_bus_, local_bus_)};
    return false;
  }
  // All steps end before any other event, and before another master can have the bus.
  const std::uint64_t request = pci_bus_.earliest_request_beside(pci::PciBusControl::mask_of(kBridge));
  if (request != kNever) end_ps = std::min(end_ps, pci_bus_.clock().edge_ps(request) + 1);
  const std::uint64_t first = pace().edge_at_or_after(now_ps);
  const std::uint64_t end = pace().edge_at_or_after(end_ps);
  const std::uint64_t bursts_left =
      (channel_->moving().words - channel_->written()) / channel_->on_pci().words.size();
  if (end <= first || bursts_left < 2) return false;
  const std::uint64_t most =
      board_.needs_each_burst(channel_->on_local_bus().address) ? kMostInSeries : UINT64_MAX;
  const std::uint64_t steps = std::min({(end - 1 - first) / period(), bursts_left - 1, most});
  if (steps == 0) return false;
  apply(now_ps, steps);
  skipped_ += steps;
  return true;
}

// The beginning of the step that the channel takes now; nothing if the step cannot be skipped.
std::optional<DmaBursts::Beginning> DmaBursts::beginning() const {
  const pci::PciBusControl::Position position = pci_bus_.position();
  if (position.last_granted != kBridge) return std::nullopt;  // another burst may run
  const pci::DmaDescriptor& moving = channel_->moving();
  const std::uint64_t bytes = 4 * moving.words;
  const std::uint64_t in_host_memory = moving.pci_address - DeviceMap().host_memory;  // huge below it
  if (in_host_memory > host_memory_bytes_ || bytes > host_memory_bytes_ - in_host_memory ||
      !board_.serves_one_word_per_cycle(!moving.to_pci, moving.local_address, bytes))
    return std::nullopt;
  return Beginning{memory::bank_of_address(moving.local_address), moving.to_pci, bridge_.turn(),
                   position.free_clock > pci_bus_.request_clock(kBridge)};
}

// The step that began in the state before_ and has just ended; nothing if others had a bus too, or if steps
// like this one cannot be skipped.
std::optional<DmaBursts::Step> DmaBursts::recorded() const {
  Step step;
  step.buses = BusCounts::of(pci_bus_, local_bus_).since(before_.buses);
  pci::PciBusControl::MasterCounts counts = pci_bus_.counts(kBridge);
  counts.subtract(before_.counts);
  if (step.buses.transactions != 1 || step.buses.bursts != 1 ||
      counts.words != channel_->on_pci().words.size())
    return std::nullopt;
  const Clock& pci = pci_bus_.clock();
  const Clock& local = local_bus_.clock();
  const std::uint64_t first_local = local.edge_at_or_after(before_.now_ps);
  step.pci_end = pci_bus_.position().free_clock - 1 - pci.edge_at_or_after(before_.now_ps);
  step.local_free = local_bus_.idle_clock() + 1 - first_local;
  step.first_word = local_bus_.first_request_clock() - first_local;
  step.wait_clocks = counts.wait_clocks;
  // The bus that ends first must do so too where it begins up to a clock later.
  const bool keeps_pace = pci_ends_last()
                              ? local.edge_ps(step.local_free + 1) + kRounding <= pci.edge_ps(step.pci_end)
                              : pci.edge_ps(step.pci_end + 1) + kRounding <= local.edge_ps(step.local_free);
  return keeps_pace ? std::optional(step) : std::nullopt;
}

void DmaBursts::apply(std::uint64_t now_ps, std::uint64_t steps) {
  const std::uint64_t first = pace().edge_at_or_after(now_ps);
  const std::uint64_t last_ps = pace().edge_ps(first + (steps - 1) * period());  // the last step begins
  const std::uint64_t end_ps = pace().edge_ps(first + steps * period());
  const Clock& pci = pci_bus_.clock();
  const Clock& local = local_bus_.clock();
  const pci::BridgeTransfer& transfer = channel_->on_local_bus();
  const std::uint64_t burst_words = transfer.words.size();
  const std::uint64_t words = steps * burst_words;
  bursts_.clear();
  if (board_.needs_each_burst(transfer.address)) {
    for (std::uint64_t step = 0; step < steps; ++step) {
      const std::uint64_t begin_ps = pace().edge_ps(first + step * period());
      bursts_.push_back({transfer.write, transfer.address + 4 * step * burst_words,
                         local.edge_at_or_after(begin_ps) + step_->first_word, burst_words});
    }
  } else {
    bursts_.push_back(
        {transfer.write, transfer.address, local.edge_at_or_after(now_ps) + step_->first_word, words});
  }
  board_.skip_bursts(bursts_);
  local_bus_.skip_bursts(steps, steps * step_->buses.local_busy,
                         local.edge_at_or_after(last_ps) + step_->local_free - 1);
  move_words(words, board_.count_skipped(transfer.write, transfer.address, words));
  pci_bus_.skip_bursts(kBridge, {steps, words, steps * step_->wait_clocks, 0, 0});
  pci_bus_.skip_to({kBridge, pci.edge_at_or_after(last_ps) + step_->pci_end + 1},
                   steps * step_->buses.pci_busy);
  bridge_.skip_dma(end_ps, *channel_, steps);
}

// The channel has the words of the first burst already. In the end it has those of the burst that it writes
// next.
void DmaBursts::move_words(std::uint64_t words, unsigned char* in_bank) {
  const bool to_pci = channel_->moving().to_pci;
  std::vector<std::uint32_t>& burst = (to_pci ? channel_->on_pci() : channel_->on_local_bus()).words;
  unsigned char* const host = host_memory_ + (channel_->on_pci().address - DeviceMap().host_memory);
  const unsigned char* const from = to_pci ? in_bank : host;
  unsigned char* const to = to_pci ? host : in_bank;
  const std::size_t bytes_of_burst = 4 * burst.size();
  const std::size_t bytes_behind = 4 * words - bytes_of_burst;
  std::memcpy(to, burst.data(), bytes_of_burst);
  std::memcpy(to + bytes_of_burst, from, bytes_behind);
  std::memcpy(burst.data(), from + bytes_behind, bytes_of_burst);
}

}  // namespace stereotlm::platform
