#include "models/memory/crossbar.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace stereotlm::memory {
namespace {

constexpr std::size_t lowest(PortMask mask) { return static_cast<std::size_t>(__builtin_ctz(mask)); }
constexpr std::uint64_t kOffsetMask = (std::uint64_t{1} << kBankAddressBits) - 1;
constexpr std::uint64_t bank_base(std::uint64_t address) { return address & ~kOffsetMask; }

}  // namespace

Crossbar::Crossbar(const sc_core::sc_module_name& name, const CrossbarConfig& config)
    : sc_module(name), ports("port", kPortCount), banks("bank", config.banks.size()) {
  auto found = problems(config.arbiter);
  kBankCountRule.check("banks", static_cast<std::int64_t>(config.banks.size()), found);
  for (const SsramBankConfig& bank : config.banks) {
    for (const std::string& problem : problems(bank)) found.push_back(problem);
    if (bank.clock_mhz != config.banks.front().clock_mhz) {
      found.push_back("clock_mhz = " + std::to_string(bank.clock_mhz) + ": must be the same for all banks");
    }
  }
  if (!found.empty()) throw std::invalid_argument(std::string(this->name()) + ": " + found.front());
  for (std::size_t port = 0; port < kPortCount; ++port) {
    targets_.emplace_back(*this, static_cast<Port>(port));
    ports[port].bind(targets_.back());
  }
  for (std::size_t bank = 0; bank < config.banks.size(); ++bank) {
    arbiters_.emplace_back(config.arbiter, config.banks[bank].turnaround_cycles);
    banks[bank].register_invalidate_direct_mem_ptr(this, &Crossbar::invalidate_dmi, static_cast<int>(bank));
  }
}

void Crossbar::route(Port port, std::size_t bank, bool write) {
  settle();
  targets_[index_of(port)].route(bank, write, *banks[bank].operator->());
  routed_ = static_cast<PortMask>(routed_ | mask_of(port));
  share_banks();
}

void Crossbar::unroute(Port port) {
  settle();
  routed_ = static_cast<PortMask>(routed_ & ~mask_of(port));
  share_banks();
}

// Which ports meet in which banks.
void Crossbar::share_banks() {
  writes_ = 0;
  alone_ = 0;
  shared_bank_count_ = 0;
  std::array<PortMask, kPortCount> together{};  // [port]: the ports on its bank
  for (std::size_t i = 0; i < kPortCount; ++i) {
    if ((routed_ >> i & 1U) == 0) continue;
    writes_ = static_cast<PortMask>(writes_ | unsigned{targets_[i].writes()} << i);
    for (std::size_t other = 0; other < kPortCount; ++other) {
      const bool meet = (routed_ >> other & 1U) != 0 && targets_[other].bank() == targets_[i].bank();
      together[i] = static_cast<PortMask>(together[i] | unsigned{meet} << other);
    }
  }
  for (std::size_t i = 0; i < kPortCount; ++i) {
    const auto port_mask = static_cast<PortMask>(1U << i);
    BankArbiter& arbiter = arbiters_[targets_[i].bank()];
    if (together[i] == 0 || lowest(together[i]) != i) continue;
    if (together[i] == port_mask && !arbiter.needs_turnaround()) {
      alone_ = static_cast<PortMask>(alone_ | port_mask);
    } else {
      shared_banks_[shared_bank_count_++] = {&arbiter, together[i]};
    }
  }
}

// Tells the arbiters what was granted without them.
void Crossbar::settle() const {
  std::array<std::uint64_t, kPortCount> cycles{};
  for (std::size_t ports_alone = 1; ports_alone < alone_cycles_.size(); ++ports_alone) {
    if (alone_cycles_[ports_alone] == 0) continue;
    for (std::size_t port = 0; port < kPortCount; ++port)
      cycles[port] += (ports_alone >> port & 1U) * alone_cycles_[ports_alone];
  }
  alone_cycles_ = {};
  for (std::size_t port = 0; port < kPortCount; ++port) {
    arbiters_[targets_[port].bank()].grant_alone(static_cast<PortMask>(1U << port), targets_[port].writes(),
                                                 cycles[port]);
  }
}

// The rest of arbitrate(): requests of ports that are not alone on their banks.
void Crossbar::arbitrate_shared(std::uint64_t cycle, PortMask requests) {
  PortMask granted = granted_;
  const SharedBank* const end = shared_banks_.data() + shared_bank_count_;
  for (const SharedBank* shared = shared_banks_.data(); shared != end; ++shared) {
    const auto asking = static_cast<PortMask>(requests & shared->ports);
    if (asking != 0) {
      granted = static_cast<PortMask>(granted | shared->arbiter->arbitrate(cycle, asking, writes_));
    }
  }
  granted_ = granted;
}

void Crossbar::begin_counting(std::uint64_t first_cycle) {
  settle();
  for (BankArbiter& arbiter : arbiters_) arbiter.begin_counting(first_cycle);
}

void Crossbar::end_counting(std::uint64_t end_cycle) {
  settle();
  for (BankArbiter& arbiter : arbiters_) arbiter.end_counting(end_cycle);
}

void Crossbar::PortTarget::route(std::size_t bank, bool write, tlm::tlm_blocking_transport_if<>& target) {
  bank_ = bank;
  write_ = write;
  bank_base_ = crossbar_address(bank, 0);
  bank_port_ = &target;
}

void Crossbar::PortTarget::b_transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) {
  const std::uint64_t address = access.get_address();
  if ((crossbar_.granted_ & port_mask_) == 0 || bank_base(address) != bank_base_ ||
      access.is_write() != write_) {
    crossbar_.refuse(access);
    return;
  }
  crossbar_.granted_ = static_cast<PortMask>(crossbar_.granted_ & ~port_mask_);
  access.set_address(address - bank_base_);
  bank_port_->b_transport(access, delay);
  access.set_address(address);
}

void Crossbar::refuse(tlm::tlm_generic_payload& access) const {
  access.set_response_status(has_bank(access.get_address()) ? tlm::TLM_GENERIC_ERROR_RESPONSE
                                                            : tlm::TLM_ADDRESS_ERROR_RESPONSE);
}

unsigned Crossbar::debug(tlm::tlm_generic_payload& access) {
  const std::uint64_t address = access.get_address();
  if (!has_bank(address)) return 0;
  access.set_address(address & kOffsetMask);
  const unsigned length = banks[bank_of_address(address)]->transport_dbg(access);
  access.set_address(address);
  return length;
}

bool Crossbar::grant_dmi(tlm::tlm_generic_payload& access, tlm::tlm_dmi& dmi) {
  const std::uint64_t address = access.get_address();
  if (!has_bank(address)) {
    dmi.allow_read_write();
    dmi.set_start_address(crossbar_address(arbiters_.size(), 0));
    dmi.set_end_address(UINT64_MAX);
    return false;
  }
  access.set_address(address & kOffsetMask);
  const bool granted = banks[bank_of_address(address)]->get_direct_mem_ptr(access, dmi);
  access.set_address(address);
  // Also a refusal names a range; what lies beyond the bank's window belongs to the next bank.
  dmi.set_start_address(bank_base(address) + std::min<std::uint64_t>(dmi.get_start_address(), kOffsetMask));
  dmi.set_end_address(bank_base(address) + std::min<std::uint64_t>(dmi.get_end_address(), kOffsetMask));
  return granted;
}

void Crossbar::invalidate_dmi(int bank, sc_dt::uint64 start, sc_dt::uint64 end) {
  const std::uint64_t base = static_cast<std::uint64_t>(bank) << kBankAddressBits;
  const std::uint64_t first = base + std::min<std::uint64_t>(start, kOffsetMask);
  const std::uint64_t last = base + std::min<std::uint64_t>(end, kOffsetMask);
  for (std::size_t port = 0; port < kPortCount; ++port) {
    if (ports[port].get_base_port().get_interface() != nullptr)
      ports[port]->invalidate_direct_mem_ptr(first, last);
  }
}

}  // namespace stereotlm::memory
