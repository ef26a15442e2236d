#include "models/memory/ssram_bank.h"

#include "models/checked.h"
#include "models/clock.h"
#include "models/kernel_time.h"

namespace stereotlm::memory {
namespace {

sc_core::sc_time read_time(const SsramBankConfig& config) {
  kernel_time::check_resolution();
  const auto cycles = static_cast<std::uint64_t>(read_latency_cycles(config.kind));
  return kernel_time::to_time(Clock(config.clock_mhz).edge_ps(cycles));
}

}  // namespace

SsramBank::SsramBank(const sc_core::sc_module_name& name, const SsramBankConfig& config)
    : sc_module(name),
      config_(checked(this->name(), config)),
      target_({std::uint64_t{config.words} * 4, true, true}, read_time(config), "/stereotlm/ssram_bank") {
  port.bind(target_);
}

}  // namespace stereotlm::memory
