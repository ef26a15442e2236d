#include <limits>

#include "tests/unit/support/scripted_link.h"

// DMI and debug transport under a monitor.
namespace stereotlm::test {
namespace {

using Payload = tlm::tlm_generic_payload;

class ProtocolMonitorDirect : public ExchangeTest {};
TEST_P(ProtocolMonitorDirect, GivesItsViolationAndNoOther) { expect_its_violation(); }

// A DMI request for 0x40 that the target answers with the spoiled range.
Exchange dmi(const char* name, const char* violation, bool granted,
             const std::function<void(tlm::tlm_dmi&)>& spoil) {
  return {name, violation, [=](ScriptedLink& link) {
            link.target_grants(spoil, granted);
            EXPECT_EQ(link.request_dmi(), granted);
            EXPECT_EQ(link.monitor.counts().dmi_requests, 1U);
            EXPECT_EQ(link.monitor.counts().dmi_grants, granted ? 1U : 0U);
          }};
}

// A DMI request on a spoiled link.
Exchange dmi_request(const char* name, const char* violation,
                     const std::function<void(ScriptedLink&)>& spoil) {
  return {name, violation, [=](ScriptedLink& link) {
            link.target_grants();
            spoil(link);
            link.request_dmi();
          }};
}

INSTANTIATE_TEST_SUITE_P(
    Dmi, ProtocolMonitorDirect,
    testing::Values(
        dmi("Grant", nullptr, true, [](auto&) {}), dmi("Refusal", nullptr, false, [](auto&) {}),
        dmi("RangeFromTheAddressOn", nullptr, true, [](auto& given) { given.set_start_address(0x40); }),
        dmi("RangeUpToTheAddress", nullptr, true, [](auto& given) { given.set_end_address(0x40); }),
        dmi("RangeBehindTheAddress", "DMI range = 0x41..0x7f: must contain the requested address 0x40", true,
            [](auto& given) { given.set_start_address(0x41); }),
        dmi("RangeBeforeTheAddress", "DMI range = 0x0..0x3f: must contain the requested address 0x40", true,
            [](auto& given) { given.set_end_address(0x3f); }),
        dmi("RangeThatEndsBeforeItStarts", "DMI range = 0x80..0x7f: must not end before it starts", true,
            [](auto& given) { given.set_start_address(0x80); }),
        dmi("RefusalOfAnotherRange", "must contain the requested address", false,
            [](auto& given) { given.set_start_address(0x44); }),
        dmi("NullPointer", "DMI pointer = null", true, [](auto& given) { given.set_dmi_ptr(nullptr); }),
        dmi_request("WriteOfAReadGrant", "granted access = 1: must include the requested one",
                    [](auto& link) { link.payload.set_write(); }),
        dmi_request("UsedDescriptor", "DMI descriptor: must be as after init()",
                    [](auto& link) { link.dmi.set_end_address(0x7f); }),
        dmi_request("NeitherReadNorWrite", "command = 2: must be read or write in a DMI request",
                    [](auto& link) {
                      link.payload.set_command(tlm::TLM_IGNORE_COMMAND);
                      link.target_grants([](auto& given) { given.allow_read_write(); });
                    }),
        dmi_request("TheTargetsOption", "gp_option = 2",
                    [](auto& link) { link.payload.set_gp_option(tlm::TLM_FULL_PAYLOAD_ACCEPTED); }),
        dmi_request("ChangedAddress", "address changed",
                    [](auto& link) {
                      link.target.on_dmi = [](Payload& received, auto&) {
                        received.set_address(0);
                        return false;
                      };
                    }),
        Exchange{"TargetThatWaits", "get_direct_mem_ptr: time passed",
                 [](auto& link) {
                   link.target.on_dmi = [](auto&, auto&) {
                     sc_core::wait(sc_core::SC_ZERO_TIME);
                     return false;
                   };
                   link.simulate([&link] { link.request_dmi(); });
                 }},
        Exchange{"InvalidationThatEndsBeforeItStarts", "the range ends before it starts",
                 [](auto& link) { link.target.socket->invalidate_direct_mem_ptr(6, 5); }}),
    ExchangeTest::name);

// A debug call on a spoiled link; the target transfers `bytes`.
Exchange debug(
    const char* name, const char* violation, unsigned int bytes,
    const std::function<void(ScriptedLink&)>& spoil = [](auto&) {}) {
  return {name, violation, [=](ScriptedLink& link) {
            link.target.on_debug = [bytes](auto&) { return bytes; };
            spoil(link);
            EXPECT_EQ(link.debug(), bytes);
            EXPECT_EQ(link.monitor.counts().debug_calls, 1U);
          }};
}

INSTANTIATE_TEST_SUITE_P(
    Debug, ProtocolMonitorDirect,
    testing::Values(debug("NoBytes", nullptr, 0), debug("SomeBytes", nullptr, 3),
                    debug("AllBytes", nullptr, 8),
                    debug("MoreThanAllBytes", "returned count = 9: must not exceed the data length, 8", 9),
                    debug("UnalignedPartOfAWord", nullptr, 3,
                          [](auto& link) {
                            link.payload.set_address(0x41);
                            link.payload.set_data_length(3);
                          }),
                    debug("NullPointerForNoBytes", nullptr, 0,
                          [](auto& link) {
                            link.payload.set_data_ptr(nullptr);
                            link.payload.set_data_length(0);
                          }),
                    debug("NullPointer", "data pointer = null", 8,
                          [](auto& link) { link.payload.set_data_ptr(nullptr); }),
                    debug("UnknownCommand", "command = 3", 8,
                          [](auto& link) { link.payload.set_command(static_cast<tlm::tlm_command>(3)); }),
                    debug("TheTargetsOption", "gp_option = 2", 8,
                          [](auto& link) { link.payload.set_gp_option(tlm::TLM_FULL_PAYLOAD_ACCEPTED); }),
                    debug("ChangedDataOfAWrite", "data array of a write changed", 8,
                          [](auto& link) {
                            link.payload.set_write();
                            link.target.on_debug = [](Payload& received) {
                              received.get_data_ptr()[0] = 1;
                              return 8U;
                            };
                          }),
                    Exchange{"TargetThatWaits", "transport_dbg: time passed",
                             [](auto& link) {
                               link.target.on_debug = [](auto&) {
                                 sc_core::wait(sc_core::sc_time(1, sc_core::SC_NS));
                                 return 8U;
                               };
                               link.simulate([&link] { link.debug(); });
                             }}),
    ExchangeTest::name);

using ProtocolMonitorDmi = ScriptedLink;

TEST_F(ProtocolMonitorDmi, PassesTheDescriptorOfAWriteGrantOn) {
  elaborate();
  target_grants([](auto& given) { given.allow_read_write(); });
  payload.set_write();
  EXPECT_TRUE(request_dmi());
  EXPECT_EQ(dmi.get_dmi_ptr(), data.data());
}

TEST_F(ProtocolMonitorDmi, PassesARefusalWithAnUntouchedDescriptorAndTheOptionThatTheTargetAccepts) {
  elaborate();
  payload.set_gp_option(tlm::TLM_FULL_PAYLOAD);
  target.on_dmi = [](Payload& received, tlm::tlm_dmi&) {
    received.set_gp_option(tlm::TLM_FULL_PAYLOAD_ACCEPTED);
    return false;
  };
  EXPECT_FALSE(request_dmi());
}

TEST_F(ProtocolMonitorDmi, PassesAnInvalidationOnToTheInitiator) {
  elaborate();
  target.socket->invalidate_direct_mem_ptr(0, std::numeric_limits<sc_dt::uint64>::max());
  target.socket->invalidate_direct_mem_ptr(5, 5);
  EXPECT_EQ(initiator.invalidations, 2);
  EXPECT_EQ(monitor.counts().dmi_invalidations, 2U);
}

}  // namespace
}  // namespace stereotlm::test
