#include <stdexcept>

#include "tests/unit/support/scripted_link.h"

namespace stereotlm::test {
namespace {

using sc_core::SC_NS;
using sc_core::sc_time;
using Payload = tlm::tlm_generic_payload;

constexpr auto kUnknownCommand = static_cast<tlm::tlm_command>(3);

unsigned char elsewhere[8];
unsigned char half_enabled[4] = {0, 0x0f, 0, 0};

// An initiator that spoils a correct request.
Exchange request(const char* name, const char* violation, const std::function<void(Payload&)>& spoil) {
  return {name, violation, [spoil](ScriptedLink& link) {
            spoil(link.payload);
            link.transport();
          }};
}

// A target that spoils a write with byte enables and a delay of 10 ns.
Exchange answer(const char* name, const char* violation,
                const std::function<void(Payload&, sc_time&)>& spoil) {
  return {name, violation, [spoil](ScriptedLink& link) {
            link.payload.set_write();
            link.payload.set_byte_enable_ptr(link.enables.data());
            link.payload.set_byte_enable_length(4);
            link.delay = sc_time(10, SC_NS);
            link.target_acts(spoil);
            link.transport();
          }};
}
Exchange answer(const char* name, const char* violation, const std::function<void(Payload&)>& spoil) {
  return answer(name, violation, [spoil](Payload& payload, sc_time&) { spoil(payload); });
}
Exchange status(const char* name, const char* violation, int value) {
  return answer(name, violation, [value](Payload& payload) {
    payload.set_response_status(static_cast<tlm::tlm_response_status>(value));
  });
}

class ProtocolMonitorRequest : public ExchangeTest {};
TEST_P(ProtocolMonitorRequest, IsReportedOnce) { expect_its_violation(); }

INSTANTIATE_TEST_SUITE_P(
    With, ProtocolMonitorRequest,
    testing::Values(
        request("UnknownCommand", "command = 3", [](auto& p) { p.set_command(kUnknownCommand); }),
        request("NullDataPointer", "data pointer = null", [](auto& p) { p.set_data_ptr(nullptr); }),
        request("NoDataLength", "data length = 0", [](auto& p) { p.set_data_length(0); }),
        request("PartOfAWord", "data length = 6: must be a multiple", [](auto& p) { p.set_data_length(6); }),
        request("UnalignedAddress", "address = 0x42", [](auto& p) { p.set_address(0x42); }),
        request("NoStreamingWidth", "streaming width = 0", [](auto& p) { p.set_streaming_width(0); }),
        request("StreamingBurst", "streaming width = 4: must be at least the data length, 8",
                [](auto& p) { p.set_streaming_width(4); }),
        request("OddStreamingWidth", "streaming width = 9: must be a multiple",
                [](auto& p) { p.set_streaming_width(9); }),
        request("ByteEnablesWithoutLength", "byte enable length = 0",
                [](auto& p) { p.set_byte_enable_ptr(half_enabled); }),
        request("HalfAByteEnable", "byte enable[1] = 0xf",
                [](auto& p) {
                  p.set_byte_enable_ptr(half_enabled);
                  p.set_byte_enable_length(4);
                }),
        request("FinalStatus", "must be TLM_INCOMPLETE_RESPONSE",
                [](auto& p) { p.set_response_status(tlm::TLM_OK_RESPONSE); }),
        request("DmiHint", "dmi_allowed = true", [](auto& p) { p.set_dmi_allowed(true); }),
        request("FullPayloadOption", "gp_option = 1",
                [](auto& p) { p.set_gp_option(tlm::TLM_FULL_PAYLOAD); })),
    ExchangeTest::name);

class ProtocolMonitorTarget : public ExchangeTest {};
TEST_P(ProtocolMonitorTarget, IsReportedOnce) { expect_its_violation(); }

INSTANTIATE_TEST_SUITE_P(
    That, ProtocolMonitorTarget,
    testing::Values(
        status("LeavesTheStatusIncomplete", "response status = 0", tlm::TLM_INCOMPLETE_RESPONSE),
        status("InventsAStatus", "response status = 2", 2),
        status("InventsAnError", "response status = -6", -6),
        answer("ChangesTheCommand", "command changed", [](auto& p) { p.set_read(); }),
        answer("ChangesTheAddress", "address changed from 0x40 to 0x0", [](auto& p) { p.set_address(0); }),
        answer("ChangesTheDataPointer", "data pointer changed", [](auto& p) { p.set_data_ptr(elsewhere); }),
        answer("ChangesTheDataLength", "data length changed", [](auto& p) { p.set_data_length(4); }),
        answer("ChangesTheStreamingWidth", "streaming width changed",
               [](auto& p) { p.set_streaming_width(12); }),
        answer("ChangesTheByteEnablePointer", "byte enable pointer changed",
               [](auto& p) { p.set_byte_enable_ptr(elsewhere); }),
        answer("ChangesTheByteEnableLength", "byte enable length changed",
               [](auto& p) { p.set_byte_enable_length(8); }),
        answer("ChangesTheWrittenData", "data array of a write changed",
               [](auto& p) { p.get_data_ptr()[7] = 1; }),
        answer("ChangesTheByteEnables", "byte enable array changed",
               [](auto& p) { p.get_byte_enable_ptr()[3] = 0xff; }),
        answer("ChangesTheOption", "gp_option changed",
               [](auto& p) { p.set_gp_option(tlm::TLM_FULL_PAYLOAD_ACCEPTED); }),
        answer("TakesBackTime", "time fell from 10 ns to 9 ns",
               [](auto&, auto& annotated) { annotated = sc_time(9, SC_NS); })),
    ExchangeTest::name);

using ProtocolMonitorBlocking = ScriptedLink;

TEST_F(ProtocolMonitorBlocking, PassesACorrectReadAndItsData) {
  elaborate();
  target_acts([](Payload& received, sc_time& annotated) {
    received.get_data_ptr()[0] = 7;
    received.set_dmi_allowed(true);
    annotated += sc_time(25, SC_NS);
  });
  transport();
  EXPECT_EQ(data[0], 7);
  EXPECT_EQ(delay, sc_time(25, SC_NS));
  EXPECT_TRUE(payload.is_response_ok());
  EXPECT_TRUE(payload.is_dmi_allowed());
  EXPECT_EQ(monitor.counts().b_transport_calls, 1U);
  EXPECT_EQ(monitor.counts().reads, 1U);
  EXPECT_EQ(monitor.counts().writes, 0U);
}

TEST_F(ProtocolMonitorBlocking, PassesACorrectWriteWithByteEnables) {
  elaborate();
  payload.set_write();
  enables[0] = TLM_BYTE_ENABLED;
  payload.set_byte_enable_ptr(enables.data());
  payload.set_byte_enable_length(4);
  transport();
  EXPECT_EQ(monitor.counts().reads, 0U);
  EXPECT_EQ(monitor.counts().writes, 1U);
}

TEST_F(ProtocolMonitorBlocking, PassesEveryErrorResponse) {
  elaborate();
  for (int status = tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE; status < 0; ++status) {
    payload.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
    target_acts([status](Payload& received, sc_time&) {
      received.set_response_status(static_cast<tlm::tlm_response_status>(status));
    });
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

TEST_F(ProtocolMonitorBlocking, PassesATargetThatWaitsForTheDelay) {
  target_acts([](Payload&, sc_time& annotated) {
    sc_core::wait(annotated + sc_time(5, SC_NS));
    annotated = sc_core::SC_ZERO_TIME;
  });
  delay = sc_time(10, SC_NS);
  simulate([this] { transport(); });
  EXPECT_EQ(sc_core::sc_time_stamp(), sc_time(15, SC_NS));
  EXPECT_EQ(delay, sc_core::SC_ZERO_TIME);
}

TEST_F(ProtocolMonitorBlocking, CatchesATargetThatWaitsForLessThanItTakesOffTheDelay) {
  target_acts([](Payload&, sc_time& annotated) {
    sc_core::wait(sc_time(9, SC_NS));
    annotated = sc_core::SC_ZERO_TIME;
  });
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
  const auto correct = target.on_blocking;
  target.on_blocking = [](Payload&, sc_time&) { throw std::runtime_error("broken target"); };
  EXPECT_THROW(transport(), std::runtime_error);
  target.on_blocking = correct;
  transport();
}

TEST_F(ProtocolMonitorBlocking, CatchesAManagedTransactionThatNobodyAcquired) {
  elaborate();
  payload.set_mm(&manager);
  transport();
  expect_only("reference count = 0");
  EXPECT_EQ(manager.frees, 0);
}

TEST_F(ProtocolMonitorBlocking, LeavesTheReferenceCountAsItWas) {
  elaborate();
  manage();
  transport();
  EXPECT_EQ(payload.get_ref_count(), 1);
  EXPECT_EQ(manager.frees, 0);
}

TEST_F(ProtocolMonitorBlocking, CatchesATargetThatReleasesMoreThanItAcquired) {
  elaborate();
  manage();
  target_acts([](Payload& received, sc_time&) { received.release(); });
  transport();
  expect_only("reference count fell");
}

// A link with all three options.
class ProtocolMonitorBytes : public ScriptedLink {
 protected:
  ProtocolMonitorBytes() : ScriptedLink({false, true, true}) {}
};

TEST_F(ProtocolMonitorBytes, PassesPartsOfWordsStreamingBurstsAndTranslatedAddresses) {
  elaborate();
  payload.set_address(0x43);
  payload.set_data_length(3);
  payload.set_streaming_width(1);
  target_acts([](Payload& received, sc_time&) { received.set_address(0); });
  transport();
}

TEST_F(ProtocolMonitorBytes, StillRefusesAStreamingWidthOfZero) {
  elaborate();
  payload.set_streaming_width(0);
  transport();
  expect_only("streaming width = 0: must be positive");
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

}  // namespace
}  // namespace stereotlm::test
