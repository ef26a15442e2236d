#include "models/pci/local_bus_master.h"

#include <algorithm>
#include <cstring>

#include "models/kernel_time.h"

namespace stereotlm::pci {

LocalBusMaster::LocalBusMaster(const sc_core::sc_module_name& name, const PciBridgeConfig& config,
                               DmaChannels& channels, Listener& listener)
    : sc_module(name),
      burst_words_(static_cast<std::size_t>(config.dma_burst_words)),
      places_(static_cast<std::size_t>(config.posted_words)),
      channels_(channels),
      listener_(listener),
      posted_(places_) {
  SC_HAS_PROCESS(LocalBusMaster);
  bus.register_nb_transport_bw(this, &LocalBusMaster::respond);
  SC_METHOD(work);
  sensitive << work_;
  dont_initialize();
}

std::size_t LocalBusMaster::free_places() const {
  const std::size_t sent = has_ended() ? posted_.words_being_sent() : 0;
  return places_ - (posted_.words() - sent);
}

void LocalBusMaster::post(std::uint64_t address, const void* words, std::size_t count) {
  posted_.push(address, words, count);
}

void LocalBusMaster::send_posted(const sc_core::sc_time& delay) {
  if (busy_ || delay != sc_core::SC_ZERO_TIME) {
    wake(delay);
  } else {
    serve();  // posted writes are served first
  }
}

bool LocalBusMaster::read(std::uint64_t address, void* words, std::size_t count) {
  read_.address = address;
  read_.words.resize(count);
  start(read_);
  while (read_.under_way) wait(read_ended_);
  if (read_.failed) return false;
  std::memcpy(words, read_.words.data(), 4 * count);
  return true;
}

void LocalBusMaster::start(BridgeTransfer& transfer) {
  settle();
  transfer.under_way = true;
  transfer.failed = false;
  wake();
}

// Schedules work() for the time at which the bus is free, if that time is known.
void LocalBusMaster::wake(const sc_core::sc_time& delay) {
  if (!busy_) {
    work_.notify(delay);
  } else if (end_ps_ != kUnknown) {
    work_.notify(kernel_time::to_time(end_ps_ - kernel_time::now_ps()));
  }
}

void LocalBusMaster::work() {
  if (!busy_) {
    serve();
  } else if (has_ended()) {
    settle();
  } else {
    wake();  // this call was scheduled before the end was known
  }
}

// Begins the next burst. Returns false if nothing waits. A transfer that starts later at the current time is
// not considered.
bool LocalBusMaster::serve() {
  if (posted_.waits()) {
    const PostedWrites::Burst burst = posted_.send(burst_words_);
    begin(nullptr, true, burst.address, burst.words, burst.count);
    return true;
  }
  if (serve(read_)) return true;
  for (std::size_t tried = 0; tried < channels_.size(); ++tried) {
    const std::size_t channel = (turn_ + tried) % channels_.size();
    if (!serve(channels_[channel].on_local_bus())) continue;
    turn_ = (channel + 1) % channels_.size();
    return true;
  }
  return false;
}

bool LocalBusMaster::serve(BridgeTransfer& transfer) {
  if (!transfer.under_way) return false;
  begin(&transfer, transfer.write, transfer.address, transfer.words.data(), transfer.words.size());
  return true;
}

void LocalBusMaster::begin(BridgeTransfer* transfer, bool write, std::uint64_t address, std::uint32_t* words,
                           std::size_t count) {
  busy_ = true;
  running_ = transfer;
  end_ps_ = kUnknown;
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
  if (bus->nb_transport_fw(burst_, phase, delay) == tlm::TLM_COMPLETED) end_after(delay);
}

tlm::tlm_sync_enum LocalBusMaster::respond(tlm::tlm_generic_payload& /*burst*/, tlm::tlm_phase& phase,
                                           sc_core::sc_time& delay) {
  if (phase != tlm::BEGIN_RESP) return tlm::TLM_ACCEPTED;
  end_after(delay);
  return tlm::TLM_COMPLETED;
}

void LocalBusMaster::end_after(const sc_core::sc_time& delay) {
  end_ps_ = kernel_time::now_ps() + kernel_time::to_ps(delay);
  if (end_is_awaited()) work_.notify(delay);
}

bool LocalBusMaster::end_is_awaited() const {
  if (!burst_.is_response_ok() || posted_.waits() || read_.under_way) return true;
  return std::any_of(channels_.begin(), channels_.end(), [this](const DmaChannel& channel) {
    const BridgeTransfer& transfer = channel.on_local_bus();
    return runs(transfer) ? channel.waits_for_local_bus() : transfer.under_way;
  });
}

bool LocalBusMaster::has_ended() const { return busy_ && end_ps_ <= kernel_time::now_ps(); }

void LocalBusMaster::settle() {
  if (!has_ended()) return;
  const bool ok = burst_.is_response_ok();
  BridgeTransfer* const transfer = running_;
  burst_.release();
  busy_ = false;
  running_ = nullptr;
  if (transfer == nullptr) {
    posted_.sent();
    if (!ok) listener_.posted_write_refused();
  } else {
    transfer->under_way = false;
    transfer->failed = !ok;
  }
  if (!serve()) turn_ = (turn_ + 1) % channels_.size();
  if (transfer == &read_) {
    read_ended_.notify(sc_core::SC_ZERO_TIME);
  } else if (transfer != nullptr) {
    listener_.local_transfer_ended(*transfer->channel);
  }
}

}  // namespace stereotlm::pci
