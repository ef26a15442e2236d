// Probes, scoreboard, traffic and the check of grants: what they see in a module that works, and what they
// find in one that is broken.
#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>
#include <tlm_utils/simple_target_socket.h>

#include <functional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "models/memory/generic_crossbar.h"
#include "models/memory/ssram_bank.h"
#include "models/testing/access_probe.h"
#include "models/testing/expected_report.h"
#include "models/testing/grant_check.h"
#include "models/testing/monitoring_binder.h"
#include "models/testing/scoreboard.h"
#include "models/testing/test_host.h"
#include "models/testing/traffic.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/scripted_ends.h"

namespace stereotlm::test {
namespace {

using sc_core::SC_NS;
using sc_core::sc_time;

// A memory of 64 words that may forget what is written to one byte.
struct Memory : sc_core::sc_module {
  tlm_utils::simple_target_socket<Memory> socket{"socket"};
  explicit Memory(const sc_core::sc_module_name& name) : sc_module(name) {
    socket.register_b_transport(this, &Memory::transport);
  }
  void transport(tlm::tlm_generic_payload& access, sc_time& delay) {
    wait(delay + sc_time(5, SC_NS));
    delay = sc_core::SC_ZERO_TIME;
    for (unsigned byte = 0; byte < access.get_data_length(); ++byte) {
      unsigned char& stored = bytes.at(access.get_address() + byte);
      if (access.is_read()) {
        access.get_data_ptr()[byte] = stored;
      } else if (access.get_address() + byte != forgets) {
        stored = access.get_data_ptr()[byte];
      }
    }
    access.set_response_status(tlm::TLM_OK_RESPONSE);
  }
  std::vector<unsigned char> bytes = std::vector<unsigned char>(256);
  std::uint64_t forgets = UINT64_MAX;
};

TEST(Scoreboard, ComparesWhatIsReadWithWhatWasWritten) {
  RandomTraffic from;
  from.count = 300;
  from.memory_words = 64;
  from.most_words = 5;
  from.longest_pause = sc_time(20, SC_NS);
  TrafficInitiator blocking("blocking", random_traffic(from));
  TrafficInitiator other("other", random_traffic(from), TrafficInitiator::Style::kNonBlocking);
  MonitoringBinder binder;
  std::vector<std::unique_ptr<Scoreboard>> boards;
  std::vector<std::unique_ptr<Memory>> memories;
  for (TrafficInitiator* initiator : {&blocking, &other}) {
    const std::string name = initiator->name();
    boards.push_back(std::make_unique<Scoreboard>((name + "_board").c_str()));
    memories.push_back(std::make_unique<Memory>((name + "_memory").c_str()));
    binder.bind(initiator->socket(), boards.back()->from_initiator, name);
    boards.back()->to_target.bind(memories.back()->socket);
  }
  sc_core::sc_start();
  EXPECT_TRUE(blocking.is_done() && other.is_done());
  EXPECT_EQ(blocking.end(), other.end());
  for (const auto& board : boards) {
    EXPECT_EQ(board->accesses().size(), 300U);
    EXPECT_GT(board->compared(), 1000U);
  }
}

TEST(Scoreboard, FindsAByteThatAMemoryForgets) {
  TestHost host("host");
  Scoreboard board("board");
  Memory memory("memory");
  host.socket.bind(board.from_initiator);
  board.to_target.bind(memory.socket);
  memory.forgets = 9;
  sc_core::sc_spawn([&] {
    host.write(8, 0x11223344);
    host.read(12);
    static TestHost* const initiator = &host;
    EXPECT_NONFATAL_FAILURE(initiator->read(8), "board at 15 ns: byte 9 = 0: must be 51");
    host.read(8);  // known now
  });
  sc_core::sc_start();
  EXPECT_EQ(board.compared(), 8U);
}

// A target that returns its response at once, as the protocol allows.
TEST(TestHost, EndsAResponseThatComesWithTheReturn) {
  TestHost host("host");
  MonitoringBinder binder;
  ScriptedTarget target("target");
  binder.bind(host.socket, target.socket, "link");
  int ended = 0;
  target.on_forward = [&](tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase, sc_time& delay) {
    if (phase == tlm::END_RESP) {
      ++ended;
      return tlm::TLM_ACCEPTED;
    }
    phase = tlm::BEGIN_RESP;
    delay = sc_time(7, SC_NS);
    payload.set_response_status(tlm::TLM_OK_RESPONSE);
    return tlm::TLM_UPDATED;
  };
  sc_core::sc_spawn([&] {
    EXPECT_EQ(host.access(tlm::TLM_READ_COMMAND, 0).at, sc_time(7, SC_NS));
    EXPECT_EQ(host.access(tlm::TLM_READ_COMMAND, 4).status, tlm::TLM_OK_RESPONSE);
  });
  sc_core::sc_start();
  EXPECT_EQ(host.answers.size(), 2U);
  EXPECT_EQ(ended, 2);
}

TEST(AccessProbe, KeepsTimesWordsAndResponses) {
  const test::ExpectedReport refusal("/stereotlm/refused_access");
  TestHost host("host");
  AccessProbe probe("probe");
  memory::SsramBank bank("bank", {16});
  host.socket.bind(probe.from_initiator);
  probe.to_target.bind(bank.port);
  sc_core::sc_start(sc_core::SC_ZERO_TIME);
  host.write(4, 7, sc_time(10, SC_NS));
  host.read(4, sc_time(20, SC_NS));
  host.request(tlm::TLM_READ_COMMAND, 64);
  ASSERT_EQ(probe.accesses().size(), 3U);
  const SeenAccess& read = probe.accesses()[1];
  EXPECT_EQ(read.begin, sc_time(20, SC_NS));
  EXPECT_EQ(read.end, sc_time(70, SC_NS));
  EXPECT_FALSE(read.write);
  EXPECT_EQ(read.words, std::vector<std::uint32_t>{7});
  EXPECT_TRUE(probe.accesses()[0].write);
  EXPECT_EQ(probe.accesses()[2].response, tlm::TLM_ADDRESS_ERROR_RESPONSE);
}

// Two ports of one bank; port 0 comes first.
TEST(GrantCheck, TellsInWhichCycleAWordWasRequestedAndGranted) {
  memory::GenericCrossbar crossbar("crossbar", {{"fixed_priority", {0, 1}}, {memory::SsramBankConfig{}}});
  memory::SsramBank bank("bank", {});
  TestHost first("first");
  TestHost second("second");
  AccessProbe at_first("at_first");
  AccessProbe at_second("at_second");
  AccessProbe at_bank("at_bank");
  first.socket.bind(at_first.from_initiator);
  at_first.to_target.bind(crossbar.ports[0]);
  second.socket.bind(at_second.from_initiator);
  at_second.to_target.bind(crossbar.ports[1]);
  crossbar.banks[0].bind(at_bank.from_initiator);
  at_bank.to_target.bind(bank.port);
  sc_core::sc_spawn([&] { first.write_words(0, {1, 2, 3}); });
  sc_core::sc_spawn([&] { second.read_words(400, 2); });
  sc_core::sc_start();
  const GrantCheck of_first(crossbar.clock(), at_first, at_bank, 0);
  const GrantCheck of_second(crossbar.clock(), at_second, at_bank, 0);
  EXPECT_EQ(of_first.granted_at_once(0, 2, 2), "");
  EXPECT_EQ(of_second.problem(0, 0, 3), "");
  EXPECT_EQ(of_second.granted_at_once(0, 1, 4), "");
  EXPECT_EQ(of_second.problem(0, 0, 4),
            "requested in cycle 0, granted in cycle 3: must be granted in cycle 4");
  EXPECT_EQ(of_second.problem(0, 1, 4),
            "requested in cycle 4, granted in cycle 4: it was refused in no cycle");
  EXPECT_EQ(of_first.granted_at_once(0, 1, 2),
            "requested in cycle 1, granted in cycle 1: must be both in cycle 2");
  EXPECT_EQ(of_first.problem(1, 0, 2), "access 1, word 0: at_first has seen none");
}

TEST(Traffic, IsReadFromATrace) {
  std::istringstream csv(
      "\xEF\xBB\xBFpause_ns, direction,address,words\r\n0,\twrite , 0x10,2\r\n\r\n25,read,16,1\r\n \r\n"
      "9007199254740993,read,0,1\n18446744073709551,read,0xfffffffffffffff8,2");
  const std::vector<TrafficAccess> accesses = traffic_of_csv(csv);
  ASSERT_EQ(accesses.size(), 4U);
  EXPECT_TRUE(accesses[0].write);
  EXPECT_EQ(accesses[0].words, 2U);
  EXPECT_EQ(accesses[0].address, accesses[1].address);
  EXPECT_EQ(accesses[1].pause, sc_time(25, SC_NS));
  EXPECT_EQ(accesses[2].pause.value(), 9'007'199'254'740'993'000U);
  EXPECT_EQ(accesses[3].pause.value(), 18'446'744'073'709'551'000U);
  EXPECT_EQ(strided_traffic(8, 16, 3, false).back().address, 40U);
}

std::string problem_of(const std::string& text) {
  std::istringstream csv(text);
  return message_of([&] { traffic_of_csv(csv); });
}

TEST(Traffic, OfABrokenTraceIsRefusedWithItsLine) {
  const std::string columns = "pause_ns,direction,address,words";
  const auto problem = [&](const std::string& row) { return problem_of(columns + "\n" + row); };
  const std::string pause = ": must be an integer of 0..18446744073709551";
  const std::string address = ": must be an integer of 0..18446744073709551615";
  const std::string words = ": must be an integer of 1..1073741823";
  EXPECT_EQ(problem("0,read,0"), "line 2: 3 values: must be " + columns);
  EXPECT_EQ(problem("0,read,0,1,"), "line 2: 5 values: must be " + columns);
  EXPECT_EQ(problem("0,read,0,1\n\n-1,read,0,1"), "line 4: pause_ns = -1" + pause);
  EXPECT_EQ(problem("0,fetch,0,1"), "line 2: direction = fetch: must be read or write");
  EXPECT_EQ(problem("0,read,010,1"), "line 2: address = 010: must be a multiple of 4");  // ten
  for (const std::string none : {"", "-1", "+1", "1.0", "1e3", "18446744073709552", "18446744073709551615"})
    EXPECT_EQ(problem(none + ",read,0,1"), "line 2: pause_ns = " + none + pause);
  for (const std::string none : {"0x1g", "0x", "0x-4", "-4", "0x10000000000000000", "18446744073709551616"})
    EXPECT_EQ(problem("0,read, " + none + ",1"), "line 2: address = " + none + address);
  for (const std::string none : {"0", "1073741824", "18446744073709551615"})
    EXPECT_EQ(problem("0,read,0," + none), "line 2: words = " + none + words);
  EXPECT_EQ(problem("0,read,0xfffffffffffffff8,3"),
            "line 2: address = 0xfffffffffffffff8: the access must end at 2^64 or before it");
  EXPECT_EQ(problem("0,read,8\xC2\xA0,1"), "line 2: address = 8<0xc2><0xa0>" + address);
  EXPECT_EQ(problem_of(""), "line 1: cannot be read: must be " + columns);
  EXPECT_EQ(problem_of({"p\0a\0", 4}), "line 1: p<0x0>a<0x0>: must be " + columns);  // UTF-16
  EXPECT_EQ(problem_of(columns + "\r0"), "line 1: " + columns + "<0xd>0: must be " + columns);
}

TEST(Traffic, NeedsATimeResolutionInWhichAPauseIsExact) {
  const ExpectedReport coarse("default time unit changed to time resolution");
  sc_core::sc_set_time_resolution(10, SC_NS);
  EXPECT_EQ(problem_of("pause_ns,direction,address,words\n5,read,0,1\n"),
            "line 2: pause_ns: needs a time resolution of 1 ns or finer");
}

TEST(Traffic, OfNumbersOutOfRangeIsRefused) {
  constexpr std::size_t kTooManyWords = std::size_t{1} << 30U;
  for (const RandomTraffic& from : {RandomTraffic{}, RandomTraffic{0, 1, 4, UINT64_MAX / 4 + 1, 1, 50, {}},
                                    RandomTraffic{0, 1, 0, UINT64_MAX / 8, kTooManyWords, 50, {}}})
    EXPECT_THROW(random_traffic(from), std::invalid_argument);
  for (const std::size_t words : {std::size_t{0}, kTooManyWords})
    EXPECT_THROW(strided_traffic(0, 4, 1, false, words), std::invalid_argument);
  EXPECT_THROW(strided_traffic(2, 4, 1, false), std::invalid_argument);
}

TEST(Traffic, FailsTheTestWithAnAccessThatIsRefused) {
  const test::ExpectedReport refusal("/stereotlm/refused_access");
  TrafficInitiator initiator("initiator", strided_traffic(60, 4, 2, true));
  memory::SsramBank bank("bank", {16});
  initiator.socket().bind(bank.port);
  EXPECT_NONFATAL_FAILURE(sc_core::sc_start(), "initiator at 0 s: access 1 at address 64 was refused");
}

}  // namespace
}  // namespace stereotlm::test
