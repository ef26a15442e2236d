// The ports of stages: routes, grants, b_transport; and what needs no grant.
#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/unit/memory/crossbar_bench.h"
#include "tests/unit/support/scripted_link.h"

namespace stereotlm::memory {
namespace {

using test::TestHost;

class CrossbarStages : public CrossbarBench {};

constexpr PortMask kLeft = mask_of(Port::kLeftPixel);
constexpr PortMask kRight = mask_of(Port::kRightPixel);
constexpr PortMask kResult = mask_of(Port::kResult);
constexpr PortMask kNobody = 0;

PortMask both(PortMask a, PortMask b) { return static_cast<PortMask>(a | b); }

TEST_F(CrossbarStages, LeadAGrantedAccessToTheBankOfItsRoute) {
  build();
  at(Port::kHost).debug_write(crossbar_address(kFlowThrough, 3), {0x0BAD'CAFE});
  crossbar->route(Port::kLeftPixel, kFlowThrough, false);
  EXPECT_EQ(arbitrate(0, kLeft), kLeft);
  const TestHost::Answer answer = at(Port::kLeftPixel).read(crossbar_address(kFlowThrough, 3), cycles(5));
  EXPECT_EQ(answer.status, tlm::TLM_OK_RESPONSE);
  EXPECT_EQ(answer.word, 0x0BAD'CAFEU);
  EXPECT_EQ(answer.at, cycles(5 + 1));
  EXPECT_EQ(accesses(kFlowThrough), 1U);
  EXPECT_EQ(accesses(kPipelined) + accesses(kBurst), 0U);
}

TEST_F(CrossbarStages, AddTheReadTimeOfTheBankAndNothingForAWrite) {
  build();
  crossbar->route(Port::kLeftPixel, kPipelined, false);
  crossbar->route(Port::kResult, kBurst, true);
  ASSERT_EQ(arbitrate(0, both(kLeft, kResult)), both(kLeft, kResult));
  EXPECT_EQ(at(Port::kLeftPixel).read(crossbar_address(kPipelined, 0)).at, cycles(2));
  EXPECT_EQ(at(Port::kResult).write(crossbar_address(kBurst, 0), 5).at, cycles(0));
  EXPECT_EQ(banks[kBurst]->words()[0], 5U);
}

TEST_F(CrossbarStages, RefuseAnAccessWithoutGrant) {
  build();
  crossbar->route(Port::kLeftPixel, kPipelined, false);
  EXPECT_EQ(at(Port::kLeftPixel).read(crossbar_address(kPipelined, 0)).status,
            tlm::TLM_GENERIC_ERROR_RESPONSE);
  EXPECT_EQ(arbitrate(0, kNobody), kNobody);
  EXPECT_EQ(at(Port::kLeftPixel).read(crossbar_address(kPipelined, 0)).status,
            tlm::TLM_GENERIC_ERROR_RESPONSE);
  EXPECT_EQ(accesses(kPipelined), 0U);
}

TEST_F(CrossbarStages, RefuseTheSecondAccessOnOneGrant) {
  build();
  crossbar->route(Port::kLeftPixel, kPipelined, false);
  arbitrate(0, kLeft);
  EXPECT_EQ(at(Port::kLeftPixel).read(crossbar_address(kPipelined, 0)).status, tlm::TLM_OK_RESPONSE);
  EXPECT_EQ(at(Port::kLeftPixel).read(crossbar_address(kPipelined, 0)).status,
            tlm::TLM_GENERIC_ERROR_RESPONSE);
  arbitrate(1, kLeft);
  EXPECT_EQ(at(Port::kLeftPixel).read(crossbar_address(kPipelined, 0)).status, tlm::TLM_OK_RESPONSE);
  EXPECT_EQ(accesses(kPipelined), 2U);
}

TEST_F(CrossbarStages, LoseAGrantThatTheyDoNotUseInItsCycle) {
  build();
  crossbar->route(Port::kLeftPixel, kPipelined, false);
  ASSERT_EQ(arbitrate(0, kLeft), kLeft);
  ASSERT_EQ(arbitrate(1, kNobody), kNobody);
  EXPECT_EQ(at(Port::kLeftPixel).read(crossbar_address(kPipelined, 0)).status,
            tlm::TLM_GENERIC_ERROR_RESPONSE);
}

TEST_F(CrossbarStages, RefuseAnotherBankThanTheRoutes) {
  build();
  crossbar->route(Port::kLeftPixel, kPipelined, false);
  arbitrate(0, kLeft);
  EXPECT_EQ(at(Port::kLeftPixel).read(crossbar_address(kFlowThrough, 0)).status,
            tlm::TLM_GENERIC_ERROR_RESPONSE);
  EXPECT_EQ(accesses(kPipelined) + accesses(kFlowThrough), 0U);
}

TEST_F(CrossbarStages, RefuseTheOtherDirection) {
  build();
  crossbar->route(Port::kLeftPixel, kPipelined, false);
  crossbar->route(Port::kResult, kFlowThrough, true);
  arbitrate(0, both(kLeft, kResult));
  EXPECT_EQ(at(Port::kLeftPixel).write(crossbar_address(kPipelined, 0), 1).status,
            tlm::TLM_GENERIC_ERROR_RESPONSE);
  EXPECT_EQ(at(Port::kResult).read(crossbar_address(kFlowThrough, 0)).status,
            tlm::TLM_GENERIC_ERROR_RESPONSE);
  EXPECT_EQ(accesses(kPipelined) + accesses(kFlowThrough), 0U);
}

TEST_F(CrossbarStages, RefuseAnAddressOutsideEveryBank) {
  build();
  crossbar->route(Port::kLeftPixel, kPipelined, false);
  arbitrate(0, kLeft);
  EXPECT_EQ(at(Port::kLeftPixel).read(crossbar_address(3, 0)).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_EQ(at(Port::kLeftPixel).read(~std::uint64_t{3}).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
  // The last word of the last bank is one of them no more.
  crossbar->route(Port::kLeftPixel, kBurst, false);
  arbitrate(1, kLeft);
  EXPECT_EQ(at(Port::kLeftPixel).read(crossbar_address(kBurst, kWords - 1)).status, tlm::TLM_OK_RESPONSE);
}

TEST_F(CrossbarStages, HandOnTheBanksOwnErrors) {
  build();
  crossbar->route(Port::kLeftPixel, kPipelined, false);
  arbitrate(0, kLeft);
  EXPECT_EQ(at(Port::kLeftPixel).read(crossbar_address(kPipelined, kWords)).status,
            tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_EQ(banks[kPipelined]->stats().errors, 1U);
}

TEST_F(CrossbarStages, ShareABankOneAtATime) {
  build();
  crossbar->route(Port::kLeftPixel, kPipelined, false);
  crossbar->route(Port::kRightPixel, kPipelined, false);
  crossbar->route(Port::kResult, kPipelined, true);
  crossbar->begin_counting(0);
  const PortMask all = both(both(kLeft, kRight), kResult);
  EXPECT_EQ(arbitrate(0, all), kResult);
  EXPECT_EQ(arbitrate(1, both(kLeft, kRight)), kLeft);
  EXPECT_EQ(arbitrate(2, kRight), kRight);
  crossbar->end_counting(4);
  const ArbiterStats stats = crossbar->arbiters()[kPipelined].stats();
  EXPECT_EQ(stats.contended_cycles, 2U);
  EXPECT_EQ(stats.idle_cycles, 1U);
  EXPECT_EQ(stats.blame[index_of(Port::kRightPixel)][index_of(Port::kResult)], 1U);
  EXPECT_EQ(stats.blame[index_of(Port::kRightPixel)][index_of(Port::kLeftPixel)], 1U);
  EXPECT_EQ(stats.blame[index_of(Port::kLeftPixel)][index_of(Port::kResult)], 1U);
  EXPECT_EQ(crossbar->arbiters()[kFlowThrough].stats().idle_cycles, 4U);
}

TEST_F(CrossbarStages, KeepTheirRoundRobinPlaceFromTheTimeAloneOnABank) {
  build({ArbitrationPolicy::kRoundRobin, ArbiterConfig{}.priority});
  crossbar->route(Port::kResult, kFlowThrough, true);
  crossbar->route(Port::kLeftPixel, kPipelined, false);
  crossbar->begin_counting(0);
  EXPECT_EQ(arbitrate(0, both(kLeft, kResult)), both(kLeft, kResult));
  EXPECT_EQ(arbitrate(2, kLeft), kLeft);
  crossbar->end_counting(4);
  EXPECT_EQ(crossbar->arbiters()[kPipelined].stats().reads, 2U);
  EXPECT_EQ(crossbar->arbiters()[kPipelined].stats().idle_cycles, 2U);
  EXPECT_EQ(crossbar->arbiters()[kFlowThrough].stats().writes, 1U);
  // The search of the list begins behind the left pixel port: the right one comes before the result.
  crossbar->route(Port::kResult, kPipelined, true);
  crossbar->route(Port::kRightPixel, kPipelined, false);
  EXPECT_EQ(arbitrate(4, both(both(kLeft, kRight), kResult)), kRight);
}

TEST_F(CrossbarStages, DoNotMeetInDifferentBanks) {
  build();
  crossbar->route(Port::kLeftPixel, kPipelined, false);
  crossbar->route(Port::kRightPixel, kFlowThrough, false);
  EXPECT_EQ(arbitrate(0, both(kLeft, kRight)), both(kLeft, kRight));
}

TEST_F(CrossbarStages, MoveToAnotherBankWithTheirRoute) {
  build();
  crossbar->route(Port::kLeftPixel, kPipelined, false);
  crossbar->route(Port::kRightPixel, kPipelined, false);
  EXPECT_EQ(arbitrate(0, both(kLeft, kRight)), kLeft);
  crossbar->route(Port::kRightPixel, kBurst, false);
  EXPECT_EQ(arbitrate(1, both(kLeft, kRight)), both(kLeft, kRight));
  EXPECT_EQ(at(Port::kRightPixel).read(crossbar_address(kBurst, 1)).status, tlm::TLM_OK_RESPONSE);
}

TEST_F(CrossbarStages, WaitForTheTurnaroundOfASyncBurstBankAlone) {
  build();
  for (const std::size_t bank : {kPipelined, kBurst}) {
    const std::uint64_t start = 100 * bank;
    crossbar->route(Port::kLeftPixel, bank, false);
    crossbar->route(Port::kResult, bank, true);
    ASSERT_EQ(arbitrate(start, kLeft), kLeft);
    EXPECT_EQ(arbitrate(start + 2, kResult), bank == kBurst ? kNobody : kResult);
    EXPECT_EQ(arbitrate(start + 3, kResult), kResult);
  }
}

TEST_F(CrossbarStages, ReachEveryBankByDebugTransport) {
  build();
  for (std::size_t bank = 0; bank < 3; ++bank) {
    const auto number = static_cast<std::uint32_t>(bank);
    EXPECT_EQ(at(Port::kHost).debug_write(crossbar_address(bank, 2), {number, number + 10}), 8U);
    EXPECT_EQ(banks[bank]->words()[3], number + 10);
    EXPECT_EQ(at(Port::kLeftLut).debug_read(crossbar_address(bank, 2), 2),
              (std::vector<std::uint32_t>{number, number + 10}));
    EXPECT_EQ(at(Port::kHost).debug_read(crossbar_address(bank, kWords - 1), 2).size(), 1U);
  }
  EXPECT_EQ(at(Port::kHost).debug_write(crossbar_address(3, 0), {1}), 0U);
}

TEST_F(CrossbarStages, SeeTheRangeOfDirectAccessInTheirOwnAddresses) {
  build();
  tlm::tlm_dmi dmi;
  ASSERT_TRUE(at(Port::kHost).dmi(crossbar_address(kBurst, 5), dmi));
  EXPECT_EQ(dmi.get_start_address(), crossbar_address(kBurst, 0));
  EXPECT_EQ(dmi.get_end_address(), crossbar_address(kBurst, kWords) - 1);
  reinterpret_cast<std::uint32_t*>(dmi.get_dmi_ptr())[5] = 1234;
  EXPECT_EQ(banks[kBurst]->words()[5], 1234U);
  EXPECT_FALSE(at(Port::kHost).dmi(crossbar_address(3, 0), dmi));
}

TEST_F(CrossbarStages, AreRefusedDirectAccessBehindTheEndOfABankWithARangeThatHoldsTheAddress) {
  build();
  for (std::size_t bank = 0; bank < 3; ++bank) {
    const std::uint64_t address = crossbar_address(bank, kWords);
    tlm::tlm_dmi dmi;
    EXPECT_FALSE(at(Port::kHost).dmi(address, dmi));
    EXPECT_LE(dmi.get_start_address(), address) << bank;
    EXPECT_GE(dmi.get_end_address(), address) << bank;
  }
}

TEST(Crossbar, TellsEveryPortWhichDirectAccessABankRevokes) {
  Crossbar crossbar("crossbar", {ArbiterConfig{}, {{16}, {16}}});
  test::MonitoringBinder binder;
  sc_core::sc_vector<TestHost> hosts("test_host", kPortCount);
  sc_core::sc_vector<test::ScriptedTarget> targets("target", 2);
  for (std::size_t port = 0; port < kPortCount; ++port) {
    binder.bind(hosts[port].socket, crossbar.ports[port], kPortNames[port]);
  }
  for (std::size_t bank = 0; bank < 2; ++bank)
    binder.bind(crossbar.banks[bank], targets[bank].socket, "bank" + std::to_string(bank));
  sc_core::sc_start(sc_core::SC_ZERO_TIME);
  targets[1].socket->invalidate_direct_mem_ptr(8, 15);
  for (const TestHost& host : hosts) {
    ASSERT_EQ(host.invalidations.size(), 1U);
    EXPECT_EQ(host.invalidations[0].first, crossbar_address(1, 2));
    EXPECT_EQ(host.invalidations[0].second, crossbar_address(1, 4) - 1);
  }
}

TEST(Crossbar, MayLeaveAPortUnbound) {
  Crossbar crossbar("crossbar", {ArbiterConfig{}, {{16}}});
  SsramBank bank("ssram", {16});
  test::MonitoringBinder binder;
  binder.bind(crossbar.banks[0], bank.port, "bank0");
  EXPECT_NO_THROW(sc_core::sc_start(sc_core::SC_ZERO_TIME));
}

TEST(Crossbar, RefusesAConfigurationWithProblems) {
  const ArbiterConfig valid;
  ArbiterConfig twice;
  twice.priority[0] = Port::kResult;
  EXPECT_THROW(Crossbar("a", CrossbarConfig{valid, {}}), std::invalid_argument);
  EXPECT_THROW(Crossbar("b", CrossbarConfig{twice, {{16}}}), std::invalid_argument);
  EXPECT_THROW(Crossbar("c", CrossbarConfig{valid, {{0}}}), std::invalid_argument);
  EXPECT_THROW(Crossbar("d", CrossbarConfig{valid, std::vector<SsramBankConfig>(65)}), std::invalid_argument);
  EXPECT_THROW(Crossbar("f", CrossbarConfig{valid, {{16}, {16, BankKind::kZbtPipelined, 0, 50}}}),
               std::invalid_argument);
  EXPECT_NO_THROW(Crossbar("e", CrossbarConfig{valid, std::vector<SsramBankConfig>(64)}));
}

}  // namespace
}  // namespace stereotlm::memory
