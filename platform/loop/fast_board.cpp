#include "platform/loop/fast_board.h"

#include <fmt/format.h>

#include <cstring>
#include <stdexcept>
#include <utility>

#include "models/fpga/core_ports.h"
#include "models/memory/memory_config.h"
#include "models/time_ps.h"
#include "platform/config/buffer_layout.h"
#include "platform/loop/core_loop.h"

namespace stereotlm::platform {

FastBoard::FastBoard(const BoardConfig& config, fpga::Fidelity fidelity,
                     std::function<void(std::uint64_t)> ring)
    : DirectBanks(config.banks.size()),
      config_(core_config(require_valid(config))),
      bank_configs_(ssram_configs(config)),
      ring_(std::move(ring)),
      clock_(config_.clock_mhz),
      arbitration_(arbiter_of_ports(config.fpga.arbiter, core_ports(config)), bank_configs_),
      frames_(config_, bank_configs_, arbitration_, kStallTimeoutCycles),
      local_bus_({config.bridge.local_clock_mhz, buffer_ranges(config)}, bank_configs_.size(), *this),
      fast_core_(config_, fpga::has_pixels(fidelity), frames_, host_port_, local_bus_, *this, clock_, *this),
      next_ps_(kNever) {
  host_port_.set_only_master(true);
  for (const memory::SsramBankConfig& bank : bank_configs_) banks_.emplace_back(4 * bank.words);
}

void FastBoard::step(std::uint64_t now_ps) {
  now_ps_ = now_ps;
  next_ps_ = fast_core_.advance(now_ps);
}

void FastBoard::catch_up(std::uint64_t now_ps) {
  if (!frames_.is_running()) return;
  frames_.run_ahead(clock_.edge_at_or_after(now_ps));
  host_port_.count_words();
}

bool FastBoard::access_bank(std::uint64_t /*at_ps*/, bool write, std::uint64_t address, std::uint32_t& word) {
  const std::size_t bank = memory::bank_of_address(address);
  count_direct(bank, 1);
  unsigned char* const stored = direct(address, 4);
  if (stored == nullptr) return false;
  if (write) changes(address, 4);
  std::memcpy(write ? static_cast<void*>(stored) : &word, write ? static_cast<void*>(&word) : stored, 4);
  return true;
}

bool FastBoard::access_register(std::uint64_t now_ps, bool write, std::uint64_t address,
                                std::uint32_t& word) {
  if (address >= fpga::registers::kEnd || !fpga::CoreRegisters::allows(write, address)) return false;
  if (write) {
    registers_.write(now_ps, address, word);
  } else {
    word = registers_.read(address);
  }
  return true;
}

void FastBoard::start_frame(const fpga::FrameStart& start) {
  if (!frames_.has_banks(start.bases)) return registers_.refuse_start();
  if (!fast_core_.start_frame(clock_.edge_at_or_after(start.time_ps), start))
    failed("a frame that does not work directly on memory needs fidelity cycle");
  frames_.strobe(start.time_ps);
  next_ps_ = start.time_ps;
}

unsigned char* FastBoard::direct(std::uint64_t address, std::uint64_t bytes) {
  const std::size_t bank = memory::bank_of_address(address);
  const std::uint64_t first = address - memory::crossbar_address(bank, 0);
  return banks_[bank].holds(first, bytes) ? banks_[bank].data() + first : nullptr;
}

void FastBoard::frame_ended(bool failed) {
  const bool was_done = registers_.done();
  registers_.finish_frame(frames_.frame_cycles().back(), failed);
  if (!was_done) ring_(now_ps_);
}

void FastBoard::failed(const std::string& why) { throw std::runtime_error("core: " + why); }

void FastBoard::stalled(std::uint64_t cycles) {
  failed(fmt::format("no slot consumed and no result written for {} cycles; {}", cycles, frames_.waits()));
}

BoardCounters FastBoard::counters(std::uint64_t now_ps) const {
  BoardCounters counters = counters_of(frames_, arbitration_, &host_port_, clock_.edge_at_or_after(now_ps));
  for (std::size_t bank = 0; bank < banks_.size(); ++bank)
    counters.banks[bank].accesses += direct_accesses(bank);
  return counters;
}

}  // namespace stereotlm::platform
