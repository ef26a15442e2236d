#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <systemc>
#include <tlm>
#include <utility>
#include <vector>

#include "models/clock.h"
#include "models/kernel_time.h"
#include "models/pci/pci_bus.h"
#include "models/testing/monitoring_binder.h"

namespace stereotlm::pci {

// A word that names its address.
constexpr std::uint32_t word_at(std::uint64_t address) {
  return static_cast<std::uint32_t>(address / 4 + 0x1000);
}
inline std::vector<std::uint32_t> words_from(std::uint64_t address, std::size_t count) {
  std::vector<std::uint32_t> words;
  for (std::size_t i = 0; i < count; ++i) words.push_back(word_at(address + 4 * i));
  return words;
}

constexpr int kWait = 4;  // wait clocks of most windows

struct Script {
  bool write = true;
  std::uint64_t address = 0;
  std::size_t words = 1;
};

// A master that runs its bursts one after the other, from the call of request() on. It writes
// word_at(address).
class TestMaster : public sc_core::sc_module, public PciMasterIf {
 public:
  struct Ended {
    BurstResult result;
    std::uint64_t address_ps = 0;
    std::uint64_t end_ps = 0;
    std::vector<std::uint32_t> words;
  };

  PciMasterPort pci{"pci"};
  std::deque<Script> bursts;
  std::vector<Ended> ended;
  std::function<void()> on_unused = [] {};  // a grant finds no burst

  explicit TestMaster(const sc_core::sc_module_name& name) : sc_module(name) {}
  void request() { pci->request(*this); }

  PciBurst begin_burst(std::uint64_t address_clock_ps) override {
    if (bursts.empty()) {
      on_unused();
      return {};
    }
    now_.address_ps = address_clock_ps;
    const Script script = bursts.front();
    bursts.pop_front();
    words_ =
        script.write ? words_from(script.address, script.words) : std::vector<std::uint32_t>(script.words);
    return {script.write, script.address, &words_};
  }
  void end_burst(const BurstResult& result) override {
    now_.result = result;
    now_.end_ps = kernel_time::now_ps();
    now_.words = words_;
    ended.push_back(now_);
    if (!bursts.empty()) request();
  }

 private:
  Ended now_;
  std::vector<std::uint32_t> words_;
};

// A target that records accesses. Reads return
// word_at(address).
class TestTarget : public sc_core::sc_module, public tlm::tlm_fw_transport_if<>, public PciStopIf {
 public:
  struct Access {
    bool write = false;
    std::uint64_t address = 0;
    std::vector<std::uint32_t> words;
  };

  tlm::tlm_target_socket<32> socket{"socket"};
  sc_core::sc_time write_delays;  // added to the delay of a write
  tlm::tlm_response_status response = tlm::TLM_OK_RESPONSE;
  std::function<std::size_t(std::uint64_t, std::size_t)> writable = [](auto, auto words) { return words; };
  std::vector<Access> accesses;

  explicit TestTarget(const sc_core::sc_module_name& name) : sc_module(name) { socket.bind(*this); }

  void b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) override {
    Access& access = accesses.emplace_back();
    access.write = payload.is_write();
    access.address = payload.get_address();
    access.words = words_from(access.address, payload.get_data_length() / 4);
    auto* const data = payload.get_data_ptr();
    if (access.write) {
      std::memcpy(access.words.data(), data, payload.get_data_length());
      delay += write_delays;
    } else {
      std::memcpy(data, access.words.data(), payload.get_data_length());
    }
    payload.set_response_status(response);
  }
  std::size_t writable_words(std::uint64_t address, std::size_t words) const override {
    return writable(address, words);
  }
  tlm::tlm_sync_enum nb_transport_fw(tlm::tlm_generic_payload&, tlm::tlm_phase&, sc_core::sc_time&) override {
    ADD_FAILURE() << "the bus uses b_transport";
    return tlm::TLM_COMPLETED;
  }
  bool get_direct_mem_ptr(tlm::tlm_generic_payload&, tlm::tlm_dmi&) override { return false; }
  unsigned transport_dbg(tlm::tlm_generic_payload&) override { return 0; }
};

// A bus with masters m0, m1, .. and a monitored target behind each window. Slots that `config` names come
// before the masters, and the last `own_windows` windows stay without a target: the test binds both.
class PciBusBench {
 public:
  explicit PciBusBench(PciBusConfig config, std::size_t masters_count = 1, std::size_t own_windows = 0)
      : clock_(config.clock_mhz) {
    const std::size_t own_slots = config.masters.size();
    for (std::size_t i = 0; i < masters_count; ++i) config.masters.push_back("m" + std::to_string(i));
    bus = std::make_unique<PciBus>("bus", config);
    for (std::size_t i = 0; i < masters_count; ++i) {
      masters.push_back(std::make_unique<TestMaster>(config.masters[own_slots + i].c_str()));
      masters[i]->pci.bind(bus->slots[own_slots + i]);
    }
    for (std::size_t i = 0; i + own_windows < config.windows.size(); ++i) {
      const std::string name = "t" + std::to_string(i);
      targets.push_back(std::make_unique<TestTarget>(name.c_str()));
      binder.bind(bus->targets[i], targets[i]->socket, "bus_to_" + name);
    }
  }
  // One window of 64 KiB at 0x10000.
  static PciBusConfig with_window(int wait_clocks, int latency_timer_clocks = 255) {
    PciBusConfig config;
    config.latency_timer_clocks = latency_timer_clocks;
    config.windows = {{kBase, kBytes, wait_clocks}};
    return config;
  }
  void bind_stop() { bus->stops[0].bind(*targets[0]); }

  // Runs `body` in simulation at an absolute time.
  void at(std::uint64_t time_ps, std::function<void()> body) {
    sc_core::sc_spawn([time_ps, body = std::move(body)] {
      if (time_ps > 0) sc_core::wait(kernel_time::to_time(time_ps));
      body();
    });
  }
  void request_at(std::uint64_t time_ps, std::size_t master = 0) {
    at(time_ps, [this, master] { masters[master]->request(); });
  }
  std::uint64_t edge(std::uint64_t clock) const { return clock_.edge_ps(clock); }

  static constexpr std::uint32_t kBase = 0x1'0000;
  static constexpr std::uint32_t kBytes = 0x1'0000;

  test::MonitoringBinder binder;
  std::unique_ptr<PciBus> bus;
  std::vector<std::unique_ptr<TestMaster>> masters;
  std::vector<std::unique_ptr<TestTarget>> targets;

 private:
  Clock clock_;
};

inline Script write_of(std::size_t words, std::uint64_t offset = 0) {
  return {true, PciBusBench::kBase + offset, words};
}
inline Script read_of(std::size_t words, std::uint64_t offset = 0) {
  return {false, PciBusBench::kBase + offset, words};
}

}  // namespace stereotlm::pci
