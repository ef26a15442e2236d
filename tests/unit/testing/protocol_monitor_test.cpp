// The monitor reports each broken rule of the base protocol, and nothing else: no test of the models would
// notice that it reports no more. The tests of the modules show that it lets correct calls pass.
#include "models/testing/protocol_monitor.h"

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "models/testing/monitoring_binder.h"
#include "tests/support/scripted_ends.h"

namespace stereotlm::test {
namespace {

using sc_core::SC_NS;
using sc_core::sc_time;
using tlm::BEGIN_REQ;
using tlm::BEGIN_RESP;
using tlm::END_REQ;
using tlm::END_RESP;
using Payload = tlm::tlm_generic_payload;
// Phases that the base protocol ignores.
TLM_DECLARE_EXTENDED_PHASE(lock);
TLM_DECLARE_EXTENDED_PHASE(unlock);

// Nothing is freed: the payloads belong to the test.
class NoFree : public tlm::tlm_mm_interface {
  void free(Payload*) override {}
};

// Two correct two-word reads at 0x40, and a target that answers correctly and at once.
class Link {
 public:
  explicit Link(const ProtocolOptions& options = {true, true, true, false})
      : binder(std::make_unique<MonitoringBinder>(options)) {
    binder->bind(initiator.socket, target.socket, "link");
    for (Payload* correct : {&payload, &other}) {
      correct->set_command(tlm::TLM_READ_COMMAND);
      correct->set_address(0x40);
      correct->set_data_ptr(data.data());
      correct->set_data_length(8);
      correct->set_streaming_width(8);
      correct->set_mm(&manager);
      correct->acquire();
    }
    sc_core::sc_start(sc_core::SC_ZERO_TIME);
  }
  void transport() { initiator.socket->b_transport(payload, delay); }
  // The target answers OK after `act`.
  void target_acts(const std::function<void(Payload&, sc_time&)>& act) {
    target.on_blocking = [act](Payload& received, sc_time& annotated) {
      received.set_response_status(tlm::TLM_OK_RESPONSE);
      act(received, annotated);
    };
  }
  // The target grants 0x0..0x7f for reads, unless `spoil` changes that.
  bool request_dmi(const std::function<void(tlm::tlm_dmi&)>& spoil) {
    target.on_dmi = [this, spoil](Payload&, tlm::tlm_dmi& given) {
      given.set_dmi_ptr(data.data());
      given.set_start_address(0);
      given.set_end_address(0x7f);
      given.allow_read();
      spoil(given);
      return true;
    };
    return initiator.socket->get_direct_mem_ptr(payload, dmi);
  }
  unsigned debug(unsigned bytes) {
    target.on_debug = [bytes](Payload&) { return bytes; };
    return initiator.socket->transport_dbg(payload);
  }
  // One call of nb_transport, which is accepted, or answered with TLM_UPDATED and a phase.
  void forward(tlm::tlm_phase phase, int ns = 0, tlm::tlm_phase answer = tlm::UNINITIALIZED_PHASE) {
    tlm::tlm_phase sent = phase;
    sc_time annotated(ns, SC_NS);
    target.on_forward = [answer](Payload&, tlm::tlm_phase& returned, sc_time&) {
      if (answer != tlm::UNINITIALIZED_PHASE) returned = answer;
      return answer == tlm::UNINITIALIZED_PHASE ? tlm::TLM_ACCEPTED : tlm::TLM_UPDATED;
    };
    initiator.socket->nb_transport_fw(*used, sent, annotated);
  }
  // A request, to which the target answers so.
  void answer_forward(const std::function<tlm::tlm_sync_enum(Payload&, tlm::tlm_phase&, sc_time&)>& answer) {
    target.on_forward = answer;
    tlm::tlm_phase sent = BEGIN_REQ;
    sc_time annotated;
    initiator.socket->nb_transport_fw(payload, sent, annotated);
  }
  void backward(tlm::tlm_phase phase, int ns = 0) {
    tlm::tlm_phase sent = phase;
    sc_time annotated(ns, SC_NS);
    if (phase == BEGIN_RESP) used->set_response_status(tlm::TLM_OK_RESPONSE);
    target.socket->nb_transport_bw(*used, sent, annotated);
  }
  void simulate(const std::function<void()>& body) {
    sc_core::sc_spawn(body);
    sc_core::sc_start();
  }

  std::unique_ptr<MonitoringBinder> binder;
  ScriptedInitiator initiator{"initiator"};
  ScriptedTarget target{"target"};
  NoFree manager;
  std::array<unsigned char, 8> data{};
  std::array<unsigned char, 8> elsewhere{};
  Payload payload;
  Payload other;
  Payload* used = &payload;  // by forward() and backward()
  tlm::tlm_dmi dmi;
  sc_time delay{10, SC_NS};
};

struct Mistake {
  const char* violation;  // the last one
  std::function<void(Link&)> happen;
  std::size_t violations = 1;
};
void PrintTo(const Mistake& mistake, std::ostream* out) { *out << mistake.violation; }

// An initiator that spoils its request.
Mistake request(const char* violation, const std::function<void(Link&)>& spoil) {
  return {violation, [spoil](Link& link) {
            spoil(link);
            link.transport();
          }};
}
// A target that spoils a write with byte enables.
Mistake answer(const char* violation, const std::function<void(Link&, sc_time&)>& spoil) {
  return {violation, [spoil](Link& link) {
            link.payload.set_write();
            link.payload.set_byte_enable_ptr(link.elsewhere.data());
            link.payload.set_byte_enable_length(4);
            link.target_acts([&link, spoil](Payload&, sc_time& annotated) { spoil(link, annotated); });
            link.transport();
          }};
}
Mistake answer(const char* violation, const std::function<void(Link&)>& spoil) {
  return answer(violation, [spoil](Link& link, sc_time&) { spoil(link); });
}
Mistake grant(const char* violation, const std::function<void(tlm::tlm_dmi&)>& spoil) {
  return {violation, [spoil](Link& link) { EXPECT_TRUE(link.request_dmi(spoil)); }};
}

// A debug request with TLM_FULL_PAYLOAD, spoilt.
Mistake debug(const char* violation, const std::function<void(Payload&)>& spoil) {
  return {violation, [spoil](Link& link) {
            link.payload.set_gp_option(tlm::TLM_FULL_PAYLOAD);
            spoil(link.payload);
            link.debug(0);
          }};
}

const std::vector<Mistake> kMistakes = {
    request("command = 3", [](Link& l) { l.payload.set_command(static_cast<tlm::tlm_command>(3)); }),
    request("data pointer = null", [](Link& l) { l.payload.set_data_ptr(nullptr); }),
    request("data length = 0", [](Link& l) { l.payload.set_data_length(0); }),
    request("data length = 6: must be a multiple", [](Link& l) { l.payload.set_data_length(6); }),
    request("address = 0x42", [](Link& l) { l.payload.set_address(0x42); }),
    request("streaming width = 0", [](Link& l) { l.payload.set_streaming_width(0); }),
    request("streaming width = 4: must be at least", [](Link& l) { l.payload.set_streaming_width(4); }),
    request("streaming width = 9: must be a multiple", [](Link& l) { l.payload.set_streaming_width(9); }),
    request("byte enable length = 0", [](Link& l) { l.payload.set_byte_enable_ptr(l.elsewhere.data()); }),
    request("byte enable[1] = 0xf",
            [](Link& l) {
              l.elsewhere[1] = 0xf;
              l.payload.set_byte_enable_ptr(l.elsewhere.data());
              l.payload.set_byte_enable_length(4);
            }),
    request("must be TLM_INCOMPLETE_RESPONSE",
            [](Link& l) { l.payload.set_response_status(tlm::TLM_OK_RESPONSE); }),
    request("dmi_allowed = true", [](Link& l) { l.payload.set_dmi_allowed(true); }),
    request("gp_option = 1", [](Link& l) { l.payload.set_gp_option(tlm::TLM_FULL_PAYLOAD); }),
    request("reference count = 0", [](Link& l) { l.payload.release(); }),

    answer("response status = 0",
           [](Link& l) { l.payload.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE); }),
    answer("response status = 2",
           [](Link& l) { l.payload.set_response_status(static_cast<tlm::tlm_response_status>(2)); }),
    answer("command changed", [](Link& l) { l.payload.set_read(); }),
    answer("address changed from 0x40 to 0x0", [](Link& l) { l.payload.set_address(0); }),
    answer("data pointer changed", [](Link& l) { l.payload.set_data_ptr(l.elsewhere.data()); }),
    answer("data length changed", [](Link& l) { l.payload.set_data_length(4); }),
    answer("streaming width changed", [](Link& l) { l.payload.set_streaming_width(12); }),
    answer("byte enable pointer changed", [](Link& l) { l.payload.set_byte_enable_ptr(l.data.data()); }),
    answer("byte enable length changed", [](Link& l) { l.payload.set_byte_enable_length(8); }),
    answer("byte enable array changed", [](Link& l) { l.elsewhere[3] = 0xff; }),
    answer("gp_option changed", [](Link& l) { l.payload.set_gp_option(tlm::TLM_FULL_PAYLOAD_ACCEPTED); }),
    answer("time fell from 10 ns to 9 ns", [](Link&, sc_time& annotated) { annotated = sc_time(9, SC_NS); }),
    answer("reference count fell", [](Link& l) { l.payload.release(); }),
    answer("already in progress",
           [](Link& l) {
             l.target.on_blocking = [](Payload& received, sc_time&) {
               received.set_response_status(tlm::TLM_OK_RESPONSE);
             };
             l.payload.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
             l.transport();
           }),

    grant("DMI range = 0x41..0x7f: must contain the requested address 0x40",
          [](tlm::tlm_dmi& given) { given.set_start_address(0x41); }),
    grant("DMI range = 0x0..0x3f: must contain the requested address 0x40",
          [](tlm::tlm_dmi& given) { given.set_end_address(0x3f); }),
    grant("must not end before it starts", [](tlm::tlm_dmi& given) { given.set_start_address(0x80); }),
    grant("DMI pointer = null", [](tlm::tlm_dmi& given) { given.set_dmi_ptr(nullptr); }),
    {"granted access = 1: must include the requested one",
     [](Link& l) {
       l.payload.set_write();
       l.request_dmi([](auto&) {});
     }},
    {"DMI descriptor: must be as after init()",
     [](Link& l) {
       l.dmi.set_end_address(0x7f);
       l.request_dmi([](auto&) {});
     }},
    {"the range ends before it starts", [](Link& l) { l.target.socket->invalidate_direct_mem_ptr(6, 5); }},
    {"returned count = 9: must not exceed the data length, 8", [](Link& l) { l.debug(9); }},

    {"phase END_REQ on the forward path", [](Link& l) { l.forward(BEGIN_REQ), l.forward(END_REQ); }},
    {"phase BEGIN_REQ from the target", [](Link& l) { l.forward(BEGIN_REQ), l.backward(BEGIN_REQ); }},
    {"END_REQ after the request has ended",
     [](Link& l) { l.forward(BEGIN_REQ, 0, END_REQ), l.backward(END_REQ); }},
    {"a second BEGIN_RESP",
     [](Link& l) { l.forward(BEGIN_REQ), l.backward(BEGIN_RESP), l.backward(BEGIN_RESP); }},
    {"END_RESP without BEGIN_RESP", [](Link& l) { l.forward(BEGIN_REQ), l.forward(END_RESP); }},
    {"phase END_REQ for a transaction that is not in progress", [](Link& l) { l.backward(END_REQ); }},
    {"BEGIN_REQ for a transaction that is already in progress",
     [](Link& l) { l.forward(BEGIN_REQ), l.backward(END_REQ), l.forward(BEGIN_REQ); }},
    {"time 9 ns after 10 ns", [](Link& l) { l.forward(BEGIN_REQ, 10), l.backward(BEGIN_RESP, 9); }},
    {"one request at a time",
     [](Link& l) {
       l.forward(BEGIN_REQ);
       l.used = &l.other;
       l.forward(BEGIN_REQ);
     }},
    {"one response at a time",
     [](Link& l) {
       l.forward(BEGIN_REQ), l.backward(BEGIN_RESP);
       l.used = &l.other;
       l.forward(BEGIN_REQ), l.backward(BEGIN_RESP);
     }},
    {"TLM_UPDATED for END_RESP",
     [](Link& l) {
       l.forward(BEGIN_REQ), l.backward(BEGIN_RESP);
       l.forward(END_RESP, 0, END_REQ);
     }},
    {"nb_transport_bw: data array of a write or an ignored command changed",
     [](Link& l) {
       l.payload.set_write();
       l.forward(BEGIN_REQ);
       l.data[3] = 1;
       l.backward(END_REQ);
     }},
    {"no memory manager",
     [](Link& l) {
       l.payload.set_mm(nullptr);
       l.forward(BEGIN_REQ);
     }},
    {"nb_transport_bw: time passed",
     [](Link& l) {
       l.initiator.on_backward = [](auto&, auto&, auto&) {
         sc_core::wait(sc_core::SC_ZERO_TIME);
         return tlm::TLM_ACCEPTED;
       };
       l.forward(BEGIN_REQ);
       l.simulate([&l] { l.backward(END_REQ); });
     }},
    {"nb_transport_fw: time passed",
     [](Link& l) {
       l.simulate([&l] {
         l.answer_forward([](auto&, auto&, auto&) {
           sc_core::wait(sc_core::SC_ZERO_TIME);
           return tlm::TLM_ACCEPTED;
         });
       });
     }},
    {"nb_transport_fw returned 3: must be a tlm_sync_enum",
     [](Link& l) {
       l.answer_forward([](auto&, auto&, auto&) { return static_cast<tlm::tlm_sync_enum>(3); });
     }},
    {"TLM_ACCEPTED with phase END_REQ",
     [](Link& l) {
       l.answer_forward([](auto&, tlm::tlm_phase& phase, auto&) {
         phase = END_REQ;
         return tlm::TLM_ACCEPTED;
       });
     }},
    {"TLM_ACCEPTED with another delay",
     [](Link& l) {
       l.answer_forward([](auto&, auto&, sc_time& annotated) {
         annotated = sc_time(1, SC_NS);
         return tlm::TLM_ACCEPTED;
       });
     }},
    {"response status = 0: must be OK or an error",
     [](Link& l) { l.answer_forward([](auto&, auto&, auto&) { return tlm::TLM_COMPLETED; }); }},
    {"END_REQ: only TLM_ACCEPTED may be returned",
     [](Link& l) {
       l.forward(BEGIN_REQ);
       l.initiator.on_backward = [](auto&, auto&, auto&) { return tlm::TLM_COMPLETED; };
       l.backward(END_REQ);
     }},
    {"TLM_UPDATED with phase END_REQ for BEGIN_RESP",
     [](Link& l) {
       l.forward(BEGIN_REQ);
       l.initiator.on_backward = [](auto&, tlm::tlm_phase& phase, auto&) {
         phase = END_REQ;
         return tlm::TLM_UPDATED;
       };
       l.backward(BEGIN_RESP);
     }},
    {"a phase returned for a transaction that was complete",
     [](Link& l) {
       l.answer_forward([&l](auto&, auto&, auto&) {
         l.initiator.on_backward = [](auto&, auto&, auto&) { return tlm::TLM_COMPLETED; };
         l.backward(BEGIN_RESP);
         return tlm::TLM_COMPLETED;
       });
     },
     2},  // the first: nb_transport_bw within nb_transport_fw
    {"nb_transport_bw: called within nb_transport_fw",
     [](Link& l) {
       l.answer_forward([&l](auto&, auto&, auto&) {
         l.backward(END_REQ);
         return tlm::TLM_ACCEPTED;
       });
     }},
    {"nb_transport_fw: called within nb_transport_bw",
     [](Link& l) {
       l.forward(BEGIN_REQ);
       l.initiator.on_backward = [&l](auto&, auto&, auto&) {
         l.used = &l.other;
         l.forward(BEGIN_REQ);
         return tlm::TLM_ACCEPTED;
       };
       l.backward(END_REQ);
     }},
    {"b_transport: called within nb_transport",
     [](Link& l) {
       l.forward(BEGIN_REQ);
       l.initiator.on_backward = [&l](auto&, auto&, auto&) {
         l.target_acts([](auto&, auto&) {});
         l.initiator.socket->b_transport(l.other, l.delay);
         return tlm::TLM_ACCEPTED;
       };
       l.backward(END_REQ);
     }},
    {"nb_transport_bw: called within b_transport",
     [](Link& l) {
       l.used = &l.other;
       l.forward(BEGIN_REQ);
       l.target_acts([&l](auto&, auto&) { l.backward(END_REQ); });
       l.transport();
     }},
    {"TLM_COMPLETED before the last response ended",
     [](Link& l) {
       l.used = &l.other;
       l.forward(BEGIN_REQ), l.backward(BEGIN_RESP);
       l.answer_forward([](Payload& received, auto&, auto&) {
         received.set_response_status(tlm::TLM_OK_RESPONSE);
         return tlm::TLM_COMPLETED;
       });
     }},
    {"nb_transport_fw: data array of a read changed after the response",
     [](Link& l) {
       l.forward(BEGIN_REQ), l.backward(BEGIN_RESP);
       l.data[7] = 1;
       l.forward(END_RESP);
     }},
    {"response status changed after the response",
     [](Link& l) {
       l.forward(BEGIN_REQ), l.backward(BEGIN_RESP);
       l.payload.set_response_status(tlm::TLM_GENERIC_ERROR_RESPONSE);
       l.forward(END_RESP);
     }},
    {"dmi_allowed changed after the response",
     [](Link& l) {
       l.forward(BEGIN_REQ), l.backward(BEGIN_RESP);
       l.payload.set_dmi_allowed(true);
       l.forward(END_RESP);
     }},
    {"phase lock outside of BEGIN_REQ to END_RESP", [](Link& l) { l.forward(lock); }},
    {"phase lock twice in succession",
     [](Link& l) { l.forward(BEGIN_REQ), l.backward(lock), l.backward(lock); }},
    {"TLM_COMPLETED for an ignorable phase",
     [](Link& l) {
       l.forward(BEGIN_REQ);
       l.initiator.on_backward = [](auto&, auto&, auto&) { return tlm::TLM_COMPLETED; };
       l.backward(lock);
     }},
    {"TLM_UPDATED with phase END_REQ on the return path",
     [](Link& l) {
       l.forward(BEGIN_REQ);
       l.initiator.on_backward = [](auto&, tlm::tlm_phase& phase, auto&) {
         phase = END_REQ;
         return tlm::TLM_UPDATED;
       };
       l.backward(lock);
     }},
    {"memory manager set",
     [](Link& l) {
       l.payload.set_mm(nullptr);
       l.target_acts([&l](Payload& received, auto&) {
         received.set_mm(&l.manager);
         received.acquire();
       });
       l.transport();
     }},
    answer("data array of a write or an ignored command changed",
           [](Link& l) { l.data[7] = 1; }),
    {"data array of a write or an ignored command changed",
     [](Link& l) {
       l.payload.set_command(tlm::TLM_IGNORE_COMMAND);
       l.target_acts([&l](auto&, auto&) { l.data[0] = 1; });
       l.transport();
     }},
    debug("response status = TLM_OK_RESPONSE: must be TLM_INCOMPLETE_RESPONSE with TLM_FULL_PAYLOAD",
          [](Payload& sent) { sent.set_response_status(tlm::TLM_OK_RESPONSE); }),
    debug("dmi_allowed = true", [](Payload& sent) { sent.set_dmi_allowed(true); }),
    debug("streaming width = 0", [](Payload& sent) { sent.set_streaming_width(0); }),
    debug("byte enable length = 0", [](Payload& sent) { sent.set_byte_enable_ptr(sent.get_data_ptr()); }),
    {"get_direct_mem_ptr: response status = TLM_OK_RESPONSE",
     [](Link& l) {
       l.payload.set_gp_option(tlm::TLM_FULL_PAYLOAD);
       l.payload.set_streaming_width(0);
       l.payload.set_response_status(tlm::TLM_OK_RESPONSE);
       l.request_dmi([](auto&) {});
     }},
    {"get_direct_mem_ptr: byte enables or streaming width",
     [](Link& l) {
       l.payload.set_gp_option(tlm::TLM_FULL_PAYLOAD);
       l.request_dmi([](auto&) {});
     }},
    {"called from a method process",
     [](Link& l) {
       sc_core::sc_spawn_options method;
       method.spawn_method();
       sc_core::sc_spawn([&l] { l.transport(); }, "method", &method);
       sc_core::sc_start();
     }},
    {"transport_dbg: data pointer = null",
     [](Link& l) {
       l.payload.set_data_ptr(nullptr);
       l.debug(0);
     }},
    {"transport_dbg: command = 3",
     [](Link& l) {
       l.payload.set_command(static_cast<tlm::tlm_command>(3));
       l.debug(0);
     }},
    {"transport_dbg: gp_option = 2",
     [](Link& l) {
       l.payload.set_gp_option(tlm::TLM_FULL_PAYLOAD_ACCEPTED);
       l.debug(0);
     }},
    {"transport_dbg: time passed",
     [](Link& l) {
       l.target.on_debug = [](Payload&) {
         sc_core::wait(sc_core::SC_ZERO_TIME);
         return 8U;
       };
       l.simulate([&l] { l.initiator.socket->transport_dbg(l.payload); });
     }},
    {"get_direct_mem_ptr: time passed",
     [](Link& l) {
       l.simulate([&l] { l.request_dmi([](auto&) { sc_core::wait(sc_core::SC_ZERO_TIME); }); });
     }},
    {"get_direct_mem_ptr: gp_option = 2",
     [](Link& l) {
       l.payload.set_gp_option(tlm::TLM_FULL_PAYLOAD_ACCEPTED);
       l.request_dmi([](auto&) {});
     }},
    {"nb_transport_fw: the transaction is already in progress",
     [](Link& l) {
       l.target.on_blocking = [&l](Payload& received, sc_time&) {
         l.forward(BEGIN_REQ);
         received.set_response_status(tlm::TLM_OK_RESPONSE);
       };
       l.transport();
     }},
    {"nb_transport_fw: reference count = 0",
     [](Link& l) {
       l.payload.release();
       l.forward(BEGIN_REQ);
     }},
    {"get_direct_mem_ptr: command = 2: must be read or write in a DMI request",
     [](Link& l) {
       l.payload.set_command(tlm::TLM_IGNORE_COMMAND);
       l.request_dmi([](tlm::tlm_dmi& given) { given.allow_read_write(); });
     }},
};

class ProtocolMonitorMistake : public testing::TestWithParam<Mistake> {};

TEST_P(ProtocolMonitorMistake, IsReportedOnce) {
  Link link;
  GetParam().happen(link);
  const std::vector<std::string> violations = link.binder->take_violations();
  ASSERT_EQ(violations.size(), GetParam().violations) << testing::PrintToString(violations);
  EXPECT_NE(violations.back().find(GetParam().violation), std::string::npos) << violations.back();
}

INSTANTIATE_TEST_SUITE_P(ProtocolMonitor, ProtocolMonitorMistake, testing::ValuesIn(kMistakes));

// A phase of one's own between BEGIN_REQ and END_RESP, as a call or as a return.
TEST(ProtocolMonitor, LetsIgnorablePhasesPass) {
  Link link;
  link.forward(BEGIN_REQ, 0, lock);
  link.forward(lock);
  link.backward(END_REQ);
  link.initiator.on_backward = [](auto&, tlm::tlm_phase& phase, auto&) {
    phase = lock;
    return tlm::TLM_UPDATED;
  };
  link.backward(BEGIN_RESP);
  link.initiator.on_backward = [](auto&, tlm::tlm_phase& phase, auto&) {
    phase = END_RESP;
    return tlm::TLM_UPDATED;
  };
  link.backward(unlock);
  link.payload.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  link.forward(BEGIN_REQ, 0, END_REQ);  // the transaction was complete
  EXPECT_EQ(link.binder->take_violations(), std::vector<std::string>());
}

// Requests that use no array may have pointers to what is not there any more.
TEST(ProtocolMonitor, ReadsNoArrayThatARequestDoesNotUse) {
  Link link;
  auto* const nowhere = reinterpret_cast<unsigned char*>(8);
  link.payload.set_write();
  link.payload.set_byte_enable_ptr(nowhere);
  link.payload.set_byte_enable_length(8);
  link.debug(0);
  link.payload.set_data_ptr(nowhere);
  EXPECT_TRUE(link.request_dmi([](tlm::tlm_dmi& given) { given.allow_read_write(); }));
  EXPECT_EQ(link.binder->take_violations(), std::vector<std::string>());
}

// Above an interconnect that translates addresses, or that does not attempt a command.
TEST(ProtocolMonitor, MayStandAboveAnInterconnect) {
  Link link({true, false, false, false});
  link.target_acts([](Payload& received, auto&) {
    received.set_address(0);
    received.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  });
  link.transport();
  EXPECT_EQ(link.binder->take_violations(), std::vector<std::string>());
}

TEST(ProtocolMonitor, FailsWithAnAccessByBTransportThatNeverEnds) {
  static auto* const link = new Link(ProtocolOptions{});
  sc_core::sc_event never;
  link->target_acts([&](Payload& received, auto&) {
    received.set_address(0);  // of an interconnect
    sc_core::wait(never);
  });
  sc_core::sc_spawn([] { link->transport(); });
  sc_core::sc_start(sc_time(30, SC_NS));
  EXPECT_NONFATAL_FAILURE(ProtocolMonitor::fail_at_end(),
                          "link_monitor at 30 ns: b_transport: the access to address 0x40 that began at "
                          "10 ns is open: must end before the simulation does");
  link->binder.reset();  // fails once
}

// Without END_RESP. The payload is gone at the end.
TEST(ProtocolMonitor, FailsWithAnAccessByNbTransportThatNeverEnds) {
  static auto* const link = new Link(ProtocolOptions{});
  auto payload = std::make_unique<Payload>(&link->manager);
  payload->deep_copy_from(link->payload);
  payload->set_data_ptr(link->data.data());
  payload->acquire();
  link->used = payload.get();
  link->forward(BEGIN_REQ, 2, END_REQ);
  link->backward(BEGIN_RESP, 3);
  payload.reset();
  EXPECT_NONFATAL_FAILURE(link->binder.reset(),
                          "nb_transport: the access to address 0x40 that began at 2 ns");
}

TEST(ProtocolMonitor, FailsATestThatItOutlives) {
  if (std::getenv("OPEN_ACCESS") != nullptr) {
    static Link link{ProtocolOptions{}};
    link.forward(BEGIN_REQ);
    return;
  }
  const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
  EXPECT_NE(std::system(("OPEN_ACCESS=1 " + program + " --gtest_filter=*FailsATestThatItOutlives").c_str()),
            0);
}

}  // namespace
}  // namespace stereotlm::test
