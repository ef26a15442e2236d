#include "models/pci/pci_bridge.h"

#include <algorithm>
#include <cstring>

#include "models/register_access.h"

namespace stereotlm::pci {
namespace {

std::uint64_t now_ps() { return Clock::to_ps(sc_core::sc_time_stamp()); }

}  // namespace

PciBridge::PciBridge(const sc_core::sc_module_name& name, const PciBridgeConfig& config)
    : sc_module(name),
      config_(config),
      posted_(static_cast<std::size_t>(kPostedWordsRule.required("posted_words", config.posted_words))),
      words_taken_(config.buffers) {
  SC_HAS_PROCESS(PciBridge);
  kDmaBurstRule.required("dma_burst_words", config.dma_burst_words);
  slave.register_b_transport(this, &PciBridge::slave_transport);
  registers.register_b_transport(this, &PciBridge::register_transport);
  stop.bind(*this);
  interrupt.bind(*this);
  local.register_nb_transport_bw(this, &PciBridge::local_response);
  SC_METHOD(work);
  sensitive << work_;
  dont_initialize();
  SC_METHOD(ring);
  sensitive << doorbell.pos();
  dont_initialize();
}

// The slave window.

std::uint64_t PciBridge::local_address_of(std::uint64_t offset) const {
  if (offset >= bridge::kCoreRegisters) return config_.core_registers + (offset - bridge::kCoreRegisters);
  const std::uint32_t page = pages_[static_cast<std::size_t>(offset / bridge::kApertureBytes)];
  return bridge::local_address(page) + offset % bridge::kApertureBytes;
}

std::size_t PciBridge::writable_words(std::uint64_t /*address*/, std::size_t words) const {
  const std::size_t gone = has_ended() ? posted_.words_being_sent() : 0;
  return std::min(words, static_cast<std::size_t>(config_.posted_words) - (posted_.words() - gone));
}

void PciBridge::slave_transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) {
  const std::uint64_t offset = access.get_address();
  const std::uint64_t bytes = access.get_data_length();
  const auto refuse = [&](tlm::tlm_response_status status) {
    ++stats_.errors;
    access.set_response_status(status);
  };
  if (access.get_command() == tlm::TLM_IGNORE_COMMAND) return refuse(tlm::TLM_COMMAND_ERROR_RESPONSE);
  if (access.get_byte_enable_ptr() != nullptr) return refuse(tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE);
  if (bytes == 0 || bytes % 4 != 0 || access.get_streaming_width() < bytes) {
    return refuse(tlm::TLM_BURST_ERROR_RESPONSE);
  }
  if (offset % 4 != 0 || offset + bytes > bridge::kSlaveWindowBytes)
    return refuse(tlm::TLM_ADDRESS_ERROR_RESPONSE);
  if (access.is_write() && bytes / 4 > writable_words(offset, bytes / 4))
    return refuse(tlm::TLM_BURST_ERROR_RESPONSE);
  access.set_response_status(tlm::TLM_OK_RESPONSE);
  if (access.is_write()) {
    post(offset, access.get_data_ptr(), bytes, delay);
    return;
  }
  if (delay != sc_core::SC_ZERO_TIME) wait(delay);
  delay = sc_core::SC_ZERO_TIME;
  read_.address = local_address_of(offset);
  read_.words.resize(bytes / 4);
  start_on_local(read_);
  while (read_.under_way) wait(read_ended_);
  if (read_.failed) return refuse(tlm::TLM_GENERIC_ERROR_RESPONSE);
  stats_.slave_reads += bytes / 4;
  std::memcpy(access.get_data_ptr(), read_.words.data(), bytes);
}

// Each aperture leads to a page of its own.
void PciBridge::post(std::uint64_t offset, const unsigned char* data, std::uint64_t bytes,
                     const sc_core::sc_time& delay) {
  settle();
  for (const std::uint64_t end = offset + bytes; offset < end;) {
    const std::uint64_t border = offset < bridge::kCoreRegisters
                                     ? (offset / bridge::kApertureBytes + 1) * bridge::kApertureBytes
                                     : end;
    const std::uint64_t here = std::min(border, end) - offset;
    const std::uint64_t address = local_address_of(offset);
    posted_.push(address, data, here / 4);
    count_words(words_taken_, address, here / 4);
    offset += here;
    data += here;
  }
  stats_.posted_words += bytes / 4;
  stats_.most_posted_words = std::max<std::uint64_t>(stats_.most_posted_words, posted_.words());
  if (local_is_busy_ || delay != sc_core::SC_ZERO_TIME) {
    wake(delay);
  } else {
    serve();  // nothing goes before them
  }
}

// Those for the banks.
void PciBridge::count_words(WordsByRange& counts, std::uint64_t address, std::size_t words) const {
  if (address >= config_.core_registers) return;
  counts.add(address, std::min<std::uint64_t>(words, (config_.core_registers - address) / 4));
}

// The registers.

bool PciBridge::read_register(std::uint64_t offset, std::uint32_t& value) const {
  using namespace bridge;
  if (offset < kPage + std::uint64_t{4} * kApertures) {
    value = pages_[static_cast<std::size_t>(offset / 4)];
  } else if (offset == kInterruptStatus) {
    value = interrupt_status_;
  } else if (offset == kInterruptEnable) {
    value = interrupt_enable_;
  } else if (offset >= kDmaDescriptor) {
    const Channel& channel = channels_[static_cast<std::size_t>((offset - kDmaDescriptor) / kChannelStride)];
    const std::uint64_t which = kDmaDescriptor + (offset - kDmaDescriptor) % kChannelStride;
    if (which == kDmaDescriptor) {
      value = channel.descriptor;
    } else if (which == kDmaStatus) {
      value = std::uint32_t{channel.busy};
    } else {
      return false;
    }
  } else {
    return false;
  }
  return true;
}

bool PciBridge::write_register(std::uint64_t offset, std::uint32_t value) {
  using namespace bridge;
  if (offset < kPage + std::uint64_t{4} * kApertures) {
    pages_[static_cast<std::size_t>(offset / 4)] = value;
  } else if (offset == kInterruptStatus) {
    interrupt_status_ &= ~value;
    interrupt_changed_.notify(sc_core::SC_ZERO_TIME);
  } else if (offset == kInterruptEnable) {
    interrupt_enable_ = value & kAllInterrupts;
    interrupt_changed_.notify(sc_core::SC_ZERO_TIME);
  } else if (offset >= kDmaDescriptor) {
    const auto number = static_cast<std::size_t>((offset - kDmaDescriptor) / kChannelStride);
    Channel& channel = channels_[number];
    const std::uint64_t which = kDmaDescriptor + (offset - kDmaDescriptor) % kChannelStride;
    if (which == kDmaDescriptor) {
      channel.descriptor = value;
    } else if (which != kDmaControl) {
      return false;
    } else if ((value & 1U) != 0) {
      if (channel.busy) {
        raise(kDmaError << number);
        return true;
      }
      start(channel);
    }
  } else {
    return false;
  }
  return true;
}

void PciBridge::register_transport(tlm::tlm_generic_payload& access, sc_core::sc_time& /*delay*/) {
  const std::uint64_t offset = access.get_address();
  tlm::tlm_response_status status = check_register_access(access, bridge::kRegisterWindowBytes);
  std::uint32_t value = 0;
  if (status == tlm::TLM_OK_RESPONSE && access.is_read()) {
    if (!read_register(offset, value)) status = tlm::TLM_COMMAND_ERROR_RESPONSE;
    std::memcpy(access.get_data_ptr(), &value, 4);
  } else if (status == tlm::TLM_OK_RESPONSE) {
    std::memcpy(&value, access.get_data_ptr(), 4);
    if (!write_register(offset, value)) status = tlm::TLM_COMMAND_ERROR_RESPONSE;
  }
  if (status != tlm::TLM_OK_RESPONSE) ++stats_.errors;
  access.set_response_status(status);
}

void PciBridge::ring() { raise(bridge::kDoorbell); }

void PciBridge::raise(std::uint32_t bits) {
  if ((bits & ~(bridge::kDoorbell | bridge::kDmaDone | bridge::kDmaDone << 1U)) != 0) ++stats_.errors;
  interrupt_status_ |= bits;
  interrupt_changed_.notify(sc_core::SC_ZERO_TIME);
}

// The PCI bus. Transfers wait in a queue; one that is cut goes on with its next word.

void PciBridge::start_on_pci(Transfer& transfer) {
  transfer.under_way = true;
  transfer.failed = false;
  pci_queue_.push_back(&transfer);
  if (pci_queue_.size() == 1) pci_done_ = 0;
  pci->request(*this);
}

PciBurst PciBridge::begin_burst(std::uint64_t /*address_clock_ps*/) {
  if (pci_queue_.empty()) return {};
  on_pci_ = pci_queue_.front();
  pci_words_.assign(on_pci_->words.begin() + static_cast<std::ptrdiff_t>(pci_done_), on_pci_->words.end());
  return {on_pci_->write, on_pci_->address + pci_done_ * 4, &pci_words_};
}

void PciBridge::end_burst(const BurstResult& result) {
  Transfer& transfer = *on_pci_;
  if (!transfer.write) {
    std::copy_n(pci_words_.begin(), result.words,
                transfer.words.begin() + static_cast<std::ptrdiff_t>(pci_done_));
  }
  pci_done_ += result.words;
  const bool failed = result.end == BurstEnd::kMasterAbort || result.end == BurstEnd::kTargetError;
  const bool ended = failed || pci_done_ == transfer.words.size();
  if (ended) {
    pci_queue_.pop_front();
    pci_done_ = 0;
    transfer.failed = failed;
    transfer.under_way = false;
  }
  if (!pci_queue_.empty()) pci->request(*this);
  if (ended) advance(*transfer.channel);
}

// The local bus. Its burst ends lazily: when somebody asks, or work() comes.

void PciBridge::start_on_local(Transfer& transfer) {
  settle();
  transfer.under_way = true;
  transfer.failed = false;
  wake();
}

// Has work() come when the local bus can serve what waits, if that is known.
void PciBridge::wake(const sc_core::sc_time& delay) {
  if (!local_is_busy_) {
    work_.notify(delay);
  } else if (local_end_ps_ != kNever) {
    work_.notify(Clock::to_time(local_end_ps_ - now_ps()));
  }
}

void PciBridge::work() {
  if (!local_is_busy_) {
    serve();
  } else if (has_ended()) {
    settle();
  } else {
    wake();  // it has been woken before the end was known
  }
}

// Whether it has found something. What is asked for later at this time is served later.
bool PciBridge::serve() {
  if (posted_.waits()) {
    const PostedWrites::Burst burst = posted_.send(static_cast<std::size_t>(config_.dma_burst_words));
    begin(nullptr, true, burst.address, burst.words, burst.count);
    return true;
  }
  const auto send = [this](Transfer& transfer) {
    if (transfer.under_way)
      begin(&transfer, transfer.write, transfer.address, transfer.words.data(), transfer.words.size());
    return transfer.under_way;
  };
  if (send(read_)) return true;
  for (std::size_t tried = 0; tried < channels_.size(); ++tried) {
    const std::size_t channel = (next_channel_ + tried) % channels_.size();
    if (!send(channels_[channel].local)) continue;
    next_channel_ = (channel + 1) % channels_.size();
    return true;
  }
  return false;
}

void PciBridge::begin(Transfer* transfer, bool write, std::uint64_t address, std::uint32_t* words,
                      std::size_t count) {
  local_is_busy_ = true;
  on_local_ = transfer;
  local_end_ps_ = kNever;
  const auto bytes = static_cast<unsigned>(count * 4);
  burst_.set_command(write ? tlm::TLM_WRITE_COMMAND : tlm::TLM_READ_COMMAND);
  burst_.set_address(address);
  burst_.set_data_ptr(reinterpret_cast<unsigned char*>(words));
  burst_.set_data_length(bytes);
  burst_.set_streaming_width(bytes);
  burst_.set_byte_enable_ptr(nullptr);
  burst_.set_dmi_allowed(false);
  burst_.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  tlm::tlm_phase phase = tlm::BEGIN_REQ;
  sc_core::sc_time delay;
  burst_.acquire();
  if (local->nb_transport_fw(burst_, phase, delay) == tlm::TLM_COMPLETED) answer_at(delay);
}

tlm::tlm_sync_enum PciBridge::local_response(tlm::tlm_generic_payload& /*access*/, tlm::tlm_phase& phase,
                                             sc_core::sc_time& delay) {
  if (phase != tlm::BEGIN_RESP) return tlm::TLM_ACCEPTED;
  answer_at(delay);
  return tlm::TLM_COMPLETED;
}

void PciBridge::answer_at(const sc_core::sc_time& delay) {
  local_end_ps_ = now_ps() + Clock::to_ps(delay);
  if (end_is_awaited()) work_.notify(delay);
}

bool PciBridge::end_is_awaited() const {
  if (!burst_.is_response_ok() || posted_.waits() || read_.under_way) return true;
  return std::any_of(channels_.begin(), channels_.end(), [this](const Channel& channel) {
    const bool on_local = &channel.local == on_local_;
    return on_local ? !channel.pci.under_way : channel.local.under_way;
  });
}

bool PciBridge::has_ended() const { return local_is_busy_ && local_end_ps_ <= now_ps(); }

// Ends the burst if its time has come, and goes on with what waits.
void PciBridge::settle() {
  if (!has_ended()) return;
  const bool ok = burst_.is_response_ok();
  Transfer* const transfer = on_local_;
  burst_.release();
  local_is_busy_ = false;
  on_local_ = nullptr;
  if (transfer == nullptr) {
    posted_.sent();
    if (!ok) raise(bridge::kPostedError);
  } else {
    transfer->under_way = false;
    transfer->failed = !ok;
  }
  if (!serve()) next_channel_ = (next_channel_ + 1) % channels_.size();
  if (transfer == &read_) {
    read_ended_.notify(sc_core::SC_ZERO_TIME);
  } else if (transfer != nullptr) {
    advance(*transfer->channel);
  }
}

WordsByRange PciBridge::words_held() const {
  WordsByRange held(config_.buffers);
  for (const PostedWrites::Run& run : posted_.waiting()) count_words(held, run.address, run.words);
  for (const Channel& channel : channels_) {
    const Transfer& to = channel.local;
    if (to.under_way && to.write && &to != on_local_) held.add(to.address, to.words.size());
  }
  return held;
}

// The channels.

void PciBridge::start(Channel& channel) {
  channel.busy = true;
  channel.pci.failed = false;
  channel.local.failed = false;
  fetch(channel, channel.descriptor);
}

void PciBridge::finish(Channel& channel, std::uint32_t bits) {
  channel.busy = false;
  raise(bits << static_cast<std::size_t>(&channel - channels_.data()));
}

void PciBridge::fetch(Channel& channel, std::uint32_t descriptor) {
  if (descriptor % 16 != 0) return finish(channel, bridge::kDmaError);
  channel.fetching = true;
  channel.pci.write = false;
  channel.pci.address = descriptor;
  channel.pci.words.resize(4);
  start_on_pci(channel.pci);
}

// What follows when a transfer has ended. A burst is read on one bus while the one before it is written on
// the other, and both have ended before the next.
void PciBridge::advance(Channel& channel) {
  settle();
  if (!channel.busy || channel.pci.under_way) return;
  if (channel.local.under_way) {
    if (&channel.local == on_local_) wake();
  } else if (channel.pci.failed || channel.local.failed) {
    finish(channel, bridge::kDmaError);
  } else if (channel.fetching) {
    channel.fetching = false;
    take_descriptor(channel) ? read_burst(channel) : finish(channel, bridge::kDmaError);
  } else if (channel.moved < channel.piece.words) {
    write_burst(channel);
    if (channel.moved < channel.piece.words) read_burst(channel);
  } else if (channel.piece.next != 0) {
    fetch(channel, channel.piece.next);
  } else {
    finish(channel, bridge::kDmaDone);
  }
}

bool PciBridge::take_descriptor(Channel& channel) {
  const std::vector<std::uint32_t>& descriptor = channel.pci.words;
  Piece& piece = channel.piece;
  piece.pci_address = descriptor[0];
  piece.local_address = bridge::local_address(descriptor[1]);
  piece.to_pci = (descriptor[2] & bridge::kToPci) != 0;
  piece.words = descriptor[2] & ~bridge::kToPci;
  piece.next = descriptor[3];
  channel.moved = 0;
  return piece.words != 0 && piece.pci_address % 4 == 0;
}

void PciBridge::read_burst(Channel& channel) {
  Transfer& from = channel.piece.to_pci ? channel.local : channel.pci;
  from.words.resize(
      std::min(static_cast<std::size_t>(config_.dma_burst_words), channel.piece.words - channel.moved));
  start_burst(channel, from, false);
}

// The words that have been read.
void PciBridge::write_burst(Channel& channel) {
  Transfer& from = channel.piece.to_pci ? channel.local : channel.pci;
  Transfer& to = channel.piece.to_pci ? channel.pci : channel.local;
  to.words.swap(from.words);
  start_burst(channel, to, true);
  if (!channel.piece.to_pci) words_taken_.add(to.address, to.words.size());
  channel.moved += to.words.size();
  stats_.dma_words += to.words.size();
}

void PciBridge::start_burst(Channel& channel, Transfer& transfer, bool write) {
  const bool on_pci = &transfer == &channel.pci;
  transfer.write = write;
  transfer.address = (on_pci ? channel.piece.pci_address : channel.piece.local_address) + channel.moved * 4;
  on_pci ? start_on_pci(transfer) : start_on_local(transfer);
}

}  // namespace stereotlm::pci
