#include <limits>

#include "tests/unit/support/scripted_link.h"

// DMI and debug transport under a monitor.
namespace stereotlm::test {
namespace {

using Payload = tlm::tlm_generic_payload;

class ProtocolMonitorDirect : public ExchangeTest {};
TEST_P(ProtocolMonitorDirect, GivesItsViolationAndNoOther) { expect_its_violation(); }

// A DMI request for 0x40 that the target answers with the spoiled range.
Exchange dmi(const char* name, const std::function<void(tlm::tlm_dmi&)>& spoil,
             const char* violation = nullptr, bool granted = true) {
  return {name,
          [=](ScriptedLink& link) {
            link.target_grants(spoil, granted);
            EXPECT_EQ(link.request_dmi(), granted);
            EXPECT_EQ(link.monitor.counts().dmi_requests, 1U);
            EXPECT_EQ(link.monitor.counts().dmi_grants, granted ? 1U : 0U);
          },
          violation};
}

// A DMI request that the initiator spoils.
Exchange dmi_request(const char* name, const std::function<void(ScriptedLink&)>& spoil,
                     const char* violation) {
  return {name,
          [=](ScriptedLink& link) {
            link.target_grants();
            spoil(link);
            link.request_dmi();
          },
          violation};
}

INSTANTIATE_TEST_SUITE_P(
    Dmi, ProtocolMonitorDirect,
    testing::Values(
        dmi("Grant", [](auto&) {}), dmi("Refusal", [](auto&) {}, nullptr, false),
        dmi("RangeFromTheAddressOn", [](auto& given) { given.set_start_address(0x40); }),
        dmi("RangeUpToTheAddress", [](auto& given) { given.set_end_address(0x40); }),
        dmi("RangeBehindTheAddress", [](auto& given) { given.set_start_address(0x41); },
            "DMI range = 0x41..0x7f: must contain the requested address 0x40"),
        dmi("RangeBeforeTheAddress", [](auto& given) { given.set_end_address(0x3f); },
            "DMI range = 0x0..0x3f: must contain the requested address 0x40"),
        dmi("RangeThatEndsBeforeItStarts", [](auto& given) { given.set_start_address(0x80); },
            "DMI range = 0x80..0x7f: must not end before it starts"),
        dmi("RefusalOfAnotherRange", [](auto& given) { given.set_start_address(0x44); },
            "must contain the requested address", false),
        dmi("NullPointer", [](auto& given) { given.set_dmi_ptr(nullptr); }, "DMI pointer = null"),
        dmi_request("WriteOfAReadGrant", [](auto& link) { link.payload.set_write(); },
                    "granted access = 1: must include the requested one"),
        dmi_request("UsedDescriptor", [](auto& link) { link.dmi.set_end_address(0x7f); },
                    "DMI descriptor: must be as after init()"),
        dmi_request("NeitherReadNorWrite",
                    [](auto& link) {
                      link.payload.set_command(tlm::TLM_IGNORE_COMMAND);
                      link.target_grants([](auto& given) { given.allow_read_write(); });
                    },
                    "command = 2: must be read or write in a DMI request"),
        dmi_request("TheTargetsAnswer",
                    [](auto& link) { link.payload.set_gp_option(tlm::TLM_FULL_PAYLOAD_ACCEPTED); },
                    "gp_option = 2"),
        dmi_request("ChangedAddress",
                    [](auto& link) {
                      link.target.on_dmi = [](Payload& received, auto&) {
                        received.set_address(0);
                        return false;
                      };
                    },
                    "address changed"),
        Exchange{"TargetThatWaits",
                 [](auto& link) {
                   link.target.on_dmi = [](auto&, auto&) {
                     sc_core::wait(sc_core::SC_ZERO_TIME);
                     return false;
                   };
                   link.simulate([&link] { link.request_dmi(); });
                 },
                 "get_direct_mem_ptr: time passed"},
        Exchange{"InvalidationThatEndsBeforeItStarts",
                 [](auto& link) { link.target.socket->invalidate_direct_mem_ptr(6, 5); },
                 "the range ends before it starts"}),
    ExchangeTest::name);

// A debug call that the initiator or the target spoils; the target transfers `bytes`.
Exchange debug(const char* name, const std::function<void(ScriptedLink&)>& spoil, unsigned int bytes,
               const char* violation = nullptr) {
  return {name,
          [=](ScriptedLink& link) {
            link.target.on_debug = [bytes](auto&) { return bytes; };
            spoil(link);
            EXPECT_EQ(link.debug(), bytes);
            EXPECT_EQ(link.monitor.counts().debug_calls, 1U);
          },
          violation};
}

INSTANTIATE_TEST_SUITE_P(
    Debug, ProtocolMonitorDirect,
    testing::Values(
        debug("NoBytes", [](auto&) {}, 0), debug("SomeBytes", [](auto&) {}, 3),
        debug("AllBytes", [](auto&) {}, 8),
        debug("MoreThanAllBytes", [](auto&) {}, 9, "returned count = 9: must not exceed the data length, 8"),
        debug("UnalignedPartOfAWord",
              [](auto& link) {
                link.payload.set_address(0x41);
                link.payload.set_data_length(3);
              },
              3),
        debug("NullPointerForNoBytes",
              [](auto& link) {
                link.payload.set_data_ptr(nullptr);
                link.payload.set_data_length(0);
              },
              0),
        debug("NullPointer", [](auto& link) { link.payload.set_data_ptr(nullptr); }, 8,
              "data pointer = null"),
        debug("UnknownCommand",
              [](auto& link) { link.payload.set_command(static_cast<tlm::tlm_command>(3)); }, 8,
              "command = 3"),
        debug("TheTargetsAnswer",
              [](auto& link) { link.payload.set_gp_option(tlm::TLM_FULL_PAYLOAD_ACCEPTED); }, 8,
              "gp_option = 2"),
        debug("ChangedDataOfAWrite",
              [](auto& link) {
                link.payload.set_write();
                link.target.on_debug = [](Payload& received) {
                  received.get_data_ptr()[0] = 1;
                  return 8U;
                };
              },
              8, "data array of a write changed"),
        Exchange{"TargetThatWaits",
                 [](auto& link) {
                   link.target.on_debug = [](auto&) {
                     sc_core::wait(sc_core::sc_time(1, sc_core::SC_NS));
                     return 8U;
                   };
                   link.simulate([&link] { link.debug(); });
                 },
                 "transport_dbg: time passed"}),
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
