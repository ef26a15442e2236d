#include "models/memory/memory_config.h"

#include <algorithm>

#include "models/memory/arbitration_policies.h"

namespace stereotlm::memory {

static_assert(
    [] {
      for (std::size_t kind = 0; kind < kBankTraits.size(); ++kind) {
        if (kBankTraits[kind].kind != static_cast<BankKind>(kind)) return false;
      }
      return true;
    }(),
    "the rows of kBankTraits are in the order of BankKind");
static_assert(
    [] {
      for (const BankTraits& bank : kBankTraits) {
        if (bank.ports != 1 && (bank.ports != 2 || bank.has_turnaround)) return false;
      }
      return true;
    }(),
    "BankArbiter serves one port, or a read port and a write port without turnaround");

std::string broken_turnaround_rule(BankKind kind, int turnaround_cycles) {
  const BankTraits& traits = traits_of(kind);
  const kernels::IntegerRule rule = traits.has_turnaround ? kTurnaroundRule : kernels::IntegerRule{0, 0};
  if (rule.allows(turnaround_cycles)) return "";
  return (traits.has_turnaround ? rule.text() : "0") + " for " + traits.name;
}

std::vector<std::string> problems(const SsramBankConfig& config) {
  std::vector<std::string> found;
  kBankWordsRule.check("words", config.words, found);
  if (!is_bank_kind(config.kind)) {
    found.push_back("kind = " + std::to_string(static_cast<int>(config.kind)) + ": must be a BankKind");
  } else if (const auto rule = broken_turnaround_rule(config.kind, config.turnaround_cycles); !rule.empty()) {
    found.push_back("turnaround_cycles = " + std::to_string(config.turnaround_cycles) + ": must be " + rule);
  }
  if (config.sdram.has_value() != (config.kind == BankKind::kSdram))
    found.emplace_back(config.sdram ? "sdram: only for the kind sdram" : "sdram: missing for the kind sdram");
  if (config.sdram) {
    for (const std::string& problem : problems(*config.sdram)) found.push_back("sdram: " + problem);
  }
  if (!(config.clock_mhz >= 1 && config.clock_mhz <= 1000)) {
    found.push_back("clock_mhz = " + std::to_string(config.clock_mhz) + ": must be 1..1000");
  }
  return found;
}

std::vector<std::string> problems(const ArbiterConfig& config) {
  std::vector<std::string> found;
  if (find_arbitration_policy(config.policy) == nullptr) {
    std::string names;
    for (const ArbitrationPolicy& policy : arbitration_policies())
      names += (names.empty() ? "" : ", ") + std::string(policy.name);
    found.push_back("policy = " + config.policy + ": must be one of " + names);
  }
  const std::size_t ports = config.priority.size();
  if (ports == 0 || ports > kMostPorts) {
    found.push_back("priority = " + std::to_string(ports) + " ports: must be 1.." +
                    std::to_string(kMostPorts));
  }
  for (Port port = 0; port < ports; ++port) {
    const auto times = std::count(config.priority.begin(), config.priority.end(), port);
    if (times != 1) {
      found.push_back("priority: port " + std::to_string(port) + " is named " + std::to_string(times) +
                      " times: must be once");
    }
  }
  return found;
}

}  // namespace stereotlm::memory
