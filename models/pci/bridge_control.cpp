#include "models/pci/bridge_control.h"

#include <algorithm>
#include <cstring>

namespace stereotlm::pci {

namespace {

unsigned char* data_of(std::uint32_t* words) { return reinterpret_cast<unsigned char*>(words); }

}  // namespace

BridgeControl::BridgeControl(const PciBridgeConfig& config, PciSlot& slot, LocalBusIf& local_bus, Host& host)
    : config_(config),
      slot_(slot),
      local_bus_(local_bus),
      host_(host),
      channels_{{{0, static_cast<std::size_t>(config.dma_burst_words)},
                 {1, static_cast<std::size_t>(config.dma_burst_words)}}},
      posted_(static_cast<std::size_t>(config.posted_words)),
      words_taken_(config.buffers) {
  pages_.fill({0});
}

void BridgeControl::observe(BridgeObserver& observer) {
  observer_ = &observer;
  for (DmaChannel& channel : channels_) channel.observe(observer);
}

std::size_t BridgeControl::postable_words(std::uint64_t now_ps, std::uint64_t offset,
                                          std::size_t words) const {
  const bool is_striped =
      offset < bridge::kCoreRegisters && pages_[offset / bridge::kApertureBytes].size() > 1;
  const std::size_t of_row = is_striped ? (border_behind(offset) - offset) / 4 : words;
  return std::min({words, of_row, free_places(now_ps)});
}

std::uint64_t BridgeControl::local_address_of(std::uint64_t offset) const {
  if (offset >= bridge::kCoreRegisters) return config_.core_registers + (offset - bridge::kCoreRegisters);
  const std::vector<std::uint32_t>& parts = pages_[offset / bridge::kApertureBytes];
  const std::uint64_t place = offset % bridge::kApertureBytes;
  if (parts.size() == 1) return bridge::local_address(parts.front()) + place;
  const std::uint64_t row = place / config_.row_bytes;
  return bridge::local_address(parts[row % parts.size()]) + row / parts.size() * config_.row_bytes +
         place % config_.row_bytes;
}

std::uint64_t BridgeControl::border_behind(std::uint64_t offset) const {
  if (offset >= bridge::kCoreRegisters) return bridge::kSlaveWindowBytes;
  const std::uint64_t place = offset % bridge::kApertureBytes;
  const std::uint64_t aperture = offset - place;
  const bool is_striped = pages_[offset / bridge::kApertureBytes].size() > 1;
  return is_striped ? aperture + (place / config_.row_bytes + 1) * config_.row_bytes
                    : aperture + bridge::kApertureBytes;
}

// A burst may cross from one aperture into the next, which has a page of its own.
bool BridgeControl::write(std::uint64_t now_ps, std::uint64_t offset, const unsigned char* data,
                          std::size_t words) {
  if (words > free_places(now_ps)) {
    count_error();
    return false;
  }
  settle(now_ps);
  stats_.posted_words += words;
  for (const std::uint64_t end = offset + 4 * words; offset < end;) {
    const std::uint64_t here = std::min(border_behind(offset), end) - offset;
    const std::uint64_t address = local_address_of(offset);
    posted_.push(address, data, here / 4);
    count_for_banks(words_taken_, address, here / 4);
    offset += here;
    data += here;
  }
  if (local_observer_ != nullptr) local_observer_->words_posted(now_ps, words);
  if (busy_) {
    plan();
  } else {
    serve(now_ps);  // posted writes are served first
  }
  return true;
}

void BridgeControl::read(std::uint64_t now_ps, std::uint64_t offset, unsigned char* data, std::size_t words) {
  read_data_ = data;
  read_.address = local_address_of(offset);
  read_.words.resize(words);
  start_on_local_bus(now_ps, read_);
}

WordsByRange BridgeControl::words_held() const {
  WordsByRange held(config_.buffers);
  for (const PostedWrites::Run& run : posted_.waiting()) count_for_banks(held, run.address, run.words);
  for (const DmaChannel& channel : channels_) {
    const BridgeTransfer& to = channel.on_local_bus();
    if (to.under_way && to.write && &to != running_) held.add(to.address, to.words.size());
  }
  return held;
}

BridgeControl::Register BridgeControl::decode(std::uint64_t offset) {
  if (offset < bridge::kInterruptStatus)
    return {bridge::kPage, static_cast<std::size_t>((offset - bridge::kPage) / 4)};
  if (offset < bridge::kDmaDescriptor) return {offset, 0};
  if (offset >= bridge::kNextPage)
    return {bridge::kNextPage, static_cast<std::size_t>((offset - bridge::kNextPage) / 4)};
  const std::uint64_t in_channels = offset - bridge::kDmaDescriptor;
  return {bridge::kDmaDescriptor + in_channels % bridge::kChannelStride,
          static_cast<std::size_t>(in_channels / bridge::kChannelStride)};
}

bool BridgeControl::allows(bool write, std::uint64_t offset) {
  if (offset >= bridge::kRegisterWindowBytes) return false;
  switch (decode(offset).name) {
    case bridge::kPage:
    case bridge::kInterruptStatus:
    case bridge::kInterruptEnable:
    case bridge::kDmaDescriptor:
      return true;
    case bridge::kDmaControl:
    case bridge::kNextPage:
      return write;
    case bridge::kDmaStatus:
      return !write;
    default:
      return false;
  }
}

std::uint32_t BridgeControl::read_register(const Register& its) const {
  switch (its.name) {
    case bridge::kPage:
      return pages_[its.index].front();
    case bridge::kInterruptStatus:
      return interrupt_status_;
    case bridge::kInterruptEnable:
      return interrupt_enable_;
    case bridge::kDmaDescriptor:
      return channels_[its.index].descriptor();
    default:
      return std::uint32_t{channels_[its.index].busy()};
  }
}

void BridgeControl::write_register(std::uint64_t now_ps, const Register& its, std::uint32_t value) {
  switch (its.name) {
    case bridge::kPage:
      pages_[its.index] = {value};
      return;
    case bridge::kNextPage:
      pages_[its.index].push_back(value);
      return;
    case bridge::kInterruptStatus:
      interrupt_status_ &= ~value;
      drive_interrupts(now_ps);
      if (observer_ != nullptr) observer_->interrupts_cleared(now_ps, value);
      return;
    case bridge::kInterruptEnable:
      interrupt_enable_ = value & bridge::kAllInterrupts;
      return drive_interrupts(now_ps);
    case bridge::kDmaDescriptor:
      return channels_[its.index].set_descriptor(value);
    default:
      if ((value & 1U) != 0) run(now_ps, channels_[its.index].start(now_ps));
  }
}

PciAnswer BridgeControl::access(std::uint64_t now_ps, const PciAccess& access, std::uint64_t at_ps) {
  if (access.count != 1 || !allows(access.write, access.address)) {
    count_error();
    return {at_ps, false};
  }
  if (access.write) {
    write_register(now_ps, decode(access.address), *access.words);
  } else {
    *access.words = read_register(decode(access.address));
  }
  return {at_ps, true};
}

void BridgeControl::raise(std::uint64_t now_ps, std::uint32_t interrupts) {
  constexpr std::uint32_t kNoErrors = bridge::kDoorbell | bridge::kDmaDone | bridge::kDmaDone << 1U;
  if ((interrupts & ~kNoErrors) != 0) count_error();
  interrupt_status_ |= interrupts;
  if (observer_ != nullptr) observer_->interrupts_raised(now_ps, interrupts);
  drive_interrupts(now_ps);
}

void BridgeControl::drive_interrupts(std::uint64_t now_ps) {
  if (interrupts_ == ((interrupt_status_ & interrupt_enable_) != 0)) return;
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
    on_pci ? start_on_pci(now_ps, *transfer) : start_on_local_bus(now_ps, *transfer);
  }
  if (step.interrupts != 0) raise(now_ps, step.interrupts);
}

void BridgeControl::advance(std::uint64_t now_ps, DmaChannel& channel) {
  settle(now_ps);
  if (channel.waits_for_local_bus() && busy_) plan();
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

std::size_t BridgeControl::free_places(std::uint64_t now_ps) const {
  const std::size_t sent = has_ended(now_ps) ? posted_.words_being_sent() : 0;
  return posted_.places() - (posted_.words() - sent);
}

void BridgeControl::start_on_local_bus(std::uint64_t now_ps, BridgeTransfer& transfer) {
  settle(now_ps);
  transfer.under_way = true;
  transfer.failed = false;
  if (local_observer_ != nullptr) local_observer_->transfer_waits(now_ps, source_of(&transfer));
  if (busy_) {
    plan();
  } else {
    next_ps_ = now_ps;  // other transfers may start at this time, before the bus chooses
  }
}

void BridgeControl::step(std::uint64_t now_ps) {
  next_ps_ = kNever;
  if (busy_) {
    settle(now_ps);
  } else {
    serve(now_ps);
  }
}

// Begins the next burst. Returns false if nothing waits. A transfer that starts later at the current time is
// not considered.
bool BridgeControl::serve(std::uint64_t now_ps) {
  if (posted_.waits()) {
    const PostedWrites::Burst burst = posted_.send(static_cast<std::size_t>(config_.dma_burst_words));
    begin(now_ps, nullptr, {true, burst.address, data_of(burst.words), burst.count});
    return true;
  }
  if (serve(now_ps, read_)) return true;
  for (std::size_t tried = 0; tried < channels_.size(); ++tried) {
    const std::size_t channel = (turn_ + tried) % channels_.size();
    if (!serve(now_ps, channels_[channel].on_local_bus())) continue;
    turn_ = (channel + 1) % channels_.size();
    return true;
  }
  return false;
}

bool BridgeControl::serve(std::uint64_t now_ps, BridgeTransfer& transfer) {
  if (!transfer.under_way) return false;
  begin(now_ps, &transfer,
        {transfer.write, transfer.address, data_of(transfer.words.data()), transfer.words.size()});
  return true;
}

void BridgeControl::begin(std::uint64_t now_ps, BridgeTransfer* transfer, const LocalBurst& burst) {
  busy_ = true;
  running_ = transfer;
  ok_ = true;
  end_ps_ = kNever;
  next_ps_ = kNever;
  if (local_observer_ != nullptr) local_observer_->burst_begins(now_ps, source_of(running_), burst.words);
  if (!local_bus_.begin_burst(now_ps, burst)) end_burst_at(now_ps, false);
}

LocalBusSource BridgeControl::source_of(const BridgeTransfer* transfer) const {
  if (transfer == nullptr) return LocalBusSource::kPosted;
  if (transfer == &read_) return LocalBusSource::kRead;
  return transfer->channel->number() == 0 ? LocalBusSource::kDma0 : LocalBusSource::kDma1;
}

void BridgeControl::end_burst_at(std::uint64_t end_ps, bool ok) {
  end_ps_ = end_ps;
  ok_ = ok;
  if (local_observer_ != nullptr && running_ == nullptr)
    local_observer_->posted_words_leave(end_ps_, posted_.words_being_sent());
  plan();
}

bool BridgeControl::end_is_awaited() const {
  if (!ok_ || posted_.waits() || read_.under_way) return true;
  return std::any_of(channels_.begin(), channels_.end(), [this](const DmaChannel& channel) {
    const BridgeTransfer& transfer = channel.on_local_bus();
    return &transfer == running_ ? channel.waits_for_local_bus() : transfer.under_way;
  });
}

void BridgeControl::end_local(std::uint64_t now_ps) {
  BridgeTransfer* const transfer = running_;
  busy_ = false;
  running_ = nullptr;
  next_ps_ = kNever;
  if (transfer == nullptr) {
    posted_.sent();
    if (!ok_) raise(now_ps, bridge::kPostedError);
  } else {
    transfer->under_way = false;
    transfer->failed = !ok_;
  }
  if (!serve(now_ps)) turn_ = (turn_ + 1) % channels_.size();
  if (transfer == &read_) {
    if (read_.failed) {
      count_error();
    } else {
      stats_.slave_reads += read_.words.size();
      std::memcpy(read_data_, read_.words.data(), 4 * read_.words.size());
    }
    host_.slave_read_ended(now_ps, !read_.failed);
  } else if (transfer != nullptr) {
    advance(now_ps, *transfer->channel);
  }
}

}  // namespace stereotlm::pci
