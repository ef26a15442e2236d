#include "models/pci/pci_bridge.h"

#include <algorithm>
#include <cstring>

#include "models/register_access.h"

namespace stereotlm::pci {

PciBridge::PciBridge(const sc_core::sc_module_name& name, const PciBridgeConfig& config)
    : sc_module(name), config_(config), words_taken_(config.buffers) {
  SC_HAS_PROCESS(PciBridge);
  kDmaBurstRule.required("dma_burst_words", config.dma_burst_words);
  kPostedWordsRule.required("posted_words", config.posted_words);
  slave.register_b_transport(this, &PciBridge::slave_transport);
  registers.register_b_transport(this, &PciBridge::register_transport);
  stop.bind(*this);
  local.register_nb_transport_bw(this, &PciBridge::local_response);
  SC_THREAD(run_local);
  for (std::size_t channel = 0; channel < channels_.size(); ++channel) {
    sc_core::sc_spawn([this, channel] { run_channel(channel); }, sc_core::sc_gen_unique_name("channel"));
  }
  SC_METHOD(ring);
  sensitive << doorbell.pos();
  dont_initialize();
  SC_METHOD(drive_interrupt);
  sensitive << interrupt_changed_;
  dont_initialize();
}

// The slave window.

std::uint64_t PciBridge::local_address_of(std::uint64_t offset) const {
  if (offset >= bridge::kCoreRegisters) return config_.core_registers + (offset - bridge::kCoreRegisters);
  const std::uint32_t page = pages_[static_cast<std::size_t>(offset / bridge::kApertureBytes)];
  return bridge::local_address(page) + offset % bridge::kApertureBytes;
}

std::size_t PciBridge::writable_words(std::uint64_t /*address*/, std::size_t words) const {
  return std::min(words, static_cast<std::size_t>(config_.posted_words) - posted_.size());
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
  if (access.is_write()) {
    if (bytes / 4 > writable_words(offset, bytes / 4)) return refuse(tlm::TLM_BURST_ERROR_RESPONSE);
    for (std::uint64_t byte = 0; byte < bytes; byte += 4) {
      PostedWord posted{local_address_of(offset + byte), 0};
      std::memcpy(&posted.word, access.get_data_ptr() + byte, 4);
      if (posted.address < config_.core_registers) words_taken_.add(posted.address, 1);
      posted_.push_back(posted);
    }
    stats_.posted_words += bytes / 4;
    stats_.most_posted_words = std::max<std::uint64_t>(stats_.most_posted_words, posted_.size());
    work_.notify(delay);
    access.set_response_status(tlm::TLM_OK_RESPONSE);
    return;
  }
  if (delay != sc_core::SC_ZERO_TIME) wait(delay);
  delay = sc_core::SC_ZERO_TIME;
  read_.write = false;
  read_.address = local_address_of(offset);
  read_.words.resize(bytes / 4);
  start_on_local(read_);
  if (!finish(read_)) return refuse(tlm::TLM_GENERIC_ERROR_RESPONSE);
  stats_.slave_reads += bytes / 4;
  std::memcpy(access.get_data_ptr(), read_.words.data(), bytes);
  access.set_response_status(tlm::TLM_OK_RESPONSE);
}

// The registers.

bool PciBridge::read_register(std::uint64_t offset, std::uint32_t& value) const {
  using namespace bridge;
  if (offset < kPage + 4 * kApertures) {
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
  if (offset < kPage + 4 * kApertures) {
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
      channel.busy = true;
      channel.start.notify(sc_core::SC_ZERO_TIME);
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

// The line has one driver, whichever process changes the registers.
void PciBridge::drive_interrupt() { interrupt.write((interrupt_status_ & interrupt_enable_) != 0); }

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
  if (failed || pci_done_ == transfer.words.size()) {
    pci_queue_.pop_front();
    pci_done_ = 0;
    transfer.failed = failed;
    transfer.under_way = false;
    transfer.ended.notify(sc_core::SC_ZERO_TIME);
  }
  if (!pci_queue_.empty()) pci->request(*this);
}

// The local bus.

void PciBridge::start_on_local(Transfer& transfer) {
  transfer.under_way = true;
  transfer.failed = false;
  work_.notify(sc_core::SC_ZERO_TIME);
}

void PciBridge::run_local() {
  for (;;) {
    if (!posted_.empty()) {
      send_posted();
    } else if (!serve(read_)) {
      std::size_t tried = 0;
      while (tried < channels_.size() && !serve(channels_[(next_channel_ + tried) % channels_.size()].local))
        ++tried;
      next_channel_ = (next_channel_ + tried + 1) % channels_.size();
      if (tried == channels_.size()) wait(work_);
    }
  }
}

// The words that wait, as far as their addresses follow each other.
void PciBridge::send_posted() {
  std::vector<std::uint32_t>& words = posted_burst_;
  words.clear();
  const std::uint64_t first = posted_.front().address;
  const auto most = std::min(posted_.size(), static_cast<std::size_t>(config_.dma_burst_words));
  while (words.size() < most && posted_[words.size()].address == first + words.size() * 4 &&
         bridge::same_bank(first, posted_[words.size()].address)) {
    words.push_back(posted_[words.size()].word);
  }
  posted_on_local_bus_ = words.size();
  if (move(true, first, words) != tlm::TLM_OK_RESPONSE) raise(bridge::kPostedError);
  posted_.erase(posted_.begin(), posted_.begin() + static_cast<std::ptrdiff_t>(posted_on_local_bus_));
  posted_on_local_bus_ = 0;
}

bool PciBridge::serve(Transfer& transfer) {
  if (!transfer.under_way) return false;
  transfer.on_local_bus = true;
  transfer.failed = move(transfer.write, transfer.address, transfer.words) != tlm::TLM_OK_RESPONSE;
  transfer.on_local_bus = false;
  transfer.under_way = false;
  transfer.ended.notify(sc_core::SC_ZERO_TIME);
  return true;
}

WordsByRange PciBridge::words_held() const {
  WordsByRange held(config_.buffers);
  for (std::size_t i = posted_on_local_bus_; i < posted_.size(); ++i) {
    if (posted_[i].address < config_.core_registers) held.add(posted_[i].address, 1);
  }
  for (const Channel& channel : channels_) {
    const Transfer& to = channel.local;
    if (to.under_way && to.write && !to.on_local_bus) held.add(to.address, to.words.size());
  }
  return held;
}

tlm::tlm_response_status PciBridge::move(bool write, std::uint64_t address,
                                         std::vector<std::uint32_t>& words) {
  const auto bytes = static_cast<unsigned>(words.size() * 4);
  burst_.set_command(write ? tlm::TLM_WRITE_COMMAND : tlm::TLM_READ_COMMAND);
  burst_.set_address(address);
  burst_.set_data_ptr(reinterpret_cast<unsigned char*>(words.data()));
  burst_.set_data_length(bytes);
  burst_.set_streaming_width(bytes);
  burst_.set_byte_enable_ptr(nullptr);
  burst_.set_dmi_allowed(false);
  burst_.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  tlm::tlm_phase phase = tlm::BEGIN_REQ;
  sc_core::sc_time delay;
  burst_.acquire();
  if (local->nb_transport_fw(burst_, phase, delay) == tlm::TLM_COMPLETED) {
    if (delay != sc_core::SC_ZERO_TIME) wait(delay);
  } else {
    wait(responded_);
  }
  burst_.release();
  return burst_.get_response_status();
}

tlm::tlm_sync_enum PciBridge::local_response(tlm::tlm_generic_payload& /*access*/, tlm::tlm_phase& phase,
                                             sc_core::sc_time& delay) {
  if (phase != tlm::BEGIN_RESP) return tlm::TLM_ACCEPTED;
  responded_.notify(delay);
  return tlm::TLM_COMPLETED;
}

// The channels.

void PciBridge::run_channel(std::size_t channel) {
  for (;;) {
    wait(channels_[channel].start);
    const bool done = run_chain(channels_[channel]);
    channels_[channel].busy = false;
    raise((done ? bridge::kDmaDone : bridge::kDmaError) << channel);
  }
}

bool PciBridge::run_chain(Channel& channel) {
  channel.pci.failed = false;
  channel.local.failed = false;
  for (std::uint32_t next = channel.descriptor;;) {
    if (next % 16 != 0) return false;
    channel.pci.write = false;
    channel.pci.address = next;
    channel.pci.words.resize(4);
    start_on_pci(channel.pci);
    if (!finish(channel.pci)) return false;
    std::array<std::uint32_t, 4> descriptor{};
    std::copy_n(channel.pci.words.begin(), descriptor.size(), descriptor.begin());
    const std::uint64_t board = bridge::local_address(descriptor[1]);
    const std::size_t words = descriptor[2] & ~bridge::kToPci;
    if (words == 0 || descriptor[0] % 4 != 0) return false;
    const bool to_pci = (descriptor[2] & bridge::kToPci) != 0;
    if (!move_piece(channel, {to_pci, descriptor[0], board, words})) return false;
    next = descriptor[3];
    if (next == 0) return true;
  }
}

bool PciBridge::finish(Transfer& transfer) {
  while (transfer.under_way) sc_core::wait(transfer.ended);
  return !transfer.failed;
}

// A burst is read on one bus while the one before it is written on the other.
bool PciBridge::move_piece(Channel& channel, const Piece& piece) {
  Transfer& from = piece.to_pci ? channel.local : channel.pci;
  Transfer& to = piece.to_pci ? channel.pci : channel.local;
  const auto start = [&](Transfer& transfer, bool write, std::size_t moved) {
    const bool on_pci = &transfer == &channel.pci;
    transfer.write = write;
    transfer.address = (on_pci ? piece.pci_address : piece.local_address) + moved * 4;
    on_pci ? start_on_pci(transfer) : start_on_local(transfer);
  };
  const auto most = static_cast<std::size_t>(config_.dma_burst_words);
  for (std::size_t moved = 0; moved < piece.words;) {
    const std::size_t burst = std::min(most, piece.words - moved);
    from.words.resize(burst);
    start(from, false, moved);
    const bool read = finish(from);
    const bool written = finish(to);
    if (!read || !written) return false;
    to.words.swap(from.words);
    start(to, true, moved);
    if (!piece.to_pci) words_taken_.add(to.address, burst);
    moved += burst;
    stats_.dma_words += burst;
  }
  return finish(to);
}

}  // namespace stereotlm::pci
