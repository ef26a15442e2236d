#include "models/pci/bridge_control.h"

#include <algorithm>
#include <cstring>

namespace stereotlm::pci {

BridgeRegisterFile::Decoded BridgeRegisterFile::decode(std::uint64_t offset) {
  if (offset < bridge::kInterruptStatus)
    return {bridge::kPage, static_cast<std::size_t>((offset - bridge::kPage) / 4)};
  if (offset < bridge::kDmaDescriptor) return {offset, 0};
  const std::uint64_t in_channels = offset - bridge::kDmaDescriptor;
  return {bridge::kDmaDescriptor + in_channels % bridge::kChannelStride,
          static_cast<std::size_t>(in_channels / bridge::kChannelStride)};
}

bool BridgeRegisterFile::allows(bool write, std::uint64_t offset) {
  if (offset >= bridge::kRegisterWindowBytes) return false;
  switch (decode(offset).name) {
    case bridge::kPage:
    case bridge::kInterruptStatus:
    case bridge::kInterruptEnable:
    case bridge::kDmaDescriptor:
      return true;
    case bridge::kDmaControl:
      return write;
    case bridge::kDmaStatus:
      return !write;
    default:
      return false;
  }
}

std::uint32_t BridgeRegisterFile::read(std::uint64_t offset) const {
  const auto [name, index] = decode(offset);
  switch (name) {
    case bridge::kPage:
      return pages_[index];
    case bridge::kInterruptStatus:
      return interrupt_status_;
    case bridge::kInterruptEnable:
      return interrupt_enable_;
    case bridge::kDmaDescriptor:
      return channels_[index].descriptor();
    default:
      return std::uint32_t{channels_[index].busy()};
  }
}

DmaChannel* BridgeRegisterFile::write(std::uint64_t offset, std::uint32_t value) {
  const auto [name, index] = decode(offset);
  switch (name) {
    case bridge::kPage:
      pages_[index] = value;
      break;
    case bridge::kInterruptStatus:
      interrupt_status_ &= ~value;
      break;
    case bridge::kInterruptEnable:
      interrupt_enable_ = value & bridge::kAllInterrupts;
      break;
    case bridge::kDmaDescriptor:
      channels_[index].set_descriptor(value);
      break;
    default:
      if ((value & 1U) != 0) return &channels_[index];
  }
  return nullptr;
}

BridgeControl::BridgeControl(const PciBridgeConfig& config, PciSlot& slot, LocalBusIf& local_bus, Host& host)
    : config_(config),
      slot_(slot),
      host_(host),
      channels_{{{0, static_cast<std::size_t>(config.dma_burst_words)},
                 {1, static_cast<std::size_t>(config.dma_burst_words)}}},
      local_bus_(config_, channels_, local_bus, *this),
      words_taken_(config.buffers) {}

void BridgeControl::observe(BridgeObserver& observer) {
  observer_ = &observer;
  for (DmaChannel& channel : channels_) channel.observe(observer);
}

std::size_t BridgeControl::postable_words(std::uint64_t now_ps, std::size_t words) const {
  return std::min(words, local_bus_.free_places(now_ps));
}

std::uint64_t BridgeControl::local_address_of(std::uint64_t offset) const {
  if (offset >= bridge::kCoreRegisters) return config_.core_registers + (offset - bridge::kCoreRegisters);
  const std::uint32_t page = register_file_.page(static_cast<std::size_t>(offset / bridge::kApertureBytes));
  return bridge::local_address(page) + offset % bridge::kApertureBytes;
}

// A burst may cross from one aperture into the next, which has a page of its own.
bool BridgeControl::write(std::uint64_t now_ps, std::uint64_t offset, const unsigned char* data,
                          std::size_t words) {
  if (words > local_bus_.free_places(now_ps)) {
    count_error();
    return false;
  }
  local_bus_.settle(now_ps);
  for (const std::uint64_t end = offset + 4 * words; offset < end;) {
    const std::uint64_t border = offset < bridge::kCoreRegisters
                                     ? (offset / bridge::kApertureBytes + 1) * bridge::kApertureBytes
                                     : end;
    const std::uint64_t here = std::min(border, end) - offset;
    const std::uint64_t address = local_address_of(offset);
    local_bus_.post(address, data, here / 4);
    count_for_banks(words_taken_, address, here / 4);
    offset += here;
    data += here;
  }
  stats_.posted_words += words;
  stats_.most_posted_words = std::max<std::uint64_t>(stats_.most_posted_words, local_bus_.posted().words());
  local_bus_.send_posted(now_ps, words);
  return true;
}

void BridgeControl::read(std::uint64_t now_ps, std::uint64_t offset, unsigned char* data, std::size_t words) {
  read_data_ = data;
  local_bus_.read(now_ps, local_address_of(offset), words);
}

void BridgeControl::slave_read_ended(std::uint64_t now_ps, const BridgeTransfer& read) {
  if (read.failed) {
    count_error();
  } else {
    stats_.slave_reads += read.words.size();
    std::memcpy(read_data_, read.words.data(), 4 * read.words.size());
  }
  host_.slave_read_ended(now_ps, !read.failed);
}

// Words for the core's registers are not counted.
void BridgeControl::count_for_banks(WordsByRange& counts, std::uint64_t address, std::size_t words) const {
  if (address >= config_.core_registers) return;
  counts.add(address, std::min<std::uint64_t>(words, (config_.core_registers - address) / 4));
}

WordsByRange BridgeControl::words_held() const {
  WordsByRange held(config_.buffers);
  for (const PostedWrites::Run& run : local_bus_.posted().waiting())
    count_for_banks(held, run.address, run.words);
  for (const DmaChannel& channel : channels_) {
    const BridgeTransfer& to = channel.on_local_bus();
    if (to.under_way && to.write && !local_bus_.runs(to)) held.add(to.address, to.words.size());
  }
  return held;
}

bool BridgeControl::is_idle() const {
  return pci_queue_.front() == nullptr && local_bus_.is_idle() &&
         std::none_of(channels_.begin(), channels_.end(),
                      [](const DmaChannel& channel) { return channel.busy(); });
}

std::optional<std::uint64_t> BridgeControl::bank_address(std::uint64_t offset, std::uint64_t bytes) const {
  const std::uint64_t last = offset + bytes - 4;
  if (last >= bridge::kCoreRegisters || offset / bridge::kApertureBytes != last / bridge::kApertureBytes)
    return std::nullopt;
  const std::uint64_t address = local_address_of(offset);
  if (address / bridge::kBankBytes != (address + bytes - 4) / bridge::kBankBytes) return std::nullopt;
  return address;
}

void BridgeControl::skip_posted(std::size_t turn, std::uint64_t most_posted) {
  local_bus_.set_turn(turn);
  stats_.most_posted_words = std::max(stats_.most_posted_words, most_posted);
}

void BridgeControl::count_skipped(std::uint64_t address, std::uint64_t words) {
  stats_.posted_words += words;
  count_for_banks(words_taken_, address, words);
}

PciAnswer BridgeControl::access(std::uint64_t now_ps, const PciAccess& access, std::uint64_t at_ps) {
  if (access.count != 1 || !BridgeRegisterFile::allows(access.write, access.address)) {
    count_error();
    return {at_ps, false};
  }
  if (access.write) {
    DmaChannel* const started = register_file_.write(access.address, *access.words);
    drive_interrupts(now_ps);
    if (observer_ != nullptr && access.address == bridge::kInterruptStatus)
      observer_->interrupts_cleared(now_ps, *access.words);
    if (started != nullptr) run(now_ps, started->start(now_ps));
  } else {
    *access.words = register_file_.read(access.address);
  }
  return {at_ps, true};
}

void BridgeControl::raise(std::uint64_t now_ps, std::uint32_t interrupts) {
  constexpr std::uint32_t kNoErrors = bridge::kDoorbell | bridge::kDmaDone | bridge::kDmaDone << 1U;
  if ((interrupts & ~kNoErrors) != 0) count_error();
  register_file_.raise(interrupts);
  if (observer_ != nullptr) observer_->interrupts_raised(now_ps, interrupts);
  drive_interrupts(now_ps);
}

void BridgeControl::drive_interrupts(std::uint64_t now_ps) {
  if (interrupts_ == register_file_.interrupts()) return;
  interrupts_ = !interrupts_;
  host_.interrupt_changed(now_ps);
}

void BridgeControl::run(std::uint64_t now_ps, const DmaChannel::Step& step) {
  for (BridgeTransfer* const transfer : step.starts) {
    if (transfer == nullptr) continue;
    const bool on_pci = transfer == &transfer->channel->on_pci();
    if (transfer->write) {
      stats_.dma_words += transfer->words.size();
      if (!on_pci) words_taken_.add(transfer->address, transfer->words.size());
    }
    on_pci ? start_on_pci(now_ps, *transfer) : local_bus_.start(now_ps, *transfer);
  }
  if (step.interrupts != 0) raise(now_ps, step.interrupts);
}

void BridgeControl::advance(std::uint64_t now_ps, DmaChannel& channel) {
  local_bus_.settle(now_ps);
  if (channel.waits_for_local_bus()) local_bus_.await_end();
  run(now_ps, channel.next_step(now_ps));
}

void BridgeControl::start_on_pci(std::uint64_t now_ps, BridgeTransfer& transfer) {
  transfer.under_way = true;
  transfer.failed = false;
  *std::find(pci_queue_.begin(), pci_queue_.end(), nullptr) = &transfer;
  slot_.request(*this, now_ps);
}

// A transfer that was cut continues with its next word.
PciBurst BridgeControl::begin_burst(std::uint64_t /*address_clock_ps*/) {
  if (pci_queue_.front() == nullptr) return {};
  const BridgeTransfer& transfer = *pci_queue_.front();
  pci_words_.assign(transfer.words.begin() + static_cast<std::ptrdiff_t>(pci_done_), transfer.words.end());
  return {transfer.write, transfer.address + pci_done_ * 4, &pci_words_};
}

void BridgeControl::end_burst(const BurstResult& result) {
  BridgeTransfer& transfer = *pci_queue_.front();
  if (!transfer.write) {
    std::copy_n(pci_words_.begin(), result.words,
                transfer.words.begin() + static_cast<std::ptrdiff_t>(pci_done_));
  }
  pci_done_ += result.words;
  const bool failed = is_error(result.end);
  const bool ended = failed || pci_done_ == transfer.words.size();
  if (ended) {
    std::move(pci_queue_.begin() + 1, pci_queue_.end(), pci_queue_.begin());
    pci_queue_.back() = nullptr;
    pci_done_ = 0;
    transfer.failed = failed;
    transfer.under_way = false;
  }
  if (pci_queue_.front() != nullptr) slot_.request(*this, result.end_ps);
  if (ended) advance(result.end_ps, *transfer.channel);
}

}  // namespace stereotlm::pci
