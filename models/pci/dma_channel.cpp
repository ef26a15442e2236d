#include "models/pci/dma_channel.h"

#include <algorithm>

namespace stereotlm::pci {

DmaChannel::DmaChannel(unsigned number, std::size_t burst_words)
    : number_(number), burst_words_(burst_words) {}

DmaChannel::Step DmaChannel::start(std::uint64_t now_ps) {
  if (busy_) return {{}, bridge::kDmaError << number_};
  busy_ = true;
  pci_.failed = false;
  local_.failed = false;
  if (observer_ != nullptr) observer_->dma_started(number_, now_ps);
  return fetch(now_ps, descriptor_);
}

DmaChannel::Step DmaChannel::next_step(std::uint64_t now_ps) {
  if (!busy_ || pci_.under_way || local_.under_way) return {};
  if (pci_.failed || local_.failed) return finish(bridge::kDmaError);
  if (fetching_) {
    fetching_ = false;
    if (!decode_descriptor()) return finish(bridge::kDmaError);
    if (observer_ != nullptr) {
      observer_->transfer_begun({number_, fetch_ps_, moving_.to_pci, moving_.local_address, moving_.words});
    }
    return {{&read_burst()}, 0};
  }
  if (written_ < moving_.words) {
    Step step{{&write_burst()}, 0};
    if (written_ < moving_.words) step.starts[1] = &read_burst();
    return step;
  }
  return end_descriptor(now_ps);
}

DmaChannel::Step DmaChannel::end_descriptor(std::uint64_t now_ps) {
  if (observer_ != nullptr) observer_->transfer_ended(number_, now_ps);
  return moving_.next != 0 ? fetch(now_ps, moving_.next) : finish(bridge::kDmaDone);
}

DmaChannel::Step DmaChannel::finish(std::uint32_t interrupt) {
  busy_ = false;
  return {{}, interrupt << number_};
}

DmaChannel::Step DmaChannel::fetch(std::uint64_t now_ps, std::uint32_t address) {
  if (address % 16 != 0) return finish(bridge::kDmaError);
  fetch_ps_ = now_ps;
  fetching_ = true;
  pci_.write = false;
  pci_.address = address;
  pci_.words.resize(4);
  return {{&pci_}, 0};
}

bool DmaChannel::decode_descriptor() {
  const std::vector<std::uint32_t>& words = pci_.words;
  moving_.pci_address = words[0];
  moving_.local_address = bridge::local_address(words[1]);
  moving_.to_pci = (words[2] & bridge::kToPci) != 0;
  moving_.words = words[2] & ~bridge::kToPci;
  moving_.next = words[3];
  written_ = 0;
  return moving_.words != 0 && moving_.pci_address % 4 == 0;
}

BridgeTransfer& DmaChannel::read_burst() {
  source().words.resize(std::min(burst_words_, moving_.words - written_));
  return prepare(source(), false);
}

// Writes the words that the last burst has read.
BridgeTransfer& DmaChannel::write_burst() {
  BridgeTransfer& to = moving_.to_pci ? pci_ : local_;
  to.words.swap(source().words);
  prepare(to, true);
  written_ += to.words.size();
  return to;
}

BridgeTransfer& DmaChannel::prepare(BridgeTransfer& transfer, bool write) const {
  transfer.write = write;
  transfer.address = (&transfer == &pci_ ? moving_.pci_address : moving_.local_address) + written_ * 4;
  return transfer;
}

}  // namespace stereotlm::pci
