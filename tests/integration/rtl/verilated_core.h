#pragma once

#include <verilated.h>

#include "tests/integration/rtl/rtl_core.h"

namespace stereotlm::test {

// Bits of a port of a verilated model, which is an integer or an array of 32-bit words.
template <typename Port>
std::uint32_t bits_of(const Port& port, std::size_t low, std::size_t bits) {
  return static_cast<std::uint32_t>(port >> low) & static_cast<std::uint32_t>((std::uint64_t{1} << bits) - 1);
}
template <std::size_t kWords>
std::uint32_t bits_of(const VlWide<kWords>& port, std::size_t low, std::size_t bits) {
  const std::size_t word = low / 32;
  std::uint64_t value = port.at(word);
  if (word + 1 < kWords) value |= std::uint64_t{port.at(word + 1)} << 32U;
  return static_cast<std::uint32_t>(value >> low % 32 & ((std::uint64_t{1} << bits) - 1));
}

// `Model`: the class that Verilator has made of stereo_core.
template <typename Model>
class VerilatedCore : public RtlCore {
 public:
  const RtlOutputs& step(const RtlInputs& inputs) override {
    model_.clk = 0;
    model_.reset = inputs.reset;
    model_.start = inputs.start;
    model_.policy = static_cast<std::uint8_t>(inputs.policy);
    model_.priority_list = inputs.priority_list;
    model_.turnaround = 0;
    model_.latency_2 = 0;
    for (std::size_t bank = 0; bank < kRtlBanks; ++bank) {
      model_.turnaround |= inputs.turnaround[bank] << 5 * bank;
      model_.latency_2 = static_cast<std::uint8_t>(model_.latency_2 | inputs.latency_2[bank] << bank);
      model_.bank_read_data[bank] = inputs.read_data[bank];
    }
    for (std::size_t port = 0; port < inputs.bases.size(); ++port) model_.bases[port] = inputs.bases[port];
    model_.host_request = inputs.host_request;
    model_.host_write = inputs.host_write;
    model_.host_address = inputs.host_address;
    model_.host_write_data = inputs.host_write_data;
    model_.eval();
    if (inputs.starts_at_end && model_.ends != 0) {
      model_.start = 1;
      model_.eval();
    }
    for (std::size_t port = 0; port < inputs.bases.size(); ++port)
      outputs_.ports[port] = {bits_of(model_.port_state, 3 * port, 3), model_.port_address[port],
                              bits_of(model_.port_granted, port, 1) != 0};
    outputs_.ports.back() = {inputs.host_request ? 0U : 2U, inputs.host_address, model_.host_granted != 0};
    outputs_.host_read_data = model_.host_read_data;
    for (std::size_t bank = 0; bank < kRtlBanks; ++bank)
      outputs_.banks[bank] = {bits_of(model_.bank_enable, bank, 1) != 0,
                              bits_of(model_.bank_write, bank, 1) != 0,
                              bits_of(model_.bank_address, 26 * bank, 26), model_.bank_write_data[bank]};
    outputs_.ends = model_.ends != 0;
    outputs_.consumes = model_.consumes != 0;
    outputs_.cycles = model_.cycles;
    model_.clk = 1;
    model_.eval();
    return outputs_;
  }

 private:
  Model model_;
  RtlOutputs outputs_;
};

}  // namespace stereotlm::test
