#include <limits>

#include "tests/unit/support/scripted_link.h"

namespace stereotlm::test {
namespace {

using sc_core::SC_NS;
using sc_core::sc_time;
using Payload = tlm::tlm_generic_payload;

class ProtocolMonitorDmi : public ScriptedLink {
 protected:
  // What the target grants for the next request: 0x0..0x7f, readable, until a test spoils it.
  void answer(
      const std::function<void(tlm::tlm_dmi&)>& spoil = [](auto&) {}, bool granted = true) {
    target.on_dmi = [this, spoil, granted](Payload&, tlm::tlm_dmi& given) {
      given.set_dmi_ptr(data.data());
      given.set_start_address(0);
      given.set_end_address(0x7f);
      given.allow_read();
      spoil(given);
      return granted;
    };
  }
  bool request() { return initiator.socket->get_direct_mem_ptr(payload, dmi); }

  tlm::tlm_dmi dmi;
};

TEST_F(ProtocolMonitorDmi, PassesACorrectGrant) {
  elaborate();
  answer();
  EXPECT_TRUE(request());
  EXPECT_EQ(dmi.get_dmi_ptr(), data.data());
  EXPECT_EQ(monitor.counts().dmi_requests, 1U);
  EXPECT_EQ(monitor.counts().dmi_grants, 1U);
}

TEST_F(ProtocolMonitorDmi, PassesARefusalWithAnUntouchedDescriptor) {
  elaborate();
  EXPECT_FALSE(request());
  EXPECT_EQ(monitor.counts().dmi_requests, 1U);
  EXPECT_EQ(monitor.counts().dmi_grants, 0U);
}

TEST_F(ProtocolMonitorDmi, PassesRangesThatBeginOrEndAtTheAddress) {
  elaborate();
  answer([](auto& given) { given.set_start_address(0x40); });
  EXPECT_TRUE(request());
  dmi.init();
  answer([](auto& given) { given.set_end_address(0x40); });
  EXPECT_TRUE(request());
}

TEST_F(ProtocolMonitorDmi, CatchesARangeThatBeginsAfterTheAddress) {
  elaborate();
  answer([](auto& given) { given.set_start_address(0x41); });
  request();
  expect_only("DMI range = 0x41..0x7f: must contain the requested address 0x40");
}

TEST_F(ProtocolMonitorDmi, CatchesARangeThatEndsBeforeTheAddress) {
  elaborate();
  answer([](auto& given) { given.set_end_address(0x3f); });
  request();
  expect_only("DMI range = 0x0..0x3f: must contain the requested address 0x40");
}

TEST_F(ProtocolMonitorDmi, CatchesARangeThatEndsBeforeItStarts) {
  elaborate();
  answer([](auto& given) { given.set_start_address(0x80); });
  request();
  expect_only("DMI range = 0x80..0x7f: must not end before it starts");
}

TEST_F(ProtocolMonitorDmi, CatchesARefusalForAnotherRange) {
  elaborate();
  answer([](auto& given) { given.set_start_address(0x44); }, false);
  request();
  expect_only("must contain the requested address");
}

TEST_F(ProtocolMonitorDmi, CatchesANullPointerThatIsGranted) {
  elaborate();
  answer([](auto& given) { given.set_dmi_ptr(nullptr); });
  request();
  expect_only("DMI pointer = null");
}

TEST_F(ProtocolMonitorDmi, CatchesAGrantOfTheOtherAccess) {
  elaborate();
  answer();
  payload.set_write();
  request();
  expect_only("granted access = 1: must include the requested one");
}

TEST_F(ProtocolMonitorDmi, PassesAWriteGrantForAWrite) {
  elaborate();
  answer([](auto& given) { given.allow_read_write(); });
  payload.set_write();
  EXPECT_TRUE(request());
}

TEST_F(ProtocolMonitorDmi, CatchesARequestWithAUsedDescriptor) {
  elaborate();
  answer();
  dmi.set_end_address(0x7f);
  request();
  expect_only("DMI descriptor: must be as after init()");
}

TEST_F(ProtocolMonitorDmi, CatchesARequestThatIsNeitherReadNorWrite) {
  elaborate();
  payload.set_command(tlm::TLM_IGNORE_COMMAND);
  request();
  expect_only("command = 2: must be read or write in a DMI request");
}

TEST_F(ProtocolMonitorDmi, CatchesARequestThatClaimsTheTargetsAnswer) {
  elaborate();
  payload.set_gp_option(tlm::TLM_FULL_PAYLOAD_ACCEPTED);
  request();
  expect_only("gp_option = 2");
}

TEST_F(ProtocolMonitorDmi, PassesAnOptionThatTheTargetAccepts) {
  elaborate();
  payload.set_gp_option(tlm::TLM_FULL_PAYLOAD);
  target.on_dmi = [](Payload& received, tlm::tlm_dmi&) {
    received.set_gp_option(tlm::TLM_FULL_PAYLOAD_ACCEPTED);
    return false;
  };
  request();
}

TEST_F(ProtocolMonitorDmi, CatchesATargetThatChangesTheAddress) {
  elaborate();
  target.on_dmi = [](Payload& received, tlm::tlm_dmi&) {
    received.set_address(0);
    return false;
  };
  request();
  expect_only("address changed");
}

TEST_F(ProtocolMonitorDmi, CatchesATargetThatWaits) {
  target.on_dmi = [](Payload&, tlm::tlm_dmi&) {
    sc_core::wait(sc_core::SC_ZERO_TIME);
    return false;
  };
  simulate([this] { request(); });
  expect_only("get_direct_mem_ptr: time passed");
}

TEST_F(ProtocolMonitorDmi, PassesAnInvalidationOnToTheInitiator) {
  elaborate();
  target.socket->invalidate_direct_mem_ptr(0, std::numeric_limits<sc_dt::uint64>::max());
  target.socket->invalidate_direct_mem_ptr(5, 5);
  EXPECT_EQ(initiator.invalidations, 2);
  EXPECT_EQ(monitor.counts().dmi_invalidations, 2U);
}

TEST_F(ProtocolMonitorDmi, CatchesAnInvalidationThatEndsBeforeItStarts) {
  elaborate();
  target.socket->invalidate_direct_mem_ptr(6, 5);
  expect_only("the range ends before it starts");
}

class ProtocolMonitorDebug : public ScriptedLink {
 protected:
  unsigned int request() { return initiator.socket->transport_dbg(payload); }
};

TEST_F(ProtocolMonitorDebug, PassesAnyNumberOfBytesUpToTheLength) {
  elaborate();
  for (const unsigned int bytes : {0U, 3U, 8U}) {
    target.on_debug = [bytes](auto&) { return bytes; };
    EXPECT_EQ(request(), bytes);
  }
  EXPECT_EQ(monitor.counts().debug_calls, 3U);
}

TEST_F(ProtocolMonitorDebug, CatchesMoreBytesThanTheLength) {
  elaborate();
  target.on_debug = [](auto&) { return 9U; };
  request();
  expect_only("returned count = 9: must not exceed the data length, 8");
}

TEST_F(ProtocolMonitorDebug, PassesAnUnalignedPartOfAWord) {
  elaborate();
  payload.set_address(0x41);
  payload.set_data_length(3);
  EXPECT_EQ(request(), 3U);
}

TEST_F(ProtocolMonitorDebug, PassesANullPointerForNoBytes) {
  elaborate();
  payload.set_data_ptr(nullptr);
  payload.set_data_length(0);
  EXPECT_EQ(request(), 0U);
}

TEST_F(ProtocolMonitorDebug, CatchesANullPointerForBytes) {
  elaborate();
  payload.set_data_ptr(nullptr);
  request();
  expect_only("data pointer = null");
}

TEST_F(ProtocolMonitorDebug, CatchesAnUnknownCommand) {
  elaborate();
  payload.set_command(static_cast<tlm::tlm_command>(3));
  request();
  expect_only("command = 3");
}

TEST_F(ProtocolMonitorDebug, CatchesARequestThatClaimsTheTargetsAnswer) {
  elaborate();
  payload.set_gp_option(tlm::TLM_FULL_PAYLOAD_ACCEPTED);
  request();
  expect_only("gp_option = 2");
}

TEST_F(ProtocolMonitorDebug, CatchesATargetThatChangesTheWrittenData) {
  elaborate();
  payload.set_write();
  target.on_debug = [](Payload& received) {
    received.get_data_ptr()[0] = 1;
    return 8U;
  };
  request();
  expect_only("data array of a write changed");
}

TEST_F(ProtocolMonitorDebug, CatchesATargetThatWaits) {
  target.on_debug = [](auto&) {
    sc_core::wait(sc_time(1, SC_NS));
    return 8U;
  };
  simulate([this] { request(); });
  expect_only("transport_dbg: time passed");
}

}  // namespace
}  // namespace stereotlm::test
