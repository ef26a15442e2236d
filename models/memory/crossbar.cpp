#include "models/memory/crossbar.h"

#include <string>

#include "models/checked.h"

namespace stereotlm::memory {
namespace {

constexpr std::uint64_t kOffsetMask = (std::uint64_t{1} << kBankAddressBits) - 1;

}  // namespace

std::vector<std::string> problems(const CrossbarConfig& config) {
  auto found = problems(config.arbiter);
  kBankCountRule.check("banks", static_cast<std::int64_t>(config.banks.size()), found);
  for (std::size_t number = 0; number < config.banks.size(); ++number) {
    const SsramBankConfig& bank = config.banks[number];
    const std::string name = "banks[" + std::to_string(number) + "]: ";
    for (const std::string& problem : problems(bank)) found.push_back(name + problem);
    if (bank.clock_mhz != config.banks.front().clock_mhz) {
      found.push_back(name + "clock_mhz = " + std::to_string(bank.clock_mhz) +
                      ": must be the same for all banks");
    }
  }
  return found;
}

Crossbar::Crossbar(const sc_core::sc_module_name& name, const CrossbarConfig& config)
    : sc_module(name),
      DirectBanks(config.banks.size()),
      ports("port", config.arbiter.priority.size()),
      banks("bank", config.banks.size()),
      arbitration_(checked(this->name(), config).arbiter, config.banks) {
  for (Port port = 0; port < ports.size(); ++port) {
    targets_.emplace_back(*this, port);
    ports[port].bind(targets_.back());
  }
}

void Crossbar::aim(Port port, std::size_t bank, bool write) {
  if (const std::string problem = arbitration_.route_problem(port, bank); !problem.empty()) {
    SC_REPORT_ERROR("/stereotlm/crossbar", (std::string(name()) + ": aim: " + problem).c_str());
    return;
  }
  targets_[port].route(bank, write, *banks[bank].operator->());
}

void Crossbar::PortTarget::route(std::size_t bank, bool write, tlm::tlm_blocking_transport_if<>& target) {
  command_ = write ? tlm::TLM_WRITE_COMMAND : tlm::TLM_READ_COMMAND;
  bank_base_ = crossbar_address(bank, 0);
  bank_port_ = &target;
}

void Crossbar::PortTarget::b_transport(tlm::tlm_generic_payload& access, sc_core::sc_time& delay) {
  const std::uint64_t address = access.get_address();
  const std::uint64_t offset = address - bank_base_;
  if ((granted_ & port_) == 0 || offset > kOffsetMask || access.get_command() != command_ ||
      access.get_data_length() > 4) {
    crossbar_.refuse(access);
    return;
  }
  granted_ &= ~port_;
  access.set_address(offset);
  bank_port_->b_transport(access, delay);
  access.set_address(address);
  if (command_ == tlm::TLM_WRITE_COMMAND) crossbar_.changes(address, 4);
}

unsigned char* Crossbar::direct(std::uint64_t address, std::uint64_t bytes) {
  if (!has_bank(address)) return nullptr;
  const std::uint64_t first = address & kOffsetMask;
  tlm::tlm_generic_payload access;
  access.set_command(tlm::TLM_WRITE_COMMAND);
  access.set_address(first);
  tlm::tlm_dmi dmi;
  if (!banks[bank_of_address(address)]->get_direct_mem_ptr(access, dmi) || !dmi.is_read_write_allowed() ||
      first < dmi.get_start_address() || first + bytes - 1 > dmi.get_end_address())
    return nullptr;
  return dmi.get_dmi_ptr() + (first - dmi.get_start_address());
}

void Crossbar::refuse(tlm::tlm_generic_payload& access) {
  access.set_response_status(!has_bank(access.get_address()) ? tlm::TLM_ADDRESS_ERROR_RESPONSE
                             : access.get_data_length() > 4  ? tlm::TLM_BURST_ERROR_RESPONSE
                                                             : tlm::TLM_GENERIC_ERROR_RESPONSE);
  refusals_.report(access,
                   "must be one word by b_transport, along the port's route, in a cycle with a grant");
}

unsigned Crossbar::debug(tlm::tlm_generic_payload& access) {
  const std::uint64_t address = access.get_address();
  if (!has_bank(address)) return 0;
  access.set_address(address & kOffsetMask);
  const unsigned length = banks[bank_of_address(address)]->transport_dbg(access);
  access.set_address(address);
  if (access.is_write()) changes(address, length);
  return length;
}

}  // namespace stereotlm::memory
