#include "tests/support/monitoring_binder.h"

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/unit/support/scripted_link.h"

namespace stereotlm::test {
namespace {

class MonitoringBinderTest : public testing::Test {
 protected:
  MonitoringBinderTest() {
    binder->bind(left.socket, left_target.socket, "left");
    binder->bind(right.socket, right_target.socket, "right");
    sc_core::sc_start(sc_core::SC_ZERO_TIME);
  }

  static void send(ScriptedInitiator& initiator, unsigned int streaming_width) {
    tlm::tlm_generic_payload payload;
    payload.set_command(tlm::TLM_IGNORE_COMMAND);
    payload.set_streaming_width(streaming_width);
    sc_core::sc_time delay;
    initiator.socket->b_transport(payload, delay);
  }

  ScriptedInitiator left{"left"};
  ScriptedInitiator right{"right"};
  ScriptedTarget left_target{"left_target"};
  ScriptedTarget right_target{"right_target"};
  std::unique_ptr<MonitoringBinder> binder = std::make_unique<MonitoringBinder>();
};

TEST_F(MonitoringBinderTest, PutsAMonitorNamedForItIntoEveryLink) {
  ASSERT_EQ(binder->monitors().size(), 2U);
  EXPECT_STREQ(binder->monitors()[0]->name(), "left_monitor");
  EXPECT_STREQ(binder->monitors()[1]->name(), "right_monitor");
  EXPECT_EQ(&binder->monitor("right"), binder->monitors()[1].get());
}

TEST_F(MonitoringBinderTest, LeadsEachLinkThroughItsOwnMonitor) {
  send(left, 4);
  EXPECT_EQ(binder->monitor("left").counts().b_transport_calls, 1U);
  EXPECT_EQ(binder->monitor("right").counts().b_transport_calls, 0U);
}

TEST_F(MonitoringBinderTest, RefusesALinkThatItDoesNotKnow) {
  EXPECT_THROW(binder->monitor("middle"), std::out_of_range);
}

TEST_F(MonitoringBinderTest, CollectsTheViolationsOfAllLinks) {
  send(left, 0);
  send(right, 0);
  EXPECT_EQ(binder->violations().size(), 2U);
  EXPECT_EQ(binder->take_violations().size(), 2U);
  EXPECT_TRUE(binder->violations().empty());
}

TEST_F(MonitoringBinderTest, FailsTheTestWithAViolationThatNobodyTook) {
  send(right, 0);
  EXPECT_NONFATAL_FAILURE(binder.reset(), "right_monitor at 0 s: b_transport: streaming width = 0");
}

}  // namespace
}  // namespace stereotlm::test
