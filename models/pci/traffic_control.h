#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/pci/pci_config.h"
#include "models/pci/pci_slot.h"

namespace stereotlm::pci {

// The requests of TrafficGenerator. A transfer that the bus has cut, disconnected or retried continues
// immediately. An aborted transfer is the last one. Plain C++.
class TrafficControl : public PciMasterIf {
 public:
  // `config` must have no problems.
  explicit TrafficControl(const TrafficGeneratorConfig& config) : config_(config) {}

  // Makes the first request. `slot` outlives this object.
  void start(PciSlot& slot);

  PciBurst begin_burst(std::uint64_t address_clock_ps) override;
  // Throws std::runtime_error if the transfer was aborted.
  void end_burst(const BurstResult& result) override;

 private:
  TrafficGeneratorConfig config_;
  PciSlot* slot_ = nullptr;
  std::vector<std::uint32_t> words_;
  std::size_t words_done_ = 0;   // words of the running transfer that have been read
  std::uint64_t transfers_ = 0;  // completed
};

}  // namespace stereotlm::pci
