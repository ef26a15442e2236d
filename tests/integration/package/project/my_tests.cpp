// Three unit tests of a SystemC platform, from the guide of the test kit (models/testing/README.md): the
// rules of the protocol, the cycles of a crossbar, and the words of a memory.
#include <gtest/gtest.h>
#include <stereotlm/models/memory/generic_crossbar.h>
#include <stereotlm/models/memory/ssram_bank.h>
#include <stereotlm/models/testing/grant_check.h>
#include <stereotlm/models/testing/monitoring_binder.h>
#include <stereotlm/models/testing/probing_binder.h>
#include <stereotlm/models/testing/scoreboard.h>
#include <stereotlm/models/testing/traffic.h>
#include <tlm_utils/simple_initiator_socket.h>

#include <cstdint>

namespace {

using namespace stereotlm;
using sc_core::SC_NS;
using sc_core::sc_time;

// The module under test: writes the numbers 0, 1, .. to the words of a memory, and reads them again.
struct Counter : sc_core::sc_module {
  tlm::tlm_initiator_socket<32>& socket() { return port; }
  tlm_utils::simple_initiator_socket<Counter> port{"port"};
  std::uint32_t sum = 0;

  SC_CTOR(Counter) { SC_THREAD(run); }

  void run() {
    for (std::uint32_t number = 0; number < 10; ++number) transport(tlm::TLM_WRITE_COMMAND, number, number);
    for (std::uint32_t number = 0; number < 10; ++number) sum += transport(tlm::TLM_READ_COMMAND, number, 0);
  }
  std::uint32_t transport(tlm::tlm_command command, std::uint64_t number, std::uint32_t word) {
    tlm::tlm_generic_payload access;
    access.set_command(command);
    access.set_address(4 * number);
    access.set_data_ptr(reinterpret_cast<unsigned char*>(&word));
    access.set_data_length(4);
    access.set_streaming_width(4);
    sc_time delay;
    port->b_transport(access, delay);
    wait(delay);
    return word;
  }
};

memory::CrossbarConfig two_ports() {
  memory::CrossbarConfig config;
  config.arbiter = {"round_robin", {0, 1}};
  config.banks = {memory::SsramBankConfig{}};
  return config;
}

TEST(Tutorial, TheCounterKeepsTheRulesOfTheProtocol) {
  test::MonitoringBinder binder;  // a broken rule fails the test, with the clause of IEEE 1666
  Counter counter("counter");
  memory::SsramBank bank("bank", {});
  binder.bind(counter.socket(), bank.port, "counter_to_bank");
  sc_core::sc_start();
  EXPECT_EQ(counter.sum, 45U);
  EXPECT_EQ(sc_core::sc_time_stamp(), sc_time(500, SC_NS));  // ten reads of two clocks of 25 ns
}

TEST(Tutorial, TheSecondPortIsGrantedInCycleOneAndNotInCycleZero) {
  test::ProbingBinder binder;  // keeps each access with its times
  test::TrafficInitiator first("first", test::strided_traffic(0, 4, 1, true, 3));
  test::TrafficInitiator second("second", test::strided_traffic(400, 4, 1, false, 2));
  memory::GenericCrossbar crossbar("crossbar", two_ports());
  memory::SsramBank bank("bank", {});
  binder.bind(first.socket(), crossbar.ports[0], "first");
  binder.bind(second.socket(), crossbar.ports[1], "second");
  binder.bind(crossbar.banks[0], bank.port, "bank");
  sc_core::sc_start();
  const test::GrantCheck grants(crossbar.clock(), *binder.probes()[1].probe, *binder.probes()[2].probe, 0);
  EXPECT_EQ(grants.problem(0, 0, 1), "");
  EXPECT_EQ(crossbar.stats(0).blame(1, 0), 2U);  // cycles in which port 1 waited for port 0
}

TEST(Tutorial, TheBankGivesBackWhatRandomTrafficWrote) {
  test::RandomTraffic from;
  from.count = 1000;
  from.memory_words = 64;
  from.most_words = 8;
  from.longest_pause = sc_time(200, SC_NS);
  test::TrafficInitiator blocking("blocking", test::random_traffic(from));
  from.seed = 1;
  test::TrafficInitiator other("other", test::random_traffic(from),
                               test::TrafficInitiator::Style::kNonBlocking);
  test::MonitoringBinder binder;
  memory::GenericCrossbar crossbar("crossbar", two_ports());
  test::Scoreboard scoreboard("scoreboard");  // a wrong byte fails the test
  memory::SsramBank bank("bank", {});
  binder.bind(blocking.socket(), crossbar.ports[0], "blocking");
  binder.bind(other.socket(), crossbar.ports[1], "other");
  crossbar.banks[0].bind(scoreboard.from_initiator);
  scoreboard.to_target.bind(bank.port);
  sc_core::sc_start();
  EXPECT_TRUE(blocking.is_done() && other.is_done());
  EXPECT_GT(scoreboard.compared(), 0U);
}

}  // namespace
