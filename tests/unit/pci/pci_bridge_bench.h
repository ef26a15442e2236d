#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <memory>
#include <systemc>
#include <tlm>
#include <utility>
#include <vector>

#include "models/host/host_memory.h"
#include "models/pci/pci_bridge.h"
#include "models/testing/test_host.h"
#include "tests/unit/pci/pci_bus_bench.h"

namespace stereotlm::pci {

// The target on the local bus. A word reads as its address until it is written. A burst takes one word_time
// per word and one more, and is answered in advance. While `held`, no burst is answered.
class LocalTarget : public sc_core::sc_module, public tlm::tlm_fw_transport_if<> {
 public:
  struct Burst {
    bool write = false;
    std::uint64_t address = 0;
    std::vector<std::uint32_t> words;
  };

  tlm::tlm_target_socket<32> socket{"socket"};
  sc_core::sc_time word_time{25, sc_core::SC_NS};
  bool held = false;
  std::uint64_t refused_address = UINT64_MAX;  // bursts that begin there are refused
  std::vector<Burst> bursts;
  std::map<std::uint64_t, std::uint32_t> words;

  explicit LocalTarget(const sc_core::sc_module_name& name) : sc_module(name) { socket.bind(*this); }
  // Answers the burst that is held.
  void release() {
    held = false;
    if (held_ == nullptr) return;
    tlm::tlm_phase phase = tlm::BEGIN_RESP;
    sc_core::sc_time delay = time_of(bursts.back());
    EXPECT_EQ(socket->nb_transport_bw(*held_, phase, delay), tlm::TLM_COMPLETED);
    std::exchange(held_, nullptr)->release();
  }
  std::uint32_t word(std::uint64_t address) const {
    const auto found = words.find(address);
    return found == words.end() ? word_at(address) : found->second;
  }

  tlm::tlm_sync_enum nb_transport_fw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) override {
    EXPECT_EQ(phase, tlm::BEGIN_REQ);
    Burst& burst = bursts.emplace_back();
    burst.write = payload.is_write();
    burst.address = payload.get_address();
    burst.words.resize(payload.get_data_length() / 4);
    const bool refused = burst.address == refused_address;
    payload.set_response_status(refused ? tlm::TLM_ADDRESS_ERROR_RESPONSE : tlm::TLM_OK_RESPONSE);
    if (refused) return tlm::TLM_COMPLETED;
    move(burst, payload.get_data_ptr());
    if (!held) {
      delay += time_of(burst);
      return tlm::TLM_COMPLETED;
    }
    payload.acquire();
    held_ = &payload;
    return tlm::TLM_ACCEPTED;
  }
  void b_transport(tlm::tlm_generic_payload&, sc_core::sc_time&) override {
    ADD_FAILURE() << "the local bus takes nb_transport";
  }
  bool get_direct_mem_ptr(tlm::tlm_generic_payload&, tlm::tlm_dmi&) override { return false; }
  unsigned transport_dbg(tlm::tlm_generic_payload&) override { return 0; }

 private:
  sc_core::sc_time time_of(const Burst& burst) const {
    return word_time * static_cast<double>(burst.words.size() + 1);
  }
  void move(Burst& burst, unsigned char* data) {
    for (std::size_t i = 0; i < burst.words.size(); ++i, data += 4) {
      const std::uint64_t address = burst.address + i * 4;
      burst.words[i] = word(address);
      if (burst.write) {
        std::memcpy(&burst.words[i], data, 4);
        words[address] = burst.words[i];
      } else {
        std::memcpy(data, &burst.words[i], 4);
      }
    }
  }

  tlm::tlm_generic_payload* held_ = nullptr;
};

// The bridge on a PCI bus with host memory and a master that the test drives.
class PciBridgeBench : public testing::Test {
 protected:
  static constexpr std::uint32_t kMemoryBytes = 0x1'0000;  // at address 0
  static constexpr std::uint32_t kSlave = 0xC000'0000;
  static constexpr std::uint32_t kRegisters = 0xE000'0000;
  static constexpr std::uint64_t kCore = std::uint64_t{1} << 34U;

  void build(const PciBridgeConfig& config = {}) {
    PciBusConfig bus_config;
    bus_config.masters = {"bridge"};
    bus_config.windows = {{0, kMemoryBytes, 8},
                          {kSlave, bridge::kSlaveWindowBytes, 4},
                          {kRegisters, bridge::kRegisterWindowBytes, 4}};
    bench = std::make_unique<PciBusBench>(bus_config, 1, 3);
    dut = std::make_unique<PciBridge>("bridge", config);
    PciBus& bus = *bench->bus;
    dut->pci.bind(bus.slots[0]);
    bench->binder.bind(bus.targets[0], memory.port, "bus_to_memory");
    bench->binder.bind(host.socket, memory.port, "host_to_memory");
    bench->binder.bind(bus.targets[1], dut->slave, "bus_to_slave");
    bench->binder.bind(bus.targets[2], dut->registers, "bus_to_registers");
    bench->binder.bind(dut->local, local.socket, "bridge_to_local");
    bus.stops[1].bind(dut->stop);
    dut->doorbell(doorbell);
    sc_core::sc_start(sc_core::SC_ZERO_TIME);
  }
  static void run(double microseconds) { sc_core::sc_start(microseconds, sc_core::SC_US); }

  // One burst of the test's master. Written words are word_at(their PCI address).
  const TestMaster::Ended& burst(bool write, std::uint64_t address, std::size_t words) {
    TestMaster& master = *bench->masters[0];
    master.bursts.push_back({write, address, words});
    master.request();
    const std::size_t before = master.ended.size();
    for (int us = 0; us < 1000 && master.ended.size() == before; ++us) run(1);
    EXPECT_EQ(master.ended.size(), before + 1);
    return master.ended.back();
  }
  std::uint32_t read_register(std::uint64_t offset) {
    return burst(false, kRegisters + offset, 1).words.at(0);
  }
  std::uint32_t status() { return read_register(bridge::kInterruptStatus); }
  // At once, without the PCI bus.
  void write_register(std::uint64_t offset, std::uint32_t value) {
    tlm::tlm_generic_payload payload;
    payload.set_command(tlm::TLM_WRITE_COMMAND);
    payload.set_address(offset);
    payload.set_data_ptr(reinterpret_cast<unsigned char*>(&value));
    payload.set_data_length(4);
    payload.set_streaming_width(4);
    sc_core::sc_time delay;
    bench->bus->targets[2]->b_transport(payload, delay);
    EXPECT_EQ(payload.get_response_status(), tlm::TLM_OK_RESPONSE);
    sc_core::sc_start(1, sc_core::SC_NS);
  }

  struct Descriptor {
    std::uint32_t pci;
    std::uint32_t board;
    std::uint32_t words;  // with bridge::kToPci
  };
  // Starts a channel with a chain at address `chain` of host memory.
  void start(std::uint32_t channel, std::uint32_t chain, const std::vector<Descriptor>& descriptors) {
    for (std::size_t i = 0; i < descriptors.size(); ++i) {
      const auto at = static_cast<std::uint32_t>(chain + 16 * i);
      const bool last = i + 1 == descriptors.size();
      host.debug_write(at,
                       {descriptors[i].pci, descriptors[i].board, descriptors[i].words, last ? 0 : at + 16});
    }
    start(channel, chain);
  }
  void start(std::uint32_t channel, std::uint32_t chain) {
    write_register(bridge::kDmaDescriptor + channel * bridge::kChannelStride, chain);
    write_register(bridge::kDmaControl + channel * bridge::kChannelStride, 1);
  }

  std::unique_ptr<PciBusBench> bench;
  std::unique_ptr<PciBridge> dut;
  host::HostMemory memory{"memory", kMemoryBytes};
  test::TestHost host{"host"};  // at the memory, for debug transport
  LocalTarget local{"local"};
  sc_core::sc_signal<bool> doorbell{"doorbell"};
};

}  // namespace stereotlm::pci
