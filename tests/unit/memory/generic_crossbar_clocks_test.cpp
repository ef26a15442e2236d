// GenericCrossbar takes the same cycles at every clock: all kinds of banks, 1 to 1,000 MHz by steps of
// 0.333 MHz, one port and two, b_transport and nb_transport.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "models/clock.h"
#include "models/kernel_time.h"
#include "models/memory/generic_crossbar.h"
#include "models/memory/ssram_bank.h"
#include "models/testing/test_host.h"
#include "models/time_ps.h"
#include "tests/support/fork.h"

namespace stereotlm::memory {
namespace {

constexpr int kSteps = 3000;
constexpr int kChildren = 10;
constexpr std::size_t kPorts = 4;  // the first two use b_transport, the others nb_transport

std::vector<SsramBankConfig> banks_at(double mhz) {
  return {{64, BankKind::kZbtPipelined, 0, mhz},
          {64, BankKind::kZbtFlowThrough, 0, mhz},
          {64, BankKind::kSyncBurst, 2, mhz},
          {64, BankKind::kQdr, 0, mhz},
          {64, BankKind::kSdram, 0, mhz, SdramTiming{}}};
}

// A crossbar at one clock. On each bank a port is alone, then two ports contend, with each transport.
class ClockedCrossbar {
 public:
  ClockedCrossbar(double mhz, int number)
      : clock_(mhz),
        crossbar_(fmt::format("crossbar{}", number).c_str(), {{"round_robin", {0, 1, 2, 3}}, banks_at(mhz)}) {
    for (const SsramBankConfig& bank : banks_at(mhz)) {
      banks_.push_back(
          std::make_unique<SsramBank>(fmt::format("bank{}_{}", number, banks_.size()).c_str(), bank));
      crossbar_.banks[banks_.size() - 1].bind(banks_.back()->port);
    }
    for (Port port = 0; port < kPorts; ++port) {
      hosts_.push_back(std::make_unique<test::TestHost>(fmt::format("host{}_{}", number, port).c_str()));
      hosts_.back()->socket.bind(crossbar_.ports[port]);
      sc_core::sc_spawn([this, port] { run(port); });
    }
  }

  // The cycle that begins with each response, or kNever if none does, port by port, and the counters that do not depend on the end of
  // the simulation.
  std::vector<std::uint64_t> figures() const {
    std::vector<std::uint64_t> figures;
    for (const auto& ends : ends_) figures.insert(figures.end(), ends.begin(), ends.end());
    for (std::size_t bank = 0; bank < banks_.size(); ++bank) {
      const ArbiterStats stats = crossbar_.stats(bank);
      figures.insert(figures.end(), {stats.reads(), stats.writes(), stats.contended_cycles()});
      figures.insert(figures.end(), stats.counts().begin() + ArbiterStats::kFirstGrants,
                     stats.counts().end());
    }
    return figures;
  }

 private:
  void run(Port port) {
    const std::uint64_t first = port < 2 ? 1 : 2002;
    if (port % 2 == 0) make_accesses(port, first);
    make_accesses(port, first + 1000);
  }
  void make_accesses(Port port, std::uint64_t from_cycle) {
    wait_until(kernel_time::to_time(clock_.edge_ps(from_cycle)));
    for (std::size_t bank = 0; bank < banks_.size(); ++bank) {
      for (const std::size_t words : {1U, 1U, 3U, 1U}) access(port, false, crossbar_address(bank, 7), words);
      for (const std::size_t words : {1U, 2U}) access(port, true, crossbar_address(bank, 9 + port), words);
    }
  }
  void access(Port port, bool write, std::uint64_t address, std::size_t words) {
    test::TestHost& host = *hosts_[port];
    const std::vector<std::uint32_t> data(words);
    test::TestHost::Answer answer;
    if (port >= 2) {
      answer = host.access(write ? tlm::TLM_WRITE_COMMAND : tlm::TLM_READ_COMMAND, address, data);
    } else {
      answer = write ? host.write_words(address, data) : host.read_words(address, words);
    }
    EXPECT_EQ(answer.status, tlm::TLM_OK_RESPONSE);
    const std::uint64_t end = clock_.edge_at_or_after(kernel_time::to_ps(answer.at));
    const bool is_edge = kernel_time::to_time(clock_.edge_ps(end)) == answer.at;
    ends_[port].push_back(is_edge ? end : kNever);
    wait_until(answer.at);
  }
  static void wait_until(const sc_core::sc_time& time) {
    if (time > sc_core::sc_time_stamp()) sc_core::wait(time - sc_core::sc_time_stamp());
  }

  Clock clock_;
  GenericCrossbar crossbar_;
  std::vector<std::unique_ptr<SsramBank>> banks_;
  std::vector<std::unique_ptr<test::TestHost>> hosts_;
  std::array<std::vector<std::uint64_t>, kPorts> ends_;
};

TEST(GenericCrossbar, TakesTheSameCyclesAtEveryClock) {
  std::vector<test::ChildWork> jobs;
  for (int child = 0; child < kChildren; ++child) {
    jobs.emplace_back([child]() -> std::string {
      std::vector<double> mhz = {40};
      for (int step = child; step <= kSteps; step += kChildren) mhz.push_back((1000 + 333 * step) / 1000.0);
      std::vector<std::unique_ptr<ClockedCrossbar>> crossbars;
      for (std::size_t number = 0; number < mhz.size(); ++number)
        crossbars.push_back(std::make_unique<ClockedCrossbar>(mhz[number], static_cast<int>(number)));
      sc_core::sc_start();
      const std::vector<std::uint64_t> expected = crossbars.front()->figures();
      std::string differing;
      for (std::size_t number = 0; number < mhz.size(); ++number)
        if (crossbars[number]->figures() != expected) differing += fmt::format(" {}", mhz[number]);
      return differing.empty() ? "" : "other figures than at 40 MHz at" + differing;
    });
  }
  for (const test::ChildResult& result : test::run_in_children(jobs, 2)) EXPECT_EQ(result.text, "");
}

}  // namespace
}  // namespace stereotlm::memory
