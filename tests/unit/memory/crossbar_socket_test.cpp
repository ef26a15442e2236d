// Requests that come by nb_transport: from when they take part, how long they wait, and how they end.
#include <gtest/gtest.h>

#include "models/clock.h"
#include "tests/support/expected_report.h"
#include "tests/unit/memory/crossbar_bench.h"

namespace stereotlm::memory {
namespace {

using sc_core::sc_time;
using test::ExpectedReport;
using test::TestHost;
using tlm::TLM_READ_COMMAND;
using tlm::TLM_WRITE_COMMAND;

class CrossbarSockets : public CrossbarBench {};

constexpr PortMask kHost = mask_of(Port::kHost);
constexpr PortMask kLeft = mask_of(Port::kLeftPixel);
constexpr PortMask kNobody = 0;

ArbiterConfig host_last() {
  ArbiterConfig config;
  config.priority = {Port::kResult,  Port::kLeftPixel, Port::kRightPixel,
                     Port::kLeftLut, Port::kRightLut,  Port::kHost};
  return config;
}

TEST_F(CrossbarSockets, TakePartInTheCycleThatBeginsAtTheirTime) {
  build();
  EXPECT_EQ(at(Port::kHost).request(TLM_READ_COMMAND, crossbar_address(kPipelined, 0), 0, cycles(4)),
            tlm::TLM_ACCEPTED);
  EXPECT_TRUE(crossbar->request_pending());
  EXPECT_EQ(arbitrate(3), kNobody);
  EXPECT_EQ(crossbar->socket_requests(), kNobody);
  EXPECT_EQ(arbitrate(4), kHost);
  EXPECT_EQ(crossbar->socket_requests(), kHost);
  EXPECT_FALSE(crossbar->request_pending());
  EXPECT_EQ(arbitrate(5), kNobody);
  EXPECT_EQ(crossbar->socket_requests(), kNobody);
}

TEST_F(CrossbarSockets, TakePartInTheNextCycleWhenTheyComeAPicosecondLate) {
  build();
  at(Port::kHost)
      .request(TLM_READ_COMMAND, crossbar_address(kPipelined, 0), 0, cycles(4) + sc_time::from_value(1));
  EXPECT_EQ(arbitrate(4), kNobody);
  EXPECT_EQ(arbitrate(5), kHost);
}

TEST_F(CrossbarSockets, AnswerWhenTheWordIsUsable) {
  build();
  std::uint64_t cycle = 0;
  for (const std::size_t bank : {kPipelined, kFlowThrough, kBurst}) {
    at(Port::kHost).debug_write(crossbar_address(bank, 7), {static_cast<std::uint32_t>(50 + bank)});
    at(Port::kHost).request(TLM_READ_COMMAND, crossbar_address(bank, 7));
    ASSERT_EQ(arbitrate(++cycle), kHost);
    const TestHost::Answer& answer = at(Port::kHost).answers.back();
    EXPECT_EQ(answer.status, tlm::TLM_OK_RESPONSE);
    EXPECT_EQ(answer.word, 50 + bank);
    EXPECT_EQ(answer.at, cycles(cycle + (bank == kFlowThrough ? 1 : 2)));
  }
}

TEST_F(CrossbarSockets, AnswerAtTheVeryEdgeOfTheCycleInWhichTheWordIsUsable) {
  build({}, 33.333);
  const Clock clock(33.333);
  for (std::uint64_t cycle = 0; cycle < 8; ++cycle) {
    at(Port::kHost).request(TLM_READ_COMMAND, crossbar_address(kPipelined, 0));
    ASSERT_EQ(crossbar->arbitrate(cycle, clock.edge_ps(cycle), 0), kHost);
    EXPECT_EQ(Clock::to_ps(at(Port::kHost).answers.back().at), clock.edge_ps(cycle + 2)) << cycle;
  }
}

TEST_F(CrossbarSockets, WriteInTheCycleOfTheirGrant) {
  build();
  at(Port::kHost).request(TLM_WRITE_COMMAND, crossbar_address(kFlowThrough, 2), 99);
  EXPECT_EQ(banks[kFlowThrough]->words()[2], 0U);
  ASSERT_EQ(arbitrate(6), kHost);
  EXPECT_EQ(banks[kFlowThrough]->words()[2], 99U);
  EXPECT_EQ(at(Port::kHost).answers.back().at, cycles(6 + 1));
}

TEST_F(CrossbarSockets, WaitWhileAStageIsPreferred) {
  build(host_last());
  crossbar->route(Port::kLeftPixel, kPipelined, false);
  crossbar->begin_counting(0);
  at(Port::kHost).request(TLM_READ_COMMAND, crossbar_address(kPipelined, 0));
  for (std::uint64_t cycle = 0; cycle < 3; ++cycle) {
    EXPECT_EQ(arbitrate(cycle, kLeft), kLeft);
    EXPECT_EQ(crossbar->socket_requests(), kHost);
    EXPECT_TRUE(at(Port::kHost).answers.empty());
  }
  EXPECT_EQ(arbitrate(3), kHost);
  EXPECT_EQ(at(Port::kHost).answers.size(), 1U);
  crossbar->end_counting(4);
  const ArbiterStats stats = crossbar->arbiters()[kPipelined].stats();
  EXPECT_EQ(stats.blame[index_of(Port::kHost)][index_of(Port::kLeftPixel)], 3U);
  EXPECT_EQ(stats.contended_cycles, 3U);
  EXPECT_EQ(stats.grants[index_of(Port::kHost)], 1U);
}

TEST_F(CrossbarSockets, StallAStageThatComesAfterThem) {
  build();
  crossbar->route(Port::kLeftPixel, kPipelined, false);
  crossbar->begin_counting(0);
  at(Port::kHost).request(TLM_READ_COMMAND, crossbar_address(kPipelined, 0));
  EXPECT_EQ(arbitrate(0, kLeft), kHost);
  EXPECT_EQ(at(Port::kLeftPixel).read(crossbar_address(kPipelined, 0)).status,
            tlm::TLM_GENERIC_ERROR_RESPONSE);
  EXPECT_EQ(arbitrate(1, kLeft), kLeft);
  EXPECT_EQ(crossbar->arbiters()[kPipelined].stats().blame[index_of(Port::kLeftPixel)][index_of(Port::kHost)],
            1U);
}

TEST_F(CrossbarSockets, PassAStageOfAnotherBank) {
  build();
  crossbar->route(Port::kLeftPixel, kPipelined, false);
  at(Port::kHost).request(TLM_READ_COMMAND, crossbar_address(kFlowThrough, 0));
  EXPECT_EQ(arbitrate(0, kLeft), static_cast<PortMask>(kLeft | kHost));
}

TEST_F(CrossbarSockets, ContendWithEachOther) {
  build();
  at(Port::kHost).request(TLM_WRITE_COMMAND, crossbar_address(kPipelined, 0), 1);
  at(Port::kResult).request(TLM_WRITE_COMMAND, crossbar_address(kPipelined, 0), 2);
  EXPECT_EQ(arbitrate(0), kHost);
  EXPECT_EQ(banks[kPipelined]->words()[0], 1U);
  EXPECT_EQ(arbitrate(1), mask_of(Port::kResult));
  EXPECT_EQ(banks[kPipelined]->words()[0], 2U);
}

TEST_F(CrossbarSockets, WaitForTheTurnaround) {
  build();
  at(Port::kHost).request(TLM_WRITE_COMMAND, crossbar_address(kBurst, 0), 3);
  ASSERT_EQ(arbitrate(0), kHost);
  at(Port::kHost).request(TLM_READ_COMMAND, crossbar_address(kBurst, 0));
  EXPECT_EQ(arbitrate(1), kNobody);
  EXPECT_EQ(arbitrate(2), kNobody);
  EXPECT_EQ(crossbar->socket_requests(), kHost);
  EXPECT_EQ(arbitrate(3), kHost);
  EXPECT_EQ(at(Port::kHost).answers.back().word, 3U);
  EXPECT_EQ(at(Port::kHost).answers.back().at, cycles(3 + 2));
}

TEST_F(CrossbarSockets, CompleteAtOnceWithAnAddressOutsideEveryBank) {
  build();
  EXPECT_EQ(at(Port::kHost).request(TLM_READ_COMMAND, crossbar_address(3, 0)), tlm::TLM_COMPLETED);
  EXPECT_EQ(at(Port::kHost).answers.back().status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_FALSE(crossbar->request_pending());
}

TEST_F(CrossbarSockets, HandOnTheBanksOwnErrorsAtTheEndOfTheirGrant) {
  build();
  EXPECT_EQ(at(Port::kHost).request(TLM_READ_COMMAND, crossbar_address(kPipelined, kWords)),
            tlm::TLM_ACCEPTED);
  ASSERT_EQ(arbitrate(2), kHost);
  EXPECT_EQ(at(Port::kHost).answers.back().status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
  EXPECT_EQ(at(Port::kHost).answers.back().at, cycles(3));
}

class CrossbarEndings : public CrossbarBench, public testing::WithParamInterface<const char*> {
 protected:
  TestHost::Ending ending() const {
    const std::string name = GetParam();
    return name == "completed" ? TestHost::Ending::kCompleted
           : name == "updated" ? TestHost::Ending::kUpdated
                               : TestHost::Ending::kAccepted;
  }
};

TEST_P(CrossbarEndings, MakeRoomForTheNextRequest) {
  build();
  TestHost& host = at(Port::kHost);
  host.ending = ending();
  for (std::uint64_t cycle = 0; cycle < 3; ++cycle) {
    ASSERT_EQ(host.request(TLM_WRITE_COMMAND, crossbar_address(kPipelined, cycle), 7), tlm::TLM_ACCEPTED);
    ASSERT_EQ(arbitrate(cycle), kHost);
    if (ending() == TestHost::Ending::kAccepted) {
      EXPECT_EQ(host.end_response(), tlm::TLM_COMPLETED);
    }
  }
  EXPECT_EQ(host.answers.size(), 3U);
  EXPECT_EQ(banks[kPipelined]->stats().writes, 3U);
}

INSTANTIATE_TEST_SUITE_P(Crossbar, CrossbarEndings, testing::Values("completed", "updated", "accepted"));

TEST_F(CrossbarSockets, ReportARequestBeforeTheLastOneWasGranted) {
  build();
  at(Port::kHost).request(TLM_READ_COMMAND, crossbar_address(kPipelined, 0));
  ExpectedReport report("/stereotlm/crossbar");
  EXPECT_THROW(at(Port::kHost).request(TLM_READ_COMMAND, crossbar_address(kPipelined, 1)),
               sc_core::sc_report);
  EXPECT_EQ(report.text(), "crossbar: port host: phase out of order");
  EXPECT_EQ(binder.take_violations().size(), 1U);
}

TEST_F(CrossbarSockets, ReportARequestBeforeTheResponseEnded) {
  build();
  TestHost& host = at(Port::kHost);
  host.ending = TestHost::Ending::kAccepted;
  host.request(TLM_READ_COMMAND, crossbar_address(kPipelined, 0));
  ASSERT_EQ(arbitrate(0), kHost);
  ExpectedReport report("/stereotlm/crossbar");
  EXPECT_THROW(host.request(TLM_READ_COMMAND, crossbar_address(kPipelined, 1)), sc_core::sc_report);
}

TEST_F(CrossbarSockets, ReportTheEndOfAResponseThatHasNotBegun) {
  build();
  at(Port::kHost).request(TLM_READ_COMMAND, crossbar_address(kPipelined, 0));
  ExpectedReport report("/stereotlm/crossbar");
  EXPECT_THROW(at(Port::kHost).end_response(), sc_core::sc_report);
  EXPECT_EQ(binder.take_violations().size(), 1U);
}

TEST_F(CrossbarSockets, NotifyTheOwnerAtTheTimeOfTheRequest) {
  build();
  sc_time noticed;
  sc_core::sc_spawn([&] {
    at(Port::kHost).request(TLM_READ_COMMAND, crossbar_address(kPipelined, 0), 0, cycles(3));
    sc_core::wait(crossbar->request_event());
    noticed = sc_core::sc_time_stamp();
  });
  sc_core::sc_start();
  EXPECT_EQ(noticed, cycles(3));
}

}  // namespace
}  // namespace stereotlm::memory
