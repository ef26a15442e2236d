#include "sw/trace/longest_wait.h"

#include <algorithm>
#include <utility>

namespace stereotlm::trace {

void LongestWait::add(const fpga::CoreCycle& cycle) {
  if (next_cycle_ == 0) first_added_ = cycle.cycle;
  if (cycle.cycle != next_cycle_) waited_ = {};
  next_cycle_ = cycle.cycle + 1;
  const bool grew = std::exchange(grows_, false);
  for (std::size_t port = 0; port < waited_.size(); ++port) {
    const fpga::PortCycle& now = cycle.ports[port];
    const bool waits = now.intent == fpga::Intent::kRequest && !now.granted;
    waited_[port] = waits ? waited_[port] + 1 : 0;
    const bool is_better = waited_[port] == cycles() ? lacks_cycles_before() : waited_[port] > cycles();
    if (waited_[port] == 0 || !is_better) continue;
    first_ = next_cycle_ - waited_[port];
    end_ = next_cycle_;
    grows_ = true;
  }
  if (grew && !grows_) kept_ = recent_;
  if (cycles() != 0 && !grows_ && cycle.cycle < end_around()) kept_.push_back(cycle);
  recent_.push_back(cycle);
  const std::uint64_t under_way = *std::max_element(waited_.begin(), waited_.end());
  while (recent_.front().cycle + kBefore + under_way < next_cycle_) recent_.pop_front();
}

std::deque<fpga::CoreCycle> LongestWait::take_kept() {
  if (grows_) kept_ = std::move(recent_);
  while (!kept_.empty() && kept_.front().cycle < begin_around()) kept_.pop_front();
  return std::move(kept_);
}

}  // namespace stereotlm::trace
