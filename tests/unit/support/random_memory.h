#pragma once

#include <algorithm>

#include "models/fpga/core_ports.h"
#include "models/memory/arbitration_policies.h"
#include "models/memory/memory_config.h"
#include "tests/support/random_board.h"

namespace stereotlm::test {

// Any policy and any order of the ports.
inline memory::ArbiterConfig random_arbiter(SplitMix64& random) {
  const auto& policies = memory::arbitration_policies();
  memory::ArbiterConfig config = fpga::core_arbiter();
  config.policy =
      policies[static_cast<std::size_t>(random.between(0, static_cast<int>(policies.size()) - 1))].name;
  auto& list = config.priority;
  for (auto place = list.begin(); place != list.end(); ++place)
    std::iter_swap(place, place + random.between(0, static_cast<int>(list.end() - place) - 1));
  return config;
}

// The default bank, but of any kind.
inline memory::SsramBankConfig random_bank(SplitMix64& random) {
  const int kinds = static_cast<int>(memory::kBankTraits.size());
  memory::SsramBankConfig config;
  config.kind = static_cast<memory::BankKind>(random.between(0, kinds - 1));
  if (memory::traits_of(config.kind).has_turnaround) config.turnaround_cycles = random.mostly_small(1, 3, 16);
  return config;
}

}  // namespace stereotlm::test
