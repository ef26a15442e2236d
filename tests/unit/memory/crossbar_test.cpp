// The ports of stages: routes, grants, b_transport; and what needs no grant.
#include "models/memory/crossbar.h"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <ostream>
#include <stdexcept>
#include <vector>

#include "models/memory/ssram_bank.h"
#include "models/testing/expected_report.h"
#include "models/testing/monitoring_binder.h"
#include "models/testing/test_host.h"
#include "tests/support/scripted_ends.h"
#include "tests/unit/memory/ports.h"

namespace stereotlm::memory {
namespace {

using test::TestHost;

// A crossbar with a host on each port and three banks of 16 words, one of each kind, every link under a
// monitor. The test plays the clocked process: it calls arbitrate() for the cycles of a 40 MHz clock.
class CrossbarBench : public testing::Test {
 protected:
  static constexpr std::uint32_t kWords = 16;
  static constexpr std::size_t kPipelined = 0;
  static constexpr std::size_t kFlowThrough = 1;
  static constexpr std::size_t kBurst = 2;
  static constexpr std::uint64_t kPeriodPs = 25'000;

  CrossbarBench() {
    const CrossbarConfig config{kFixedPriority,
                                {{kWords, BankKind::kZbtPipelined},
                                 {kWords, BankKind::kZbtFlowThrough},
                                 {kWords, BankKind::kSyncBurst, 2}}};
    crossbar = std::make_unique<Crossbar>("crossbar", config);
    for (std::size_t port = 0; port < kGroupCount; ++port)
      binder.bind(hosts[port].socket, crossbar->ports[port], "port" + std::to_string(port) + "_to_crossbar");
    for (std::size_t bank = 0; bank < config.banks.size(); ++bank) {
      const std::string number = std::to_string(bank);
      banks.push_back(std::make_unique<SsramBank>(("ssram" + number).c_str(), config.banks[bank]));
      binder.bind(crossbar->banks[bank], banks.back()->port, "crossbar_to_bank" + number);
    }
    sc_core::sc_start(sc_core::SC_ZERO_TIME);
  }

  test::TestHost& at(Port port) { return hosts[port]; }
  void route(Port port, std::size_t bank, bool write) {
    crossbar->arbitration().route(port, bank, write);
    crossbar->aim(port, bank, write);
  }
  // One cycle with these requests.
  PortMask arbitrate(std::uint64_t cycle, PortMask requests = 0) {
    return crossbar->arbitrate(cycle, requests);
  }
  static sc_core::sc_time cycles(std::uint64_t count) {
    return sc_core::sc_time::from_value(count * kPeriodPs);
  }
  std::uint64_t accesses(std::size_t bank) const {
    const SsramBank::Stats& stats = banks[bank]->stats();
    return stats.reads + stats.writes + stats.errors;
  }

  test::MonitoringBinder binder;
  sc_core::sc_vector<test::TestHost> hosts{"test_host", kGroupCount};
  std::vector<std::unique_ptr<SsramBank>> banks;
  std::unique_ptr<Crossbar> crossbar;
};

class CrossbarPorts : public CrossbarBench {};

TEST_F(CrossbarPorts, LeadAGrantedAccessToTheBankOfItsRoute) {
  at(port::kHost).debug_write(crossbar_address(kFlowThrough, 3), {0x0BAD'CAFE});
  route(port::kLeftPixel, kFlowThrough, false);
  EXPECT_EQ(arbitrate(0, kLeft), kLeft);
  const TestHost::Answer answer = at(port::kLeftPixel).read(crossbar_address(kFlowThrough, 3), cycles(5));
  EXPECT_EQ(answer.status, tlm::TLM_OK_RESPONSE);
  EXPECT_EQ(answer.word, 0x0BAD'CAFEU);
  EXPECT_EQ(answer.at, cycles(5 + 1));
  EXPECT_EQ(accesses(kFlowThrough), 1U);
  EXPECT_EQ(accesses(kPipelined) + accesses(kBurst), 0U);
}

// An access that is refused, whoever was granted.
struct Refused {
  const char* name;
  PortMask requests;  // in the cycle of the access
  Port port;
  bool write;
  std::uint64_t address;
  tlm::tlm_response_status status;

  friend void PrintTo(const Refused& refused, std::ostream* out) { *out << refused.name; }
};

class RefusedAccess : public CrossbarBench, public testing::WithParamInterface<Refused> {};

TEST_P(RefusedAccess, ReachesNoBank) {
  const test::ExpectedReport refusal("/stereotlm/refused_access");
  const Refused& access = GetParam();
  route(port::kLeftPixel, kPipelined, false);
  route(port::kResult, kFlowThrough, true);
  ASSERT_EQ(arbitrate(0, kLeft), kLeft);
  ASSERT_EQ(arbitrate(1, access.requests), access.requests);
  TestHost& host = at(access.port);
  EXPECT_EQ((access.write ? host.write(access.address, 1) : host.read(access.address)).status, access.status);
  EXPECT_EQ(accesses(kPipelined) + accesses(kFlowThrough) + accesses(kBurst), 0U);
}

constexpr auto kNoGrant = tlm::TLM_GENERIC_ERROR_RESPONSE;
constexpr auto kNoBank = tlm::TLM_ADDRESS_ERROR_RESPONSE;
const std::vector<Refused> kRefused = {
    {"WithTheGrantOfTheCycleBefore", kNone, port::kLeftPixel, false, crossbar_address(0, 0), kNoGrant},
    {"WithoutGrant", kNone, port::kResult, true, crossbar_address(1, 0), kNoGrant},
    {"OfAnotherBankThanTheRoutes", kLeft, port::kLeftPixel, false, crossbar_address(1, 0), kNoGrant},
    {"ThatWriteOnAReadingRoute", kLeft, port::kLeftPixel, true, crossbar_address(0, 0), kNoGrant},
    {"ThatReadOnAWritingRoute", kResult, port::kResult, false, crossbar_address(1, 0), kNoGrant},
    {"OfABankThatDoesNotExist", kLeft, port::kLeftPixel, false, crossbar_address(3, 0), kNoBank},
    {"OfTheLastAddress", kLeft, port::kLeftPixel, false, ~std::uint64_t{3}, kNoBank}};
INSTANTIATE_TEST_SUITE_P(Crossbar, RefusedAccess, testing::ValuesIn(kRefused),
                         [](const auto& suite) { return std::string(suite.param.name); });

TEST_F(CrossbarPorts, RefuseTheSecondAccessOnOneGrant) {
  const test::ExpectedReport refusal("/stereotlm/refused_access");
  route(port::kLeftPixel, kPipelined, false);
  for (const std::uint64_t cycle : {0U, 1U}) {
    arbitrate(cycle, kLeft);
    EXPECT_EQ(at(port::kLeftPixel).read(crossbar_address(kPipelined, 0)).status, tlm::TLM_OK_RESPONSE);
    EXPECT_EQ(at(port::kLeftPixel).read(crossbar_address(kPipelined, 0)).status,
              tlm::TLM_GENERIC_ERROR_RESPONSE);
  }
  EXPECT_EQ(accesses(kPipelined), 2U);
}

// A grant is for one word.
TEST_F(CrossbarPorts, RefuseABurstAndKeepTheGrant) {
  test::ExpectedReport refusal("/stereotlm/refused_access");
  route(port::kLeftPixel, kPipelined, false);
  arbitrate(0, kLeft);
  EXPECT_EQ(at(port::kLeftPixel).read_words(crossbar_address(kPipelined, 0), 2).status,
            tlm::TLM_BURST_ERROR_RESPONSE);
  EXPECT_NE(
      refusal.text().find("crossbar: TLM_BURST_ERROR_RESPONSE for a read of 8 bytes at address 0x0: must be "
                          "one word by b_transport"),
      std::string::npos)
      << refusal.text();
  EXPECT_EQ(accesses(kPipelined), 0U);
  EXPECT_EQ(at(port::kLeftPixel).read(crossbar_address(kPipelined, 0)).status, tlm::TLM_OK_RESPONSE);
}

TEST_F(CrossbarPorts, ReachTheLastWordOfTheLastBankAndPassOnItsErrorsBeyond) {
  const test::ExpectedReport refusal("/stereotlm/refused_access");
  route(port::kLeftPixel, kBurst, false);
  arbitrate(0, kLeft);
  EXPECT_EQ(at(port::kLeftPixel).read(crossbar_address(kBurst, kWords - 1)).status, tlm::TLM_OK_RESPONSE);
  arbitrate(1, kLeft);
  EXPECT_EQ(at(port::kLeftPixel).read(crossbar_address(kBurst, kWords)).status,
            tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_EQ(banks[kBurst]->stats().errors, 1U);
}

TEST_F(CrossbarPorts, ReachEveryBankByDebugTransport) {
  for (std::size_t bank = 0; bank < 3; ++bank) {
    const auto number = static_cast<std::uint32_t>(bank);
    EXPECT_EQ(at(port::kHost).debug_write(crossbar_address(bank, 2), {number, number + 10}), 8U);
    EXPECT_EQ(banks[bank]->words()[3], number + 10);
    EXPECT_EQ(at(port::kLeftLut).debug_read(crossbar_address(bank, 2), 2),
              (std::vector<std::uint32_t>{number, number + 10}));
    EXPECT_EQ(at(port::kHost).debug_read(crossbar_address(bank, kWords - 1), 2).size(), 1U);
  }
  EXPECT_EQ(at(port::kHost).debug_write(crossbar_address(3, 0), {1}), 0U);
}

TEST_F(CrossbarPorts, AreRefusedDirectAccess) {
  tlm::tlm_dmi dmi;
  EXPECT_FALSE(at(port::kHost).dmi(crossbar_address(kBurst, 5), dmi));
}

TEST_F(CrossbarPorts, AreNotRoutedToABankOrFromAPortThatDoesNotExist) {
  const test::ExpectedReport report("/stereotlm/crossbar", 2);
  route(port::kLeftPixel, kPipelined, false);
  EXPECT_THROW(crossbar->aim(port::kLeftPixel, 3, false), sc_core::sc_report);
  EXPECT_EQ(report.text(), "crossbar: aim: bank = 3: must be 0..2");
  EXPECT_THROW(crossbar->aim(kGroupCount, kPipelined, false), sc_core::sc_report);
  EXPECT_EQ(report.text(), "crossbar: aim: port = 6: must be 0..5");
  EXPECT_EQ(crossbar->bank_of(port::kLeftPixel), kPipelined);
  EXPECT_EQ(arbitrate(0, kLeft), kLeft) << "its route has stayed";
  EXPECT_EQ(crossbar->direct(crossbar_address(3, 0), 4), nullptr);
}

// A bank that grants direct access to its words 0 and 1, or not at all, and revokes it; words 2 and 3 are
// granted separately.
class CrossbarRevoked : public testing::Test {
 protected:
  CrossbarRevoked() {
    binder.bind(crossbar.banks[0], target.socket, "bank");
    target.on_dmi = [this](tlm::tlm_generic_payload& access, tlm::tlm_dmi& dmi) {
      const std::uint64_t start = access.get_address() / 8 * 8;
      unsigned char* const granted = start == 0 ? memory : start == 8 ? memory_behind : nullptr;
      if (granted == nullptr || (reads_only && access.is_write())) return false;
      dmi.set_dmi_ptr(granted);
      dmi.set_start_address(start);
      dmi.set_end_address(start + 7);
      reads_only ? dmi.allow_read() : dmi.allow_read_write();
      return true;
    };
    sc_core::sc_start(sc_core::SC_ZERO_TIME);
  }
  std::array<unsigned char, 8> first{};
  std::array<unsigned char, 8> second{};
  unsigned char* memory = first.data();
  unsigned char* memory_behind = nullptr;
  bool reads_only = false;
  Crossbar crossbar{"crossbar", {kFixedPriority, {{16}}}};
  test::ScriptedTarget target{"target"};
  test::MonitoringBinder binder;
};

TEST_F(CrossbarRevoked, ReachesWordsThatAreGrantedSeparately) {
  memory_behind = second.data();
  EXPECT_EQ(crossbar.direct(0, 8), first.data());
  EXPECT_EQ(crossbar.direct(12, 4), second.data() + 4);
  EXPECT_EQ(crossbar.direct(8, 8), second.data());
  EXPECT_EQ(crossbar.direct(4, 4), first.data() + 4);
  EXPECT_EQ(crossbar.direct(4, 8), nullptr);
}

TEST_F(CrossbarRevoked, ReachesWhatTheBankGrantsAfterItHasRevokedAccess) {
  ASSERT_EQ(crossbar.direct(0, 8), first.data());
  memory = second.data();
  target.socket->invalidate_direct_mem_ptr(0, 7);
  EXPECT_EQ(crossbar.direct(0, 8), second.data());
  memory = nullptr;
  target.socket->invalidate_direct_mem_ptr(0, 7);
  EXPECT_EQ(crossbar.direct(0, 8), nullptr);
  memory = first.data();
  EXPECT_EQ(crossbar.direct(0, 8), first.data());
}

TEST_F(CrossbarRevoked, IsNullForMoreThanTheBankGrants) {
  EXPECT_EQ(crossbar.direct(0, 9), nullptr);
  EXPECT_EQ(crossbar.direct(4, 8), nullptr);
  EXPECT_EQ(crossbar.direct(8, 4), nullptr);
}

TEST_F(CrossbarRevoked, IsNullForWordsThatCanOnlyBeRead) {
  reads_only = true;
  EXPECT_EQ(crossbar.direct(0, 8), nullptr);
}

TEST(Crossbar, MayLeaveAPortUnbound) {
  Crossbar crossbar("crossbar", {kFixedPriority, {{16}}});
  SsramBank bank("ssram", {16});
  test::MonitoringBinder binder;
  binder.bind(crossbar.banks[0], bank.port, "bank0");
  EXPECT_NO_THROW(sc_core::sc_start(sc_core::SC_ZERO_TIME));
}

TEST(Crossbar, RefusesAConfigurationWithProblems) {
  using Banks = std::vector<SsramBankConfig>;
  const ArbiterConfig valid = kFixedPriority;
  ArbiterConfig twice = valid;
  twice.priority[0] = port::kResult;
  for (const CrossbarConfig& config : {CrossbarConfig{valid, {}}, CrossbarConfig{twice, {{16}}},
                                       CrossbarConfig{valid, {{0}}}, CrossbarConfig{valid, Banks(65)},
                                       CrossbarConfig{valid, {{16}, {16, BankKind::kZbtPipelined, 0, 50}}}})
    EXPECT_THROW(Crossbar("refused", config), std::invalid_argument);
  EXPECT_NO_THROW(Crossbar("valid", CrossbarConfig{valid, Banks(64)}));
}

}  // namespace
}  // namespace stereotlm::memory
