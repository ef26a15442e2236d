#include "models/pci/traffic_control.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace stereotlm::pci {

void TrafficControl::start(PciSlot& slot) {
  slot_ = &slot;
  slot.request(*this, config_.first_request_ps);
}

PciBurst TrafficControl::begin_burst(std::uint64_t /*address_clock_ps*/) {
  words_.resize(static_cast<std::size_t>(config_.burst_words) - words_done_);
  return {false, config_.address + 4 * words_done_, &words_};
}

void TrafficControl::end_burst(const BurstResult& result) {
  if (is_error(result.end)) {
    throw std::runtime_error(
        "address = " + std::to_string(config_.address) + ": " +
        (result.end == BurstEnd::kMasterAbort ? "no target answers" : "the target answers with an error"));
  }
  words_done_ += result.words;
  if (result.end != BurstEnd::kComplete) {
    slot_->request(*this, result.end_ps);
    return;
  }
  words_done_ = 0;
  ++transfers_;
  const std::uint64_t due_ps = config_.first_request_ps + transfers_ * config_.interval_ps;
  slot_->request(*this, std::max(due_ps, result.end_ps));
}

}  // namespace stereotlm::pci
