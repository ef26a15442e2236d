#include "models/fpga/stall_watchdog.h"

#include <algorithm>

namespace stereotlm::fpga {
namespace {

std::string text_of(Intent intent) {
  switch (intent) {
    case Intent::kRequest:
      return "asks for bank number ";
    case Intent::kPass:
      return "passes a slot";
    case Intent::kBlocked:
      return "is blocked: its lane is full";
    case Intent::kStarved:
      return "is starved";
    case Intent::kIdle:
      break;
  }
  return "is idle";
}

std::string losses_of(std::size_t port, const memory::ArbiterStats& arbiter) {
  const auto& blame = arbiter.blame[port];
  const auto most = std::max_element(blame.begin(), blame.end());
  if (*most == 0) return {};
  const auto by = static_cast<std::size_t>(most - blame.begin());
  return ", lost " + std::to_string(*most) + " cycles to " +
         (by == memory::ArbiterStats::kTurnaround ? "turnaround" : kPorts[by].name);
}

}  // namespace

std::uint64_t StallWatchdog::stalled_cycles(std::uint64_t cycle, std::uint64_t work) {
  if (work != work_) {
    start_frame(cycle, work);
    return 0;
  }
  const std::uint64_t cycles = cycle - work_cycle_;
  if (cycles < timeout_cycles_) return 0;
  work_cycle_ = cycle;
  return cycles;
}

std::string waits_of_ports(const CoreControl& control, const memory::Arbitration& arbitration,
                           bool host_requests) {
  const CoreControl::Decision decision = control.decide();
  std::string text;
  for (std::size_t port = 0; port < kPortCount; ++port) {
    const Intent host = host_requests ? Intent::kRequest : Intent::kIdle;
    const Intent intent = port < kCorePortCount ? decision.intents[port] : host;
    text += std::string(port == 0 ? "" : "; ") + kPorts[port].name + ' ' + text_of(intent);
    if (intent != Intent::kRequest) continue;
    const std::size_t bank = arbitration.bank_of(port);
    text += std::to_string(bank) + losses_of(port, arbitration.arbiters()[bank].stats());
  }
  return text;
}

}  // namespace stereotlm::fpga
