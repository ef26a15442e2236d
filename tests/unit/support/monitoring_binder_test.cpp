#include "tests/support/monitoring_binder.h"

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <memory>
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

  // A call without streaming width, which is a violation.
  static void violate(ScriptedInitiator& initiator) {
    tlm::tlm_generic_payload payload;
    payload.set_streaming_width(0);
    sc_core::sc_time delay;
    initiator.socket->b_transport(payload, delay);
  }

  ScriptedInitiator left{"left"};
  ScriptedInitiator right{"right"};
  ScriptedTarget left_target{"left_target"};
  ScriptedTarget right_target{"right_target"};
  std::unique_ptr<MonitoringBinder> binder = std::make_unique<MonitoringBinder>();
};

TEST_F(MonitoringBinderTest, PutsAMonitorOfItsOwnIntoEveryLink) {
  ASSERT_EQ(binder->monitors().size(), 2U);
  violate(left);
  EXPECT_EQ(binder->monitor("left").counts().b_transport_calls, 1U);
  EXPECT_EQ(binder->monitor("right").counts().b_transport_calls, 0U);
  EXPECT_THROW(binder->monitor("middle"), std::out_of_range);
  binder->take_violations();
}

TEST_F(MonitoringBinderTest, FailsTheTestWithAViolationThatNobodyTook) {
  violate(right);
  EXPECT_NONFATAL_FAILURE(binder.reset(), "right_monitor at 0 s: b_transport: streaming width = 0");
}

}  // namespace
}  // namespace stereotlm::test
