#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
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
  void start(PciSlot& slot) {
    slot_ = &slot;
    slot.request(*this, config_.first_request_ps);
  }

  PciBurst begin_burst(std::uint64_t /*address_clock_ps*/) override {
    words_.resize(static_cast<std::size_t>(config_.burst_words) - words_done_);
    return {false, config_.address + 4 * words_done_, &words_};
  }
  // Throws std::runtime_error if the transfer was aborted.
  void end_burst(const BurstResult& result) override {
    if (is_error(result.end)) {
      throw std::runtime_error(
          "address = " + std::to_string(config_.address) + ": " +
          (result.end == BurstEnd::kMasterAbort ? "no target answers" : "the target answers with an error"));
    }
    words_done_ += result.words;
    if (result.end != BurstEnd::kComplete) return slot_->request(*this, result.end_ps);
    words_done_ = 0;
    ++transfers_;
    const std::uint64_t due_ps = config_.first_request_ps + transfers_ * config_.interval_ps;
    slot_->request(*this, std::max(due_ps, result.end_ps));
  }

 private:
  TrafficGeneratorConfig config_;
  PciSlot* slot_ = nullptr;
  std::vector<std::uint32_t> words_;
  std::size_t words_done_ = 0;   // words of the running transfer that have been read
  std::uint64_t transfers_ = 0;  // completed
};

}  // namespace stereotlm::pci
