#include <gtest/gtest-spi.h>

#include <ostream>
#include <stdexcept>

#include "tests/unit/support/scripted_link.h"

namespace stereotlm::test {
namespace {

using sc_core::SC_NS;
using sc_core::sc_time;
using Payload = tlm::tlm_generic_payload;

// A wrong initiator: one field of a correct request is spoiled.

struct WrongRequest {
  const char* name;
  std::function<void(Payload&, unsigned char* enables)> spoil;
  const char* violation;
  friend void PrintTo(const WrongRequest& wrong, std::ostream* out) { *out << wrong.name; }
};

class ProtocolMonitorRequest : public ScriptedLink, public testing::WithParamInterface<WrongRequest> {};

TEST_P(ProtocolMonitorRequest, IsRefused) {
  elaborate();
  GetParam().spoil(payload, enables.data());
  transport();
  expect_only(GetParam().violation);
}

INSTANTIATE_TEST_SUITE_P(
    With, ProtocolMonitorRequest,
    testing::Values(
        WrongRequest{"UnknownCommand",
                     [](auto& p, auto*) { p.set_command(static_cast<tlm::tlm_command>(3)); }, "command = 3"},
        WrongRequest{"NullDataPointer", [](auto& p, auto*) { p.set_data_ptr(nullptr); },
                     "data pointer = null"},
        WrongRequest{"NoDataLength", [](auto& p, auto*) { p.set_data_length(0); }, "data length = 0"},
        WrongRequest{"PartOfAWord", [](auto& p, auto*) { p.set_data_length(6); },
                     "data length = 6: must be a multiple"},
        WrongRequest{"UnalignedAddress", [](auto& p, auto*) { p.set_address(0x42); }, "address = 0x42"},
        WrongRequest{"NoStreamingWidth", [](auto& p, auto*) { p.set_streaming_width(0); },
                     "streaming width = 0"},
        WrongRequest{"UnmeantStreamingBurst", [](auto& p, auto*) { p.set_streaming_width(4); },
                     "streaming width = 4: must be at least the data length, 8"},
        WrongRequest{"OddStreamingWidth", [](auto& p, auto*) { p.set_streaming_width(9); },
                     "streaming width = 9: must be a multiple"},
        WrongRequest{"ByteEnablesWithoutLength",
                     [](auto& p, auto* enables) { p.set_byte_enable_ptr(enables); },
                     "byte enable length = 0"},
        WrongRequest{"HalfAByteEnable",
                     [](auto& p, auto* enables) {
                       enables[1] = 0x0f;
                       p.set_byte_enable_ptr(enables);
                       p.set_byte_enable_length(4);
                     },
                     "byte enable[1] = 0xf"},
        WrongRequest{"FinalStatus", [](auto& p, auto*) { p.set_response_status(tlm::TLM_OK_RESPONSE); },
                     "must be TLM_INCOMPLETE_RESPONSE"},
        WrongRequest{"DmiHint", [](auto& p, auto*) { p.set_dmi_allowed(true); }, "dmi_allowed = true"},
        WrongRequest{"FullPayloadOption", [](auto& p, auto*) { p.set_gp_option(tlm::TLM_FULL_PAYLOAD); },
                     "gp_option = 1"}),
    [](const auto& tested) { return std::string(tested.param.name); });

// A wrong target: it changes what it must leave alone.

struct WrongTarget {
  const char* name;
  std::function<void(Payload&, sc_time&)> spoil;
  const char* violation;
  friend void PrintTo(const WrongTarget& wrong, std::ostream* out) { *out << wrong.name; }
};

class ProtocolMonitorTarget : public ScriptedLink, public testing::WithParamInterface<WrongTarget> {};

TEST_P(ProtocolMonitorTarget, IsCaught) {
  elaborate();
  payload.set_write();
  payload.set_byte_enable_ptr(enables.data());
  payload.set_byte_enable_length(4);
  delay = sc_time(10, SC_NS);
  target.on_blocking = [&](Payload& received, sc_time& annotated) {
    received.set_response_status(tlm::TLM_OK_RESPONSE);
    GetParam().spoil(received, annotated);
  };
  transport();
  expect_only(GetParam().violation);
}

unsigned char elsewhere[8];

INSTANTIATE_TEST_SUITE_P(
    That, ProtocolMonitorTarget,
    testing::Values(
        WrongTarget{"LeavesTheStatusIncomplete",
                    [](auto& p, auto&) { p.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE); },
                    "response status = 0"},
        WrongTarget{"InventsAStatus",
                    [](auto& p, auto&) { p.set_response_status(static_cast<tlm::tlm_response_status>(2)); },
                    "response status = 2"},
        WrongTarget{"InventsAnError",
                    [](auto& p, auto&) { p.set_response_status(static_cast<tlm::tlm_response_status>(-6)); },
                    "response status = -6"},
        WrongTarget{"ChangesTheCommand", [](auto& p, auto&) { p.set_read(); }, "command changed"},
        WrongTarget{"ChangesTheAddress", [](auto& p, auto&) { p.set_address(0); },
                    "address changed from 0x40 to 0x0"},
        WrongTarget{"ChangesTheDataPointer", [](auto& p, auto&) { p.set_data_ptr(elsewhere); },
                    "data pointer changed"},
        WrongTarget{"ChangesTheDataLength", [](auto& p, auto&) { p.set_data_length(4); },
                    "data length changed"},
        WrongTarget{"ChangesTheStreamingWidth", [](auto& p, auto&) { p.set_streaming_width(12); },
                    "streaming width changed"},
        WrongTarget{"ChangesTheByteEnablePointer", [](auto& p, auto&) { p.set_byte_enable_ptr(elsewhere); },
                    "byte enable pointer changed"},
        WrongTarget{"ChangesTheByteEnableLength", [](auto& p, auto&) { p.set_byte_enable_length(8); },
                    "byte enable length changed"},
        WrongTarget{"ChangesTheWrittenData", [](auto& p, auto&) { p.get_data_ptr()[7] = 1; },
                    "data array of a write changed"},
        WrongTarget{"ChangesTheByteEnables", [](auto& p, auto&) { p.get_byte_enable_ptr()[3] = 0xff; },
                    "byte enable array changed"},
        WrongTarget{"ChangesTheOption",
                    [](auto& p, auto&) { p.set_gp_option(tlm::TLM_FULL_PAYLOAD_ACCEPTED); },
                    "gp_option changed"},
        WrongTarget{"TakesBackTime", [](auto&, auto& annotated) { annotated = sc_time(9, SC_NS); },
                    "time fell from 10 ns to 9 ns"}),
    [](const auto& tested) { return std::string(tested.param.name); });

// What is right passes.

using ProtocolMonitorBlocking = ScriptedLink;

TEST_F(ProtocolMonitorBlocking, PassesACorrectReadAndItsData) {
  elaborate();
  target.on_blocking = [](Payload& received, sc_time& annotated) {
    received.get_data_ptr()[0] = 7;
    received.set_dmi_allowed(true);
    received.set_response_status(tlm::TLM_OK_RESPONSE);
    annotated += sc_time(25, SC_NS);
  };
  transport();
  EXPECT_EQ(data[0], 7);
  EXPECT_EQ(delay, sc_time(25, SC_NS));
  EXPECT_TRUE(payload.is_response_ok());
  EXPECT_TRUE(payload.is_dmi_allowed());
}

TEST_F(ProtocolMonitorBlocking, PassesACorrectWriteWithByteEnables) {
  elaborate();
  payload.set_write();
  enables[0] = TLM_BYTE_ENABLED;
  payload.set_byte_enable_ptr(enables.data());
  payload.set_byte_enable_length(4);
  transport();
}

TEST_F(ProtocolMonitorBlocking, PassesEveryErrorResponse) {
  elaborate();
  for (int status = tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE; status < 0; ++status) {
    payload.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
    target.on_blocking = [status](Payload& received, sc_time&) {
      received.set_response_status(static_cast<tlm::tlm_response_status>(status));
    };
    transport();
    EXPECT_EQ(payload.get_response_status(), status);
  }
}

TEST_F(ProtocolMonitorBlocking, PassesAnIgnoreCommandWithoutData) {
  elaborate();
  payload.set_command(tlm::TLM_IGNORE_COMMAND);
  payload.set_data_ptr(nullptr);
  payload.set_data_length(0);
  payload.set_address(3);
  transport();
}

TEST_F(ProtocolMonitorBlocking, PassesAStreamingWidthAboveTheDataLength) {
  elaborate();
  payload.set_streaming_width(12);
  transport();
}

TEST_F(ProtocolMonitorBlocking, PassesATargetThatWaitsTheDelayAway) {
  target.on_blocking = [](Payload& received, sc_time& annotated) {
    sc_core::wait(annotated + sc_time(5, SC_NS));
    annotated = sc_core::SC_ZERO_TIME;
    received.set_response_status(tlm::TLM_OK_RESPONSE);
  };
  delay = sc_time(10, SC_NS);
  simulate([this] { transport(); });
  EXPECT_EQ(sc_core::sc_time_stamp(), sc_time(15, SC_NS));
  EXPECT_EQ(delay, sc_core::SC_ZERO_TIME);
}

TEST_F(ProtocolMonitorBlocking, CatchesATargetThatWaitsForLessThanItTakesOffTheDelay) {
  target.on_blocking = [](Payload& received, sc_time& annotated) {
    sc_core::wait(sc_time(9, SC_NS));
    annotated = sc_core::SC_ZERO_TIME;
    received.set_response_status(tlm::TLM_OK_RESPONSE);
  };
  delay = sc_time(10, SC_NS);
  simulate([this] { transport(); });
  expect_only("time fell from 10 ns to 9 ns");
}

TEST_F(ProtocolMonitorBlocking, CatchesACallFromAMethodProcess) {
  sc_core::sc_spawn_options options;
  options.spawn_method();
  sc_core::sc_spawn([this] { transport(); }, "method", &options);
  sc_core::sc_start();
  expect_only("called from a method process");
}

TEST_F(ProtocolMonitorBlocking, CatchesAReentrantUseOfTheSameTransaction) {
  bool again = true;
  target.on_blocking = [&](Payload& received, sc_time&) {
    if (again) {
      again = false;
      transport();
      received.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
    }
    received.set_response_status(tlm::TLM_OK_RESPONSE);
  };
  elaborate();
  transport();
  expect_only("already in progress");
}

TEST_F(ProtocolMonitorBlocking, ForgetsATransactionWhoseTargetThrew) {
  elaborate();
  const auto answer = target.on_blocking;
  target.on_blocking = [](Payload&, sc_time&) { throw std::runtime_error("broken target"); };
  EXPECT_THROW(transport(), std::runtime_error);
  target.on_blocking = answer;
  transport();
}

TEST_F(ProtocolMonitorBlocking, CatchesAManagedTransactionThatNobodyAcquired) {
  elaborate();
  CountingManager manager;
  payload.set_mm(&manager);
  transport();
  expect_only("reference count = 0");
  EXPECT_EQ(manager.frees, 0);
}

TEST_F(ProtocolMonitorBlocking, LeavesTheReferenceCountAsItWas) {
  elaborate();
  CountingManager manager;
  payload.set_mm(&manager);
  payload.acquire();
  transport();
  EXPECT_EQ(payload.get_ref_count(), 1);
  EXPECT_EQ(manager.frees, 0);
}

TEST_F(ProtocolMonitorBlocking, CatchesATargetThatReleasesMoreThanItAcquired) {
  elaborate();
  CountingManager manager;
  payload.set_mm(&manager);
  payload.acquire();
  target.on_blocking = [](Payload& received, sc_time&) {
    received.release();
    received.set_response_status(tlm::TLM_OK_RESPONSE);
  };
  transport();
  expect_only("reference count fell");
}

// Options.

class ProtocolMonitorBytes : public ScriptedLink {
 protected:
  ProtocolMonitorBytes() : ScriptedLink({false, true, true}) {}
};

TEST_F(ProtocolMonitorBytes, PassesPartsOfWordsWhereTheyAreMeant) {
  elaborate();
  payload.set_address(0x43);
  payload.set_data_length(3);
  payload.set_streaming_width(3);
  transport();
}

TEST_F(ProtocolMonitorBytes, PassesStreamingBurstsWhereTheyAreMeant) {
  elaborate();
  payload.set_streaming_width(1);
  transport();
}

TEST_F(ProtocolMonitorBytes, LetsAnInterconnectTranslateTheAddress) {
  elaborate();
  target.on_blocking = [](Payload& received, sc_time&) {
    received.set_address(0);
    received.set_response_status(tlm::TLM_OK_RESPONSE);
  };
  transport();
}

TEST_F(ProtocolMonitorBytes, StillRefusesAStreamingWidthOfZero) {
  elaborate();
  payload.set_streaming_width(0);
  transport();
  expect_only("streaming width = 0: must be positive");
}

// Counting and reporting.

TEST_F(ProtocolMonitorBlocking, CountsReadsAndWrites) {
  elaborate();
  for (int i = 0; i < 3; ++i) {
    payload.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
    payload.set_command(i == 0 ? tlm::TLM_WRITE_COMMAND : tlm::TLM_READ_COMMAND);
    transport();
  }
  EXPECT_EQ(monitor.counts().b_transport_calls, 3U);
  EXPECT_EQ(monitor.counts().reads, 2U);
  EXPECT_EQ(monitor.counts().writes, 1U);
}

TEST_F(ProtocolMonitorBlocking, SaysWhereWhenAndWhat) {
  simulate([this] {
    sc_core::wait(sc_time(30, SC_NS));
    payload.set_address(0x41);
    transport();
  });
  expect_only("monitor at 30 ns: b_transport: address = 0x41: must be 4-aligned on this link");
}

TEST_F(ProtocolMonitorBlocking, KeepsAHundredViolationsAndCountsTheOthers) {
  elaborate();
  payload.set_address(0x41);
  for (int i = 0; i < 103; ++i) {
    payload.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
    transport();
  }
  const auto violations = monitor.take_violations();
  ASSERT_EQ(violations.size(), 101U);
  EXPECT_EQ(violations.back(), "monitor: 3 more violations");
  EXPECT_TRUE(monitor.take_violations().empty());
}

TEST(ProtocolMonitor, FailsTheTestWithWhatIsLeftWhenItIsDestroyed) {
  ScriptedInitiator initiator("initiator");
  ScriptedTarget target("target");
  auto monitor = std::make_unique<ProtocolMonitor>("monitor");
  initiator.socket.bind(monitor->from_initiator);
  monitor->to_target.bind(target.socket);
  sc_core::sc_start(sc_core::SC_ZERO_TIME);
  tlm::tlm_generic_payload payload;
  payload.set_command(tlm::TLM_IGNORE_COMMAND);
  payload.set_streaming_width(0);
  sc_core::sc_time delay;
  initiator.socket->b_transport(payload, delay);
  EXPECT_NONFATAL_FAILURE(monitor.reset(), "streaming width = 0");
}

}  // namespace
}  // namespace stereotlm::test
