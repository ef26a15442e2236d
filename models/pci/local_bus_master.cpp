#include "models/pci/local_bus_master.h"

#include <algorithm>

namespace stereotlm::pci {
namespace {

unsigned char* data_of(std::uint32_t* words) { return reinterpret_cast<unsigned char*>(words); }

}  // namespace

LocalBusMaster::LocalBusMaster(const PciBridgeConfig& config, DmaChannels& channels, LocalBusIf& bus,
                               Listener& listener)
    : burst_words_(static_cast<std::size_t>(config.dma_burst_words)),
      channels_(channels),
      bus_(bus),
      listener_(listener),
      posted_(static_cast<std::size_t>(config.posted_words)) {}

std::size_t LocalBusMaster::free_places(std::uint64_t now_ps) const {
  const std::size_t sent = has_ended(now_ps) ? posted_.words_being_sent() : 0;
  return posted_.places() - (posted_.words() - sent);
}

void LocalBusMaster::send_posted(std::uint64_t now_ps, std::size_t words) {
  if (observer_ != nullptr) observer_->words_posted(now_ps, words);
  if (busy_) {
    plan();
  } else {
    serve(now_ps);  // posted writes are served first
  }
}

void LocalBusMaster::read(std::uint64_t now_ps, std::uint64_t address, std::size_t count) {
  read_.address = address;
  read_.words.resize(count);
  start(now_ps, read_);
}

void LocalBusMaster::start(std::uint64_t now_ps, BridgeTransfer& transfer) {
  settle(now_ps);
  transfer.under_way = true;
  transfer.failed = false;
  if (observer_ != nullptr) report_start(now_ps, transfer);
  if (busy_) {
    plan();
  } else {
    next_ps_ = now_ps;  // other transfers may start at this time, before the bus chooses
  }
}

void LocalBusMaster::step(std::uint64_t now_ps) {
  next_ps_ = kNever;
  if (busy_) {
    settle(now_ps);
  } else {
    serve(now_ps);
  }
}

// Begins the next burst. Returns false if nothing waits. A transfer that starts later at the current time is
// not considered.
bool LocalBusMaster::serve(std::uint64_t now_ps) {
  if (posted_.waits()) {
    const PostedWrites::Burst burst = posted_.send(burst_words_);
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

bool LocalBusMaster::serve(std::uint64_t now_ps, BridgeTransfer& transfer) {
  if (!transfer.under_way) return false;
  begin(now_ps, &transfer,
        {transfer.write, transfer.address, data_of(transfer.words.data()), transfer.words.size()});
  return true;
}

void LocalBusMaster::begin(std::uint64_t now_ps, BridgeTransfer* transfer, const LocalBurst& burst) {
  busy_ = true;
  running_ = transfer;
  ok_ = true;
  end_ps_ = kNever;
  next_ps_ = kNever;
  if (observer_ != nullptr) report_begin(now_ps, burst.words);
  if (!bus_.begin_burst(now_ps, burst)) end_burst_at(now_ps, false);
}

void LocalBusMaster::report_start(std::uint64_t now_ps, const BridgeTransfer& transfer) const {
  observer_->transfer_waits(now_ps, source_of(transfer));
}

void LocalBusMaster::report_begin(std::uint64_t now_ps, std::size_t words) const {
  observer_->burst_begins(now_ps, running_ == nullptr ? LocalBusSource::kPosted : source_of(*running_),
                          words);
}

void LocalBusMaster::report_end() const {
  if (running_ == nullptr) observer_->posted_words_leave(end_ps_, posted_.words_being_sent());
}

LocalBusSource LocalBusMaster::source_of(const BridgeTransfer& transfer) const {
  if (&transfer == &read_) return LocalBusSource::kRead;
  return transfer.channel->number() == 0 ? LocalBusSource::kDma0 : LocalBusSource::kDma1;
}

void LocalBusMaster::end_burst_at(std::uint64_t end_ps, bool ok) {
  end_ps_ = end_ps;
  ok_ = ok;
  if (observer_ != nullptr) report_end();
  plan();
}

// Names the time of the next step while a burst runs.
void LocalBusMaster::plan() { next_ps_ = end_is_awaited() ? end_ps_ : kNever; }

bool LocalBusMaster::end_is_awaited() const {
  if (!ok_ || posted_.waits() || read_.under_way) return true;
  return std::any_of(channels_.begin(), channels_.end(), [this](const DmaChannel& channel) {
    const BridgeTransfer& transfer = channel.on_local_bus();
    return runs(transfer) ? channel.waits_for_local_bus() : transfer.under_way;
  });
}

void LocalBusMaster::end(std::uint64_t now_ps) {
  BridgeTransfer* const transfer = running_;
  busy_ = false;
  running_ = nullptr;
  next_ps_ = kNever;
  if (transfer == nullptr) {
    posted_.sent();
    if (!ok_) listener_.posted_write_refused(now_ps);
  } else {
    transfer->under_way = false;
    transfer->failed = !ok_;
  }
  if (!serve(now_ps)) turn_ = (turn_ + 1) % channels_.size();
  if (transfer == &read_) {
    listener_.slave_read_ended(now_ps, read_);
  } else if (transfer != nullptr) {
    listener_.local_transfer_ended(now_ps, *transfer->channel);
  }
}

}  // namespace stereotlm::pci
