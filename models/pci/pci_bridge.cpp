#include "models/pci/pci_bridge.h"

#include <algorithm>

#include "models/checked.h"

namespace stereotlm::pci {

PciBridge::PciBridge(const sc_core::sc_module_name& name, const PciBridgeConfig& config)
    : sc_module(name),
      config_(checked(this->name(), config)),
      channels_{{{0, static_cast<std::size_t>(config.dma_burst_words)},
                 {1, static_cast<std::size_t>(config.dma_burst_words)}}},
      local_bus_("local_bus", config_, channels_, *this),
      words_taken_(config.buffers) {
  SC_HAS_PROCESS(PciBridge);
  slave.register_b_transport(this, &PciBridge::access_slave);
  registers.register_b_transport(this, &PciBridge::access_registers);
  stop.bind(*this);
  local_bus_.bus.bind(local);
  interrupt.bind(register_file_);
  SC_METHOD(ring);
  sensitive << doorbell.pos();
  dont_initialize();
}

std::size_t PciBridge::writable_words(std::uint64_t /*address*/, std::size_t words) const {
  return std::min(words, local_bus_.free_places());
}

tlm::tlm_response_status PciBridge::check_slave(const tlm::tlm_generic_payload& access) const {
  const std::uint64_t bytes = access.get_data_length();
  if (access.get_command() == tlm::TLM_IGNORE_COMMAND) return tlm::TLM_COMMAND_ERROR_RESPONSE;
  if (access.get_byte_enable_ptr() != nullptr) return tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE;
  if (bytes == 0 || bytes % 4 != 0 || access.get_streaming_width() < bytes)
    return tlm::TLM_BURST_ERROR_RESPONSE;
  if (access.get_address() % 4 != 0 || access.get_address() + bytes > bridge::kSlaveWindowBytes)
    return tlm::TLM_ADDRESS_ERROR_RESPONSE;
  if (access.is_write() && bytes / 4 > local_bus_.free_places()) return tlm::TLM_BURST_ERROR_RESPONSE;
  return tlm::TLM_OK_RESPONSE;
}

void PciBridge::access_slave(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) {
  const std::uint64_t offset = access.get_address();
  const std::uint64_t bytes = access.get_data_length();
  tlm::tlm_response_status status = check_slave(access);
  if (status == tlm::TLM_OK_RESPONSE && access.is_write()) {
    post(offset, access.get_data_ptr(), bytes, delay);
  } else if (status == tlm::TLM_OK_RESPONSE) {
    if (delay != sc_core::SC_ZERO_TIME) wait(delay);
    delay = sc_core::SC_ZERO_TIME;
    if (local_bus_.read(local_address_of(offset), access.get_data_ptr(), bytes / 4)) {
      stats_.slave_reads += bytes / 4;
    } else {
      status = tlm::TLM_GENERIC_ERROR_RESPONSE;
    }
  }
  if (status != tlm::TLM_OK_RESPONSE) ++stats_.errors;
  access.set_response_status(status);
}

std::uint64_t PciBridge::local_address_of(std::uint64_t offset) const {
  if (offset >= bridge::kCoreRegisters) return config_.core_registers + (offset - bridge::kCoreRegisters);
  const std::uint32_t page = register_file_.page(static_cast<std::size_t>(offset / bridge::kApertureBytes));
  return bridge::local_address(page) + offset % bridge::kApertureBytes;
}

// A burst may cross from one aperture into the next, which has a page of its own.
void PciBridge::post(std::uint64_t offset, const unsigned char* data, std::uint64_t bytes,
                     const sc_core::sc_time& delay) {
  local_bus_.settle();
  for (const std::uint64_t end = offset + bytes; offset < end;) {
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
  stats_.posted_words += bytes / 4;
  stats_.most_posted_words = std::max<std::uint64_t>(stats_.most_posted_words, local_bus_.posted().words());
  local_bus_.send_posted(delay);
}

// Words for the core's registers are not counted.
void PciBridge::count_for_banks(WordsByRange& counts, std::uint64_t address, std::size_t words) const {
  if (address >= config_.core_registers) return;
  counts.add(address, std::min<std::uint64_t>(words, (config_.core_registers - address) / 4));
}

WordsByRange PciBridge::words_held() const {
  WordsByRange held(config_.buffers);
  for (const PostedWrites::Run& run : local_bus_.posted().waiting())
    count_for_banks(held, run.address, run.words);
  for (const DmaChannel& channel : channels_) {
    const BridgeTransfer& to = channel.on_local_bus();
    if (to.under_way && to.write && !local_bus_.runs(to)) held.add(to.address, to.words.size());
  }
  return held;
}

void PciBridge::access_registers(tlm::tlm_generic_payload& access, sc_core::sc_time& /*delay*/) {
  if (DmaChannel* const started = register_file_.access(access)) run(started->start());
  if (!access.is_response_ok()) ++stats_.errors;
}

void PciBridge::raise(std::uint32_t interrupts) {
  constexpr std::uint32_t kNoErrors = bridge::kDoorbell | bridge::kDmaDone | bridge::kDmaDone << 1U;
  if ((interrupts & ~kNoErrors) != 0) ++stats_.errors;
  register_file_.raise(interrupts);
}

void PciBridge::run(const DmaChannel::Step& step) {
  for (BridgeTransfer* const transfer : step.starts) {
    if (transfer == nullptr) continue;
    const bool on_pci = transfer == &transfer->channel->on_pci();
    if (transfer->write) {
      stats_.dma_words += transfer->words.size();
      if (!on_pci) words_taken_.add(transfer->address, transfer->words.size());
    }
    on_pci ? start_on_pci(*transfer) : local_bus_.start(*transfer);
  }
  if (step.interrupts != 0) raise(step.interrupts);
}

void PciBridge::advance(DmaChannel& channel) {
  local_bus_.settle();
  if (channel.waits_for_local_bus()) local_bus_.await_end_of(channel.on_local_bus());
  run(channel.next_step());
}

// A transfer that was cut continues with its next word.

void PciBridge::start_on_pci(BridgeTransfer& transfer) {
  transfer.under_way = true;
  transfer.failed = false;
  pci_queue_.push_back(&transfer);
  pci->request(*this);
}

PciBurst PciBridge::begin_burst(std::uint64_t /*address_clock_ps*/) {
  if (pci_queue_.empty()) return {};
  const BridgeTransfer& transfer = *pci_queue_.front();
  pci_words_.assign(transfer.words.begin() + static_cast<std::ptrdiff_t>(pci_done_), transfer.words.end());
  return {transfer.write, transfer.address + pci_done_ * 4, &pci_words_};
}

void PciBridge::end_burst(const BurstResult& result) {
  BridgeTransfer& transfer = *pci_queue_.front();
  if (!transfer.write) {
    std::copy_n(pci_words_.begin(), result.words,
                transfer.words.begin() + static_cast<std::ptrdiff_t>(pci_done_));
  }
  pci_done_ += result.words;
  const bool failed = is_error(result.end);
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

}  // namespace stereotlm::pci
