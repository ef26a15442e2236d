#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <systemc>
#include <vector>

#include "models/clock.h"
#include "models/fpga/register_map.h"
#include "models/fpga/stereo_core.h"
#include "models/kernel_time.h"
#include "models/kernels/rectification_table.h"
#include "models/memory/ssram_bank.h"
#include "models/testing/monitoring_binder.h"
#include "models/testing/test_host.h"
#include "tests/unit/fpga/stream_ends.h"

namespace stereotlm::fpga {

inline const sc_core::sc_time kPicosecond = sc_core::sc_time::from_value(1);

// The core of an 8 x 6 board with six banks of 64 words: left image, right image, disparity, left table,
// right table, and one that no frame uses. Hosts drive its registers and its local bus, every link under a
// monitor; the times at which the interrupt rises are recorded.
class StereoCoreBench : public testing::Test {
 protected:
  virtual Fidelity fidelity() const { return Fidelity::kCycle; }

  virtual void bind_bank(InitiatorSocket& from, TargetSocket& to, const std::string& link) {
    binder.bind(from, to, link);
  }

  static constexpr std::uint32_t kWords = 64;
  enum Bank : std::uint32_t { kLeft, kRight, kResult, kLeftTable, kRightTable, kSpare, kBankCount };

  static StereoCoreConfig small_board() {
    StereoCoreConfig config;
    config.core.width = 8;
    config.core.height = 6;
    config.core.window = 3;
    config.core.disparities = 3;
    config.core.filter.reset();
    config.core.pipeline_latency_cycles = 5;
    config.memory.banks.assign(kBankCount, {kWords});
    return config;
  }

  void build(const StereoCoreConfig& board) {
    config = board;
    config.fidelity = fidelity();
    clock = std::make_unique<Clock>(board.core.clock_mhz);
    core = std::make_unique<StereoCore>("core", config, binder);
    for (std::size_t bank = 0; bank < board.memory.banks.size(); ++bank) {
      const std::string number = std::to_string(bank);
      banks.push_back(
          std::make_unique<memory::SsramBank>(("ssram" + number).c_str(), board.memory.banks[bank]));
      bind_bank(core->banks[bank], banks.back()->port, "crossbar_to_bank" + number);
    }
    binder.bind(registers.socket, core->registers, "host_to_registers");
    binder.bind(memory.socket, core->local_bus, "host_to_local_bus");
    core->done(done);
    sc_core::sc_spawn([this] {
      for (;;) {
        sc_core::wait(done.posedge_event());
        done_at.push_back(sc_core::sc_time_stamp());
        if (on_done) on_done();
      }
    });
    sc_core::sc_start(sc_core::SC_ZERO_TIME);
    load();
  }

  // Pictures of noise, identity tables, and the base registers.
  void load() {
    const auto pixels = static_cast<std::size_t>(config.core.width * config.core.height);
    left = noise(pixels, 11);
    right = noise(pixels, 12);
    memory.debug_write(memory::crossbar_address(kLeft, 0), words_of(left));
    memory.debug_write(memory::crossbar_address(kRight, 0), words_of(right));
    const auto table = kernels::identity_table(config.core.width, config.core.height);
    memory.debug_write(memory::crossbar_address(kLeftTable, 0), table.entries);
    memory.debug_write(memory::crossbar_address(kRightTable, 0), table.entries);
    const FrameBases banks_of_ports = {kLeftTable, kRightTable, kLeft, kRight, kResult};
    for (memory::Port port = 0; port < kCoreGroupCount; ++port)
      set_base(kPortGroups[port].base_register, banks_of_ports[port]);
  }
  void set_base(std::uint64_t base_register, std::uint32_t bank, std::uint32_t word = 0) {
    registers.write(base_register, registers::base(bank, word));
  }
  static std::vector<std::uint32_t> words_of(const std::vector<std::uint8_t>& pixels) {
    std::vector<std::uint32_t> words(pixels.size() / 4);
    for (std::size_t pixel = 0; pixel < pixels.size(); ++pixel)
      words[pixel / 4] |= std::uint32_t{pixels[pixel]} << (8 * (pixel % 4));
    return words;
  }

  void control(std::uint32_t value) { registers.write(registers::kControl, value); }
  void start() { control(registers::kControlAcknowledge | registers::kControlStart); }
  std::uint32_t status() { return registers.read(registers::kStatus).word; }

  // The start of a clock cycle.
  sc_core::sc_time edge(std::uint64_t cycle) const { return kernel_time::to_time(clock->edge_ps(cycle)); }
  static void run_until(const sc_core::sc_time& time) { sc_core::sc_start(time - sc_core::sc_time_stamp()); }
  // Lets everything come to an end.
  void finish() { run_until(sc_core::sc_time_stamp() + edge(5000)); }
  // Does something in a process of its own, at this time.
  static void at(const sc_core::sc_time& time, const std::function<void()>& action) {
    sc_core::sc_spawn([time, action] {
      if (time > sc_core::sc_time_stamp()) sc_core::wait(time - sc_core::sc_time_stamp());
      action();
    });
  }

  const std::vector<std::uint64_t>& frame_cycles() const { return core->frames().frame_cycles(); }
  // frame_cycles if nothing contends, with both latencies of the slower side.
  std::uint64_t frame_cycles_alone(std::uint64_t latencies) const {
    const FrameGeometry& geometry = core->control().geometry();
    return latencies + geometry.slots + geometry.drain_cycles + 1 + pipeline();
  }
  std::uint64_t pipeline() const { return static_cast<std::uint64_t>(config.core.pipeline_latency_cycles); }
  PortCycles port(memory::Port which) const { return core->control().port_cycles(which); }
  // Words that reached a bank by transport, and directly.
  std::uint64_t accesses(std::uint32_t bank) const {
    return banks[bank]->stats().reads + banks[bank]->stats().writes + core->crossbar().direct_accesses(bank) +
           core->frames().direct_counts().accesses[bank];
  }

  StereoCoreConfig config;
  std::vector<std::uint8_t> left;
  std::vector<std::uint8_t> right;
  test::MonitoringBinder binder;
  test::TestHost registers{"register_host"};
  test::TestHost memory{"memory_host"};
  std::unique_ptr<Clock> clock;
  std::unique_ptr<StereoCore> core;
  std::vector<std::unique_ptr<memory::SsramBank>> banks;
  sc_core::sc_signal<bool> done{"done"};
  std::vector<sc_core::sc_time> done_at;
  std::function<void()> on_done;
};

// The same at each fidelity with pixels.
class StereoCoreFidelities : public StereoCoreBench, public testing::WithParamInterface<Fidelity> {
 protected:
  Fidelity fidelity() const override { return GetParam(); }
};
inline std::string name_of_fidelity(const testing::TestParamInfo<Fidelity>& info) {
  return info.param == Fidelity::kCycle ? "Cycle" : "Fast";
}

}  // namespace stereotlm::fpga
