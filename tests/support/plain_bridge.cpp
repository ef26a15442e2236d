#include "tests/support/plain_bridge.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace stereotlm::test {
namespace {

constexpr std::uint64_t of(PlainCoreRegister which) {
  return kPlainCoreRegisters + static_cast<std::uint64_t>(which);
}
constexpr std::uint64_t of(PlainBridgeRegister which) { return static_cast<std::uint64_t>(which); }
constexpr std::uint64_t bank_of(std::uint64_t word) { return word / kPlainBankWords; }

}  // namespace

PlainBridge::PlainBridge(PlainEvents& events, PlainPciBus& bus, PlainBoard& board, PlainTarget& host_memory,
                         const PlainBridgeConfig& config)
    : events_(events),
      bus_(bus),
      board_(board),
      host_memory_(host_memory),
      config_(config),
      clock_(config.local_clock_mhz),
      master_(bus.add(*this)) {}

// The slave window.

std::size_t PlainBridge::Slave::takes(std::size_t words) const {
  return std::min(words, bridge_.config_.posted_words - bridge_.posted_.size() - bridge_.posted_on_local_);
}

void PlainBridge::Slave::write(std::uint64_t word, const PlainWords& words) {
  const auto local_of = [this](std::uint64_t at) {
    if (at >= kPlainCoreWindow) return kPlainCoreRegisters + at - kPlainCoreWindow;
    const auto place = static_cast<int>(at % kPlainApertureWords);
    const int words_of_row = bridge_.config_.words_of_row;
    return plain_board_word(plain_word(bridge_.pages_.at(at / kPlainApertureWords), place / words_of_row,
                                       place % words_of_row, words_of_row));
  };
  const PlainTime now_ps = bridge_.events_.now();
  for (const std::uint32_t value : words) bridge_.posted_.push_back({local_of(word++), value, now_ps});
  bridge_.stats_.posted_words += words.size();
  bridge_.posted_levels_.push_back({now_ps, bridge_.posted_.size() + bridge_.posted_on_local_});
  bridge_.ask();
}

// A read of the core's registers.
void PlainBridge::Slave::read(std::uint64_t word, std::size_t count, PlainTime end_ps,
                              std::function<void(PlainWords)> answer) {
  bridge_.events_.at(end_ps, PlainPhase::kEffects, [this, word, count, answer] {
    bridge_.read_ = LocalBurst{false,
                               kPlainCoreRegisters + word - kPlainCoreWindow,
                               PlainWords(count),
                               answer,
                               1,
                               bridge_.events_.now()};
    bridge_.ask();
  });
}

// The registers.

void PlainBridge::Registers::write(std::uint64_t word, const PlainWords& words) {
  const std::uint32_t value = words.at(0);
  if (word < of(PlainBridgeRegister::kInterruptStatus)) {
    // Part 0 comes first: the others are then those of the arming before.
    PlainParts& pages = bridge_.pages_.at(word / kPlainMostParts);
    pages.resize(word % kPlainMostParts);
    pages.push_back({static_cast<int>(bank_of(value)), value % kPlainBankWords});
  } else if (word == of(PlainBridgeRegister::kInterruptStatus)) {
    bridge_.status_ &= ~value;
  } else if (word == of(PlainBridgeRegister::kInterruptEnable)) {
    bridge_.enable_ = value;
  } else if (word % kPlainChannelWords == of(PlainBridgeRegister::kControl0) % kPlainChannelWords) {
    bridge_.start((word - of(PlainBridgeRegister::kControl0)) / kPlainChannelWords);
  }
}

void PlainBridge::Registers::read(std::uint64_t word, std::size_t count, PlainTime /*end_ps*/,
                                  std::function<void(PlainWords)> answer) {
  if (word != of(PlainBridgeRegister::kInterruptStatus) || count != 1)
    throw std::logic_error("plain bridge: only the interrupt status is read");
  answer({bridge_.status_});
}

// The local bus.

void PlainBridge::ask() {
  events_.at(events_.now(), PlainPhase::kLocalBusBegins, [this] {
    if (!local_) serve();
  });
}

// Begins a burst: posted writes before reads before the channels in turn. False if nothing is pending.
bool PlainBridge::serve() {
  if (!posted_.empty()) {
    LocalBurst burst{true, posted_.front().word, {}, [](const PlainWords&) {}, 0, posted_.front().posted_ps};
    const auto follows = [&burst](std::uint64_t word) {
      return word == burst.word + burst.words.size() && bank_of(word) == bank_of(burst.word);
    };
    while (!posted_.empty() && burst.words.size() < config_.dma_burst_words &&
           follows(posted_.front().word)) {
      burst.words.push_back(posted_.front().value);
      posted_.pop_front();
    }
    posted_on_local_ = burst.words.size();
    begin(std::move(burst));
    return true;
  }
  if (read_) {
    begin(*std::exchange(read_, std::nullopt));
    return true;
  }
  for (std::size_t turn = 0; turn < channels_.size(); ++turn) {
    const std::size_t channel = (next_channel_ + turn) % channels_.size();
    if (!channels_[channel].asks) continue;
    next_channel_ = (channel + 1) % channels_.size();
    begin(*std::exchange(channels_[channel].asks, std::nullopt));
    return true;
  }
  return false;
}

void PlainBridge::begin(LocalBurst burst) {
  local_ = std::move(burst);
  word_ = 0;
  idle_clock_.reset();
  address_clock_ = clock_.first_edge(events_.now());
  await_word(clock_.edge(address_clock_ + 3));  // address, decode, data
}

// The data clock of the next word ends at `end_ps`.
void PlainBridge::await_word(PlainTime end_ps) {
  const std::uint64_t word = local_->word + word_;
  if (word < kPlainCoreRegisters) {
    // Only the capture boards post words to the banks, and only the channels write others.
    const PlainTraffic traffic = !local_->write          ? PlainTraffic::kReadBack
                                 : posted_on_local_ != 0 ? PlainTraffic::kCapture
                                                         : PlainTraffic::kUpload;
    board_.host_asks({static_cast<int>(bank_of(word)), word % kPlainBankWords}, local_->write, traffic,
                     local_->words[word_], end_ps,
                     [this](PlainTime begin_ps, PlainTime usable_ps) { word_ends(begin_ps, usable_ps); });
    return;
  }
  events_.at(end_ps, PlainPhase::kEffects, [this, word] {
    const bool starts = word == of(PlainCoreRegister::kControl) && (local_->words[word_] & kPlainStart) != 0;
    if (local_->write && starts) board_.start_frame();
    if (local_->write && word >= of(PlainCoreRegister::kMiddle))
      board_.write_middle(static_cast<PlainMiddle>(word - of(PlainCoreRegister::kMiddle)),
                          local_->words[word_]);
    word_ends(events_.now(), events_.now());
  });
}

void PlainBridge::word_ends(PlainTime begin_ps, PlainTime usable_ps) {
  ++word_;
  if (word_ < local_->words.size()) {
    await_word(clock_.edge(clock_.first_edge(begin_ps) + 1));
    return;
  }
  idle_clock_ = clock_.first_edge(local_->write ? begin_ps : usable_ps);
  events_.at(clock_.edge(*idle_clock_ + 1), PlainPhase::kLocalBusEnds, [this] { end(); });
}

void PlainBridge::end() {
  stats_.local_busy_clocks += *idle_clock_ - address_clock_;
  local_bursts_.push_back({local_->source, local_->write, local_->word, local_->words.size(),
                           clock_.edge(clock_.first_edge(local_->asked_ps)), clock_.edge(address_clock_),
                           clock_.edge(address_clock_ + 1), clock_.edge(*idle_clock_)});
  if (posted_on_local_ != 0) posted_levels_.push_back({events_.now(), posted_.size()});
  posted_on_local_ = 0;
  const LocalBurst burst = *std::exchange(local_, std::nullopt);
  if (!serve()) next_channel_ = (next_channel_ + 1) % channels_.size();
  burst.ended(burst.words);
}

PlainBridge::Stats PlainBridge::stats() const {
  Stats stats = stats_;
  stats.local_clocks = clock_.clocks_by(events_.now());
  if (local_) {
    const std::uint64_t end = std::min(idle_clock_.value_or(stats.local_clocks), stats.local_clocks);
    stats.local_busy_clocks += end > address_clock_ ? end - address_clock_ : 0;
  }
  return stats;
}

// The channels.

void PlainBridge::start(std::size_t channel) {
  channels_[channel].busy = true;
  channels_[channel].descriptor = 0;
  fetch(channel);
}

void PlainBridge::fetch(std::size_t channel) {
  channels_[channel].fetching = true;
  start_on_pci(channel, false, 0, PlainWords(4));
}

// Continues once the transfers of the channel on both buses have ended.
void PlainBridge::proceed(std::size_t number) {
  Channel& channel = channels_[number];
  if (channel.on_pci || channel.on_local) return;
  const std::uint64_t words = channel.chain[channel.descriptor].words;
  if (channel.fetching) {
    channel.fetching = false;
    channel.moved = 0;
    read_burst(number);
  } else if (channel.moved < words) {
    write_burst(number);
    if (channel.moved < words) read_burst(number);
  } else if (channel.descriptor + 1 < channel.chain.size()) {
    ++channel.descriptor;
    fetch(number);
  } else {
    channel.busy = false;
    status_ |= kPlainDmaDone << number;
  }
}

void PlainBridge::read_burst(std::size_t number) {
  const Channel& channel = channels_[number];
  const PlainDescriptor& descriptor = channel.chain[channel.descriptor];
  PlainWords words(std::min<std::uint64_t>(config_.dma_burst_words, descriptor.words - channel.moved));
  if (descriptor.to_host) {
    start_on_local(number, false, descriptor.board + channel.moved, std::move(words));
  } else {
    start_on_pci(number, false, descriptor.host + channel.moved, std::move(words));
  }
}

void PlainBridge::write_burst(std::size_t number) {
  Channel& channel = channels_[number];
  const PlainDescriptor& descriptor = channel.chain[channel.descriptor];
  const std::uint64_t moved = channel.moved;
  PlainWords words = std::move(channel.words);
  channel.moved += words.size();
  stats_.dma_words += words.size();
  if (descriptor.to_host) {
    start_on_pci(number, true, descriptor.host + moved, std::move(words));
  } else {
    start_on_local(number, true, descriptor.board + moved, std::move(words));
  }
}

void PlainBridge::start_on_local(std::size_t number, bool write, std::uint64_t word, PlainWords words) {
  channels_[number].on_local = true;
  channels_[number].asks = LocalBurst{write,
                                      word,
                                      std::move(words),
                                      [this, number, write](const PlainWords& moved) {
                                        channels_[number].on_local = false;
                                        if (!write) channels_[number].words = moved;
                                        proceed(number);
                                      },
                                      2 + number,
                                      events_.now()};
  ask();
}

// First come, first served.
void PlainBridge::start_on_pci(std::size_t number, bool write, std::uint64_t word, PlainWords words) {
  channels_[number].on_pci = true;
  transfers_.push_back({number, write, word, std::move(words), 0});
  bus_.request(master_);
}

PlainBurst PlainBridge::burst() {
  const PciTransfer& transfer = transfers_.front();
  return {
      transfer.write, &host_memory_, config_.memory_wait_clocks, transfer.word + transfer.done,
      PlainWords(transfer.words.begin() + static_cast<std::ptrdiff_t>(transfer.done), transfer.words.end())};
}

void PlainBridge::ended(const PlainWords& words) {
  PciTransfer& transfer = transfers_.front();
  if (!transfer.write)
    std::copy(words.begin(), words.end(),
              transfer.words.begin() + static_cast<std::ptrdiff_t>(transfer.done));
  transfer.done += words.size();
  if (transfer.done < transfer.words.size()) {
    bus_.request(master_);
    return;
  }
  const PciTransfer whole = std::move(transfer);
  transfers_.pop_front();
  if (!transfers_.empty()) bus_.request(master_);
  Channel& channel = channels_[whole.channel];
  channel.on_pci = false;
  if (!whole.write) channel.words = whole.words;
  proceed(whole.channel);
}

}  // namespace stereotlm::test
