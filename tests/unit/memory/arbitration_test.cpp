// Routes of ports. The random boards and computers compare grants and counts with the plain core.
#include "models/memory/arbitration.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "models/memory/arbitration_policies.h"
#include "models/memory/bank_arbiter.h"
#include "tests/unit/memory/ports.h"

namespace stereotlm::memory {
namespace {

// A read of a bank with separate ports waits for the read that is granted, not for the write beside it.
TEST(Arbitration, BlamesAPortOfTheSameDirectionOfABankWithSeparatePorts) {
  for (const bool write : {false, true}) {
    Arbitration arbitration({"fixed_priority", {0, 1, 2}}, {{16, BankKind::kQdr}});
    arbitration.route(0, 0, !write);
    arbitration.route(1, 0, write);
    arbitration.route(2, 0, write);
    const PortMask granted = arbitration.arbitrate(0, mask_of(0) | mask_of(1) | mask_of(2));
    EXPECT_EQ(granted, mask_of(0) | mask_of(1));
    EXPECT_EQ(arbitration.cause_of(2, granted), 1U);
  }
}

TEST(Arbitration, RoutesNoPortThatIsNotInThePriorityListAndNoneToABankThatDoesNotExist) {
  Arbitration arbitration({"fixed_priority", {1, 0}}, {{16}, {16}, {16}});
  const auto refusal = [](const auto& call) -> std::string {
    try {
      call();
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "none";
  };
  const std::string no_port = "port = 2: must be 0..1";
  const std::string no_bank = "bank = 9: must be 0..2";
  EXPECT_EQ(refusal([&] { arbitration.route(2, 0, false); }), no_port);
  EXPECT_EQ(refusal([&] { arbitration.visit(2, 0, false); }), no_port);
  EXPECT_EQ(refusal([&] { arbitration.unroute(2); }), no_port);
  EXPECT_EQ(refusal([&] { arbitration.route(0, 9, false); }), no_bank);
  EXPECT_EQ(refusal([&] { arbitration.visit(0, 9, false); }), no_bank);
  EXPECT_EQ(refusal([&] { arbitration.route(1, 2, true); }), "none");
}

TEST(Arbitration, GrantsNothingToAPortThatIsUnrouted) {
  Arbitration arbitration(kFixedPriority, {{16}});
  arbitration.route(port::kLeftPixel, 0, false);
  arbitration.route(port::kRightPixel, 0, false);
  arbitration.unroute(port::kLeftPixel);
  EXPECT_EQ(arbitration.arbitrate(0, kLeft | kRight), kRight);
}

TEST(BankArbiter, RefusesARequestOfAPortThatIsNotInThePriorityList) {
  for (const ArbitrationPolicy& policy : arbitration_policies()) {
    BankArbiter arbiter({policy.name, {1, 0}}, {16});
    EXPECT_EQ(arbiter.decide(0, 0b01, 0).granted, 0b01);
    EXPECT_THROW(arbiter.decide(1, 0b100, 0), std::invalid_argument);
    EXPECT_THROW(arbiter.decide(1, 0b101, 0), std::invalid_argument);
    EXPECT_THROW(arbiter.decide(1, 0, 0), std::invalid_argument);
    EXPECT_EQ(arbiter.decide(1, 0b10, 0).granted, 0b10);
  }
}

TEST(BankArbiter, RefusesAConfigurationWithProblems) {
  EXPECT_THROW(BankArbiter(arbiter_of("lottery"), {}), std::invalid_argument);
  EXPECT_THROW(BankArbiter(kFixedPriority, {16, BankKind::kQdr, 1}), std::invalid_argument);
}

TEST(BankArbiter, CountsACycleThatIsContendedInBothDirectionsOnce) {
  BankArbiter arbiter({"fixed_priority", {0, 1, 2, 3}}, {16, BankKind::kQdr});
  arbiter.begin_counting(0);
  arbiter.count(arbiter.decide(0, 0b1111, 0b0011));
  arbiter.end_counting(1);
  EXPECT_EQ(arbiter.stats().contended_cycles(), 1U);
}

}  // namespace
}  // namespace stereotlm::memory
