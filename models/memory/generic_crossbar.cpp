#include "models/memory/generic_crossbar.h"

#include <algorithm>
#include <cstring>
#include <string>

#include "models/access_rules.h"
#include "models/checked.h"
#include "models/kernel_time.h"
#include "models/memory/memory_config.h"

namespace stereotlm::memory {
namespace {

constexpr AccessRules kRules = {UINT64_MAX, false, true};  // those of each bank come on top

}  // namespace

GenericCrossbar::GenericCrossbar(const sc_core::sc_module_name& name, const CrossbarConfig& config)
    : sc_module(name),
      ports("port", config.arbiter.priority.size()),
      banks("bank", config.banks.size()),
      clock_(checked(this->name(), config).banks.front().clock_mhz) {
  for (const auto& port : ports) states_.emplace_back(port);
  kernel_time::check_resolution(*this);
  for (const SsramBankConfig& bank : config.banks)
    arbiters_.emplace_back(config.arbiter, bank).begin_counting(0);
  for (std::size_t port = 0; port < ports.size(); ++port) {
    const auto tag = static_cast<int>(port);
    ports[port].register_b_transport(this, &GenericCrossbar::transport, tag);
    ports[port].register_transport_dbg(this, &GenericCrossbar::debug, tag);
  }
  SC_HAS_PROCESS(GenericCrossbar);
  SC_METHOD(begin_cycle);
  sensitive << cycle_;
  dont_initialize();
  SC_THREAD(access_banks);
}

ArbiterStats GenericCrossbar::stats(std::size_t bank) const {
  BankArbiter arbiter = arbiters_.at(bank);
  const std::uint64_t end = std::max(first_undecided_, clock_.edge_at_or_after(kernel_time::now_ps()));
  arbiter.count_rows(end);
  arbiter.end_counting(end);
  return arbiter.stats();
}

void GenericCrossbar::transport(int number, tlm::tlm_generic_payload& access, sc_core::sc_time& delay) {
  PortState& port = states_[static_cast<std::size_t>(number)];
  const char* const other = bank_of_address(access.get_address()) < banks.size()
                                ? "all words must be in one bank"
                                : "there is no such bank (crossbar_address(): the bank is in bits 28 and up)";
  if (!port.refusals.respond(access, check(access), kRules, other)) return;
  const auto serve = [&] {
    port.access = &access;
    port.done_bytes = 0;
    port.from_cycle = std::max(first_undecided_, clock_.edge_at_or_after(kernel_time::now_ps()));
    await_cycle();
    while (port.access != nullptr) wait(port.ended);
    delay = port.delay;
  };
  const auto drop = [&] {
    access_granted_words();
    port.access = nullptr;
    return port.done_bytes;
  };
  port.queue.serve(access, delay, serve, drop);
}

tlm::tlm_response_status GenericCrossbar::check(const tlm::tlm_generic_payload& access) const {
  const auto status = check_access(access, kRules);
  if (status != tlm::TLM_OK_RESPONSE) return status;
  const std::size_t bank = bank_of_address(access.get_address());
  const std::uint64_t last = access.get_address() + access.get_data_length() - 4;
  return bank < banks.size() && bank_of_address(last) == bank ? tlm::TLM_OK_RESPONSE
                                                              : tlm::TLM_ADDRESS_ERROR_RESPONSE;
}

// Requests the next cycle in which a port requests.
void GenericCrossbar::await_cycle() {
  std::uint64_t next = UINT64_MAX;
  for (const PortState& port : states_) {
    if (port.access != nullptr) next = std::min(next, port.from_cycle);
  }
  cycle_.set(next == UINT64_MAX ? kNever : clock_.edge_ps(next));
}

void GenericCrossbar::begin_cycle() {
  cycle_.taken();
  decision_.request();
}

void GenericCrossbar::decide() {
  const std::uint64_t cycle = clock_.edge_at_or_after(kernel_time::now_ps());
  std::vector<PortMask> requests(banks.size());
  std::vector<PortMask> writes(banks.size());
  for (Port port = 0; port < states_.size(); ++port) {
    const PortState& state = states_[port];
    if (state.access == nullptr || state.from_cycle > cycle) continue;
    const std::uint64_t address = state.access->get_address() + state.done_bytes;
    requests[bank_of_address(address)] |= mask_of(port);
    if (state.access->is_write()) writes[bank_of_address(address)] |= mask_of(port);
    words_[port] = static_cast<std::uint32_t>(address_in_bank(address) / 4);
  }
  first_undecided_ = cycle + 1;
  for (std::size_t bank = 0; bank < banks.size(); ++bank) {
    if (requests[bank] != 0) decide(bank, cycle, requests[bank], writes[bank]);
  }
  granted_.empty() ? await_cycle() : accesses_.notify(sc_core::SC_ZERO_TIME);
}

void GenericCrossbar::decide(std::size_t bank, std::uint64_t cycle, PortMask requests, PortMask writes) {
  const BankArbiter::Outcome outcome = arbiters_[bank].decide(cycle, requests, writes, words_.data());
  arbiters_[bank].count(outcome);
  for_each_port(requests, [&](Port port) { states_[port].from_cycle = cycle + 1; });
  for_each_port(outcome.granted & ~writes, [&](Port port) { granted_.emplace_back(port, bank); });
  for_each_port(outcome.granted & writes, [&](Port port) { granted_.emplace_back(port, bank); });
}

// A thread: the protocol allows b_transport only there.
void GenericCrossbar::access_banks() {
  for (;;) {
    wait(accesses_);
    access_granted_words();
    await_cycle();
  }
}

void GenericCrossbar::access_granted_words() {
  while (!granted_.empty()) {
    const auto [port, bank] = granted_.front();
    granted_.pop_front();
    access_word(states_[port], bank);
  }
}

// The next word of the port has been granted in the cycle that begins now. It is copied, because the bank may
// kill the process of the access.
void GenericCrossbar::access_word(PortState& port, std::size_t bank) {
  tlm::tlm_generic_payload& access = *port.access;
  unsigned char* const place = access.get_data_ptr() + port.done_bytes;
  std::array<unsigned char, 4> data{};
  std::memcpy(data.data(), place, 4);
  tlm::tlm_generic_payload word;
  word.set_command(access.get_command());
  word.set_address(address_in_bank(access.get_address()) + port.done_bytes);
  word.set_data_ptr(data.data());
  word.set_data_length(4);
  word.set_streaming_width(4);
  std::array<unsigned char, 4> enables{};
  if (access.get_byte_enable_ptr() != nullptr) {
    for (unsigned byte = 0; byte < 4; ++byte)
      enables[byte] =
          access.get_byte_enable_ptr()[(port.done_bytes + byte) % access.get_byte_enable_length()];
    word.set_byte_enable_ptr(enables.data());
    word.set_byte_enable_length(4);
  }
  port.done_bytes += 4;
  sc_core::sc_time delay;
  banks[bank]->b_transport(word, delay);
  if (port.access == nullptr) return;
  if (access.is_read()) std::memcpy(place, data.data(), 4);
  if (word.is_response_ok() && port.done_bytes < access.get_data_length()) return;
  access.set_response_status(word.get_response_status());
  if (!word.is_response_ok()) port.refusals.report(access, "its bank has refused a word");
  port.access = nullptr;
  port.delay = access.is_read()
                   ? delay
                   : kernel_time::to_time(clock_.edge_ps(first_undecided_) - kernel_time::now_ps());
  port.ended.notify(sc_core::SC_ZERO_TIME);
}

unsigned GenericCrossbar::debug(int /*port*/, tlm::tlm_generic_payload& access) {
  const std::uint64_t address = access.get_address();
  if (bank_of_address(address) >= banks.size()) return 0;
  access.set_address(address_in_bank(address));
  const unsigned bytes = banks[bank_of_address(address)]->transport_dbg(access);
  access.set_address(address);
  return bytes;
}

}  // namespace stereotlm::memory
