// The crossbar for any initiators: times of single accesses, what is refused, and random traffic against a
// plain loop over cycles.
#include "models/memory/generic_crossbar.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tlm_utils/simple_initiator_socket.h>

#include <algorithm>
#include <cstring>
#include <deque>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "models/kernel_time.h"
#include "models/memory/arbitration_policies.h"
#include "models/memory/ssram_bank.h"
#include "models/testing/expected_report.h"
#include "models/testing/monitoring_binder.h"
#include "models/testing/probing_binder.h"
#include "models/testing/scoreboard.h"
#include "models/testing/test_host.h"
#include "models/testing/traffic.h"
#include "tests/support/random_board.h"
#include "tests/support/scripted_ends.h"

namespace stereotlm::memory {
namespace {

using sc_core::SC_NS;
using sc_core::sc_time;
using Words = std::vector<std::uint32_t>;

constexpr std::uint64_t kReport = 1;

PriorityList list_of(std::size_t ports) {
  PriorityList list(ports);
  std::iota(list.begin(), list.end(), Port{0});
  return list;
}

// Ports, the crossbar and its banks, with a monitor in each link of a port and a probe in each link of a
// bank.
struct Bench {
  explicit Bench(const CrossbarConfig& config) : crossbar("crossbar", config) {
    for (std::size_t bank = 0; bank < config.banks.size(); ++bank) {
      const std::string name = fmt::format("bank{}", bank);
      banks.push_back(std::make_unique<SsramBank>(name.c_str(), config.banks[bank]));
      probes.bind(crossbar.banks[bank], banks.back()->port, name);
    }
  }
  test::TestHost& host(Port port) {
    const std::string name = fmt::format("host{}", port);
    hosts.push_back(std::make_unique<test::TestHost>(name.c_str()));
    binder.bind(hosts.back()->socket, crossbar.ports[port], name);
    return *hosts.back();
  }
  const std::vector<test::SeenAccess>& accesses(std::size_t bank) const {
    return probes.probes()[bank].probe->accesses();
  }

  test::MonitoringBinder binder;
  test::ProbingBinder probes;
  GenericCrossbar crossbar;
  std::vector<std::unique_ptr<SsramBank>> banks;
  std::vector<std::unique_ptr<test::TestHost>> hosts;
};

TEST(GenericCrossbar, GivesAnAccessTheCyclesOfItsWords) {
  Bench bench({{"round_robin", list_of(2)}, {SsramBankConfig{}, {64, BankKind::kZbtFlowThrough, 0, 40}}});
  test::TestHost& host = bench.host(0);
  bench.host(1);
  sc_core::sc_spawn([&] {
    // Written in the cycles 2, 3 and 4; the last one ends at 125 ns.
    auto answer = host.write(crossbar_address(1, 7), 5, sc_time(26, SC_NS));
    EXPECT_EQ(answer.status, tlm::TLM_OK_RESPONSE);
    EXPECT_EQ(answer.at, sc_time(75, SC_NS));
    sc_core::wait(answer.at - sc_core::sc_time_stamp());
    answer = host.write_words(crossbar_address(1, 8), {6, 7});
    EXPECT_EQ(bench.crossbar.stats(1).idle_cycles(), 5U - 3U);  // of the cycles up to the present one
    EXPECT_EQ(answer.at, sc_time(125, SC_NS));
    sc_core::wait(answer.at - sc_core::sc_time_stamp());
    // Read in the cycles 5 to 7; the last word is usable a cycle later.
    answer = host.read_words(crossbar_address(1, 7), 3);
    EXPECT_EQ(answer.words, (Words{5, 6, 7}));
    EXPECT_EQ(answer.at, sc_time(200, SC_NS));
    EXPECT_EQ(host.debug_read(crossbar_address(1, 7), 3), (Words{5, 6, 7}));
  });
  sc_core::sc_start(sc_time(300, SC_NS));
  EXPECT_EQ(bench.crossbar.stats(1).idle_cycles(), 12U - 6U);
}

TEST(GenericCrossbar, WritesTheBytesThatAreEnabled) {
  Bench bench({{"fixed_priority", list_of(1)}, {SsramBankConfig{}}});
  test::TestHost& host = bench.host(0);
  sc_core::sc_spawn([&] {
    std::vector<std::uint32_t> words = {0x11111111, 0x22222222};
    std::array<unsigned char, 3> enables = {TLM_BYTE_ENABLED, 0, 0};  // again for each three bytes
    tlm::tlm_generic_payload access;
    access.set_command(tlm::TLM_WRITE_COMMAND);
    access.set_address(0);
    access.set_data_ptr(reinterpret_cast<unsigned char*>(words.data()));
    access.set_data_length(8);
    access.set_streaming_width(8);
    access.set_byte_enable_ptr(enables.data());
    access.set_byte_enable_length(3);
    sc_time delay;
    host.socket->b_transport(access, delay);
    EXPECT_TRUE(access.is_response_ok());
  });
  sc_core::sc_start(sc_time(200, SC_NS));
  EXPECT_EQ(host.debug_read(0, 2), (Words{0x11000011, 0x00220000}));
}

TEST(GenericCrossbar, RefusesAndReportsOnce) {
  Bench bench({{"fixed_priority", list_of(1)}, {{16}, {16}}});
  test::TestHost& host = bench.host(0);
  sc_core::sc_spawn([&] {
    test::ExpectedReport expected("/stereotlm/refused_access", kReport);
    EXPECT_EQ(host.read(crossbar_address(2, 0)).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
    EXPECT_NE(
        expected.text().find("crossbar.port_0: TLM_ADDRESS_ERROR_RESPONSE for a read of 4 bytes at address "
                             "0x20000000: there is no such bank (crossbar_address(): the bank is in bits 28"),
        std::string::npos)
        << expected.text();
    EXPECT_EQ(host.read_words(crossbar_address(1, 0) - 4, 2).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
    EXPECT_EQ(bench.accesses(0).size(), 0U);
    const test::ExpectedReport of_bank("/stereotlm/refused_access");  // refuses the second word
    EXPECT_EQ(host.write_words(crossbar_address(0, 15), {1, 2, 3}).status, tlm::TLM_ADDRESS_ERROR_RESPONSE);
    EXPECT_EQ(bench.accesses(0).size(), 2U);
  });
  sc_core::sc_start(sc_time(500, SC_NS));
}

// Of the process that is served, of one in the queue, and of one whose time has not come.
TEST(GenericCrossbar, DropsWhatIsNotGrantedOfAKilledProcess) {
  Bench bench({{"fixed_priority", list_of(1)}, {SsramBankConfig{}}});
  test::TestHost& host = bench.host(0);
  test::ExpectedReport lost("/stereotlm/lost_access", 3);
  auto victim = sc_core::sc_spawn([&] { host.write_words(8, {1, 2, 3, 4}); }, "victim");
  auto in_queue = sc_core::sc_spawn([&] { host.write(8, 5); });
  auto before_its_time = sc_core::sc_spawn([&] { host.write(8, 6, sc_time(50, SC_NS)); });
  test::TestHost::Answer answer;
  sc_core::sc_spawn([&] { answer = host.read_words(8, 3); });
  sc_core::sc_spawn([&] {
    sc_core::wait(30, SC_NS);  // words are granted at 0 ns, 25 ns, 50 ns, ..
    victim.kill();
    EXPECT_EQ(
        lost.text(),
        "crossbar.port_0: a write of 16 bytes at address 0x8 is lost: kill(), reset() or an exception has "
        "taken its process victim out of b_transport; 8 of 16 bytes had been transferred");
    in_queue.kill();  // before it notices that it has its turn
    before_its_time.kill();
  });
  sc_core::sc_start();
  EXPECT_EQ(answer.words, (Words{1, 2, 0}));
  EXPECT_EQ(answer.at, sc_time(50 + 4 * 25, SC_NS));
}

TEST(GenericCrossbar, ServesTheNextIfABankKillsTheProcessOfAnAccess) {
  GenericCrossbar crossbar("crossbar", {{"fixed_priority", list_of(1)}, {SsramBankConfig{}}});
  test::TestHost host("host");
  test::ScriptedTarget bank("target");
  host.socket.bind(crossbar.ports[0]);
  crossbar.banks[0].bind(bank.socket);
  const test::ExpectedReport lost("/stereotlm/lost_access");
  auto victim = sc_core::sc_spawn([&] { host.read_words(0, 2); });
  bank.on_blocking = [&](tlm::tlm_generic_payload& word, sc_time&) {
    if (!victim.terminated()) victim.kill();
    std::memset(word.get_data_ptr(), 7, 4);
    word.set_response_status(tlm::TLM_OK_RESPONSE);
  };
  sc_core::sc_spawn([&] {
    sc_core::wait(30, SC_NS);
    EXPECT_EQ(host.read(4).word, 0x0707'0707U);
  });
  sc_core::sc_start();
}

TEST(GenericCrossbar, StopsTheSimulationWhereALostAccessIsToThrow) {
  Bench bench({{"fixed_priority", list_of(1)}, {SsramBankConfig{}}});
  test::TestHost& host = bench.host(0);
  const test::ExpectedReport lost("/stereotlm/lost_access");
  sc_core::sc_report_handler::set_actions("/stereotlm/lost_access", sc_core::SC_THROW);
  auto victim = sc_core::sc_spawn([&] { host.read(8, sc_time(1, sc_core::SC_US)); });
  sc_core::sc_spawn([&] {
    sc_core::wait(30, SC_NS);
    victim.kill();
  });
  sc_core::sc_start();
  EXPECT_EQ(sc_core::sc_time_stamp(), sc_time(30, SC_NS));
}

// Two processes at each port write words of their own and read them back, behind a scoreboard, while others
// are killed and reset at any time, in any delta cycle.
TEST(GenericCrossbar, ServesAllWhileProcessesEndAtAnyTime) {
  sc_core::sc_report_handler::set_actions("/stereotlm/lost_access", sc_core::SC_DO_NOTHING);
  test::SplitMix64 random(1);
  Bench bench({{"round_robin", list_of(3)}, {{64, BankKind::kSyncBurst, 1, 40}}});
  std::deque<test::Scoreboard> scoreboards;
  for (Port port = 0; port < 3; ++port) {
    scoreboards.emplace_back(fmt::format("scoreboard{}", port).c_str())
        .to_target.bind(bench.crossbar.ports[port]);
    bench.hosts.push_back(std::make_unique<test::TestHost>(fmt::format("host{}", port).c_str()));
    bench.binder.bind(bench.hosts.back()->socket, scoreboards.back().from_initiator,
                      fmt::format("link{}", port));
  }
  bool is_last = false;
  std::uint32_t value = 0;
  const auto work = [&](std::size_t number) {
    test::TestHost& host = *bench.hosts[number / 2];
    do {
      const Words words = {++value, ++value, ++value};
      const sc_time written = host.write_words(16 * number, words).at;
      if (number % 3 != 0) sc_core::wait(written - sc_core::sc_time_stamp());
      const auto answer = number % 3 == 1 ? host.access(tlm::TLM_READ_COMMAND, 16 * number, Words(3))
                                          : host.read_words(16 * number, 3);
      EXPECT_EQ(answer.words, words);
      sc_core::wait(answer.at - sc_core::sc_time_stamp());
    } while (!is_last);
  };
  const auto start = [&](std::size_t number) { return sc_core::sc_spawn([&work, number] { work(number); }); };
  std::vector<sc_core::sc_process_handle> processes;
  for (std::size_t number = 0; number < 6; ++number) processes.push_back(start(number));
  sc_core::sc_spawn([&] {
    for (int end = 0; end < 2000; ++end) {
      sc_core::wait(sc_core::SC_ZERO_TIME);  // SystemC 2.3.4 kills no process that has not begun
      sc_core::wait(random.between(0, 3) * sc_time(25, SC_NS));
      for (int deltas = random.between(0, 8); deltas > 0; --deltas) sc_core::wait(sc_core::SC_ZERO_TIME);
      const auto number = static_cast<std::size_t>(random.between(0, 5));
      if (random.chance(50)) {
        processes[number].reset();
        continue;
      }
      processes[number].kill();
      processes[number] = start(number);
    }
    is_last = true;
  });
  sc_core::sc_start();
  for (const auto& started : processes) EXPECT_TRUE(started.terminated());
}

TEST(GenericCrossbar, RefusesAConfigurationWithProblems) {
  EXPECT_THROW(GenericCrossbar("crossbar", {{"fixed_priority", {0, 0}}, {SsramBankConfig{}}}),
               std::invalid_argument);
}

// Random traffic.
struct Access {
  std::uint64_t pause_ps;  // after the end of the access before
  bool write;
  std::size_t bank;
  std::uint32_t word;
  std::size_t count;
};
struct Grant {
  std::uint64_t cycle;
  std::size_t bank;
  bool write;
  std::uint32_t word;
};
bool operator==(const Grant& a, const Grant& b) {
  return a.cycle == b.cycle && a.bank == b.bank && a.write == b.write && a.word == b.word;
}
std::ostream& operator<<(std::ostream& out, const Grant& grant) {
  return out << fmt::format("cycle {}: bank {} {} {}", grant.cycle, grant.bank,
                            grant.write ? "write" : "read", grant.word);
}

// The edges of a clock, which are rounded to the nearest ps.
struct Edges {
  std::uint64_t khz;
  std::uint64_t ps(std::uint64_t cycle) const { return (2'000'000'000 * cycle + khz) / (2 * khz); }
  std::uint64_t at_or_after(std::uint64_t time_ps) const {
    std::uint64_t cycle = time_ps * khz / 1'000'000'000;
    while (ps(cycle) < time_ps) ++cycle;
    return cycle;
  }
};

struct Traffic {
  Edges edges;
  CrossbarConfig config;
  std::vector<std::vector<Access>> accesses;  // [port]
};

SdramTiming draw_sdram(test::SplitMix64& random) {
  SdramTiming sdram;
  sdram.cas_latency = random.between(1, 3);
  sdram.row_words = 16;
  sdram.internal_banks = 1 << random.between(0, 1);  // 64 words: more rows than there are banks
  sdram.activate_cycles = random.between(0, 3);
  sdram.precharge_cycles = random.between(0, 3);
  sdram.refresh_interval_cycles = random.between(64, 100);
  sdram.refresh_cycles = random.between(1, 12);
  if (random.chance(30)) sdram.refresh_interval_cycles = std::nullopt;
  return sdram;
}

Traffic draw(std::uint64_t seed) {
  test::SplitMix64 random(seed);
  Traffic traffic;
  traffic.edges.khz = static_cast<std::uint64_t>(random.between(5'000, 1'000'000));
  const auto ports = static_cast<std::size_t>(random.between(1, 7));
  traffic.config.arbiter.policy = arbitration_policies()[seed % arbitration_policies().size()].name;
  traffic.config.arbiter.priority = list_of(ports);
  for (std::size_t left = ports; left > 1; --left)
    std::swap(traffic.config.arbiter.priority[left - 1],
              traffic.config.arbiter
                  .priority[static_cast<std::size_t>(random.between(0, static_cast<int>(left) - 1))]);
  for (int banks = random.between(1, 3); banks > 0; --banks) {
    SsramBankConfig bank;
    bank.words = 64;
    bank.clock_mhz = static_cast<double>(traffic.edges.khz) / 1000;
    bank.kind = std::array{BankKind::kZbtPipelined, BankKind::kZbtFlowThrough, BankKind::kSyncBurst,
                           BankKind::kQdr, BankKind::kSdram}[static_cast<std::size_t>(random.between(0, 4))];
    if (bank.kind == BankKind::kSdram) bank.sdram = draw_sdram(random);
    if (bank.kind == BankKind::kSyncBurst) bank.turnaround_cycles = random.between(1, 4);
    traffic.config.banks.push_back(bank);
  }
  for (std::size_t port = 0; port < ports; ++port) {
    std::vector<Access>& list = traffic.accesses.emplace_back();
    for (int number = random.between(5, 30); number > 0; --number) {
      const auto count = static_cast<std::size_t>(random.chance(50) ? 1 : random.between(1, 8));
      const std::uint64_t pause =
          random.chance(50) ? 0 : static_cast<std::uint64_t>(random.between(0, 120'000));
      list.push_back(
          {pause, random.chance(40),
           static_cast<std::size_t>(random.between(0, static_cast<int>(traffic.config.banks.size()) - 1)),
           static_cast<std::uint32_t>(random.between(0, 64 - static_cast<int>(count))), count});
    }
  }
  return traffic;
}

// What the contract says (section 2, "Banks" and "Arbiter"), cycle by cycle.
class PlainCrossbar {
 public:
  explicit PlainCrossbar(const Traffic& traffic) : traffic_(traffic), ports_(traffic.accesses.size()) {
    for (const SsramBankConfig& bank : traffic.config.banks) {
      banks_.push_back({bank.kind == BankKind::kQdr,
                        bank.turnaround_cycles,
                        read_latency_cycles(bank),
                        bank.sdram,
                        {},
                        {},
                        {},
                        {},
                        0,
                        1});
      for (auto& age : banks_.back().age) age.resize(ports_.size());
    }
    for (std::size_t port = 0; port < ports_.size(); ++port) begin(port, 0);
  }

  std::vector<Grant> grants() {
    std::vector<Grant> all;
    for (std::uint64_t cycle = 0; !done(); ++cycle) {
      for (std::size_t bank = 0; bank < banks_.size(); ++bank) {
        if (banks_[bank].separate) {
          decide(bank, cycle, false, true, all);
          decide(bank, cycle, true, true, all);
        } else {
          decide(bank, cycle, false, false, all);
        }
      }
    }
    return all;
  }

 private:
  struct PortState {
    std::size_t next = 0;  // access
    std::size_t word = 0;
    std::uint64_t from_cycle = 0;
  };
  struct Bank {
    bool separate;
    int turnaround;
    int latency;
    std::optional<SdramTiming> sdram;
    std::array<std::optional<std::uint64_t>, 2> last;     // [write]: cycle of the last grant
    std::array<std::optional<std::size_t>, 2> last_port;  // [direction]: place in the list, for round robin
    std::array<std::vector<std::uint64_t>, 2> age;        // [direction][port]
    std::map<std::uint32_t, std::uint32_t> open;          // row of each internal bank (section 8.3)
    std::uint64_t busy_until;                             // with a refresh or a row
    std::uint64_t next_refresh;
  };

  static void refresh_if_due(Bank& bank, std::uint64_t cycle) {
    if (!bank.sdram || !bank.sdram->refresh_interval_cycles || cycle < bank.busy_until) return;
    if (cycle < bank.next_refresh * static_cast<std::uint64_t>(*bank.sdram->refresh_interval_cycles)) return;
    ++bank.next_refresh;
    bank.busy_until = cycle + static_cast<std::uint64_t>(bank.sdram->refresh_cycles) +
                      static_cast<std::uint64_t>(bank.open.empty() ? 0 : bank.sdram->precharge_cycles);
    bank.open.clear();
  }
  // Whether the bank must open the row of this word first, and does so.
  static bool opens_row(Bank& bank, std::uint32_t word, std::uint64_t cycle) {
    if (!bank.sdram) return false;
    const std::uint32_t row = word / static_cast<std::uint32_t>(bank.sdram->row_words);
    const std::uint32_t internal = row % static_cast<std::uint32_t>(bank.sdram->internal_banks);
    const auto open = bank.open.find(internal);
    if (open != bank.open.end() && open->second == row) return false;
    bank.busy_until = cycle + static_cast<std::uint64_t>(bank.sdram->activate_cycles) +
                      static_cast<std::uint64_t>(open == bank.open.end() ? 0 : bank.sdram->precharge_cycles);
    bank.open[internal] = row;
    return cycle < bank.busy_until;
  }
  static bool turns_round(const Bank& bank, bool write, std::uint64_t cycle) {
    const auto& other = bank.last[write ? 0 : 1];
    const int lost = !bank.sdram ? bank.turnaround : write ? bank.sdram->cas_latency : 0;
    return !bank.separate && other && cycle < *other + static_cast<std::uint64_t>(lost) + 1;
  }

  bool done() const {
    for (std::size_t port = 0; port < ports_.size(); ++port)
      if (ports_[port].next < traffic_.accesses[port].size()) return false;
    return true;
  }
  void begin(std::size_t port, std::uint64_t end_ps) {
    PortState& state = ports_[port];
    if (state.next == traffic_.accesses[port].size()) return;
    const std::uint64_t at_ps = end_ps + traffic_.accesses[port][state.next].pause_ps;
    state.from_cycle = traffic_.edges.at_or_after(at_ps);
  }
  void decide(std::size_t number, std::uint64_t cycle, bool writes, bool one_direction,
              std::vector<Grant>& all) {
    Bank& bank = banks_[number];
    refresh_if_due(bank, cycle);
    const std::size_t direction = one_direction && writes ? 1 : 0;
    std::vector<std::size_t> asking;  // in the order of the list
    for (const Port port : traffic_.config.arbiter.priority) {
      const PortState& state = ports_[port];
      const bool asks = state.next < traffic_.accesses[port].size() && state.from_cycle <= cycle &&
                        traffic_.accesses[port][state.next].bank == number &&
                        (!one_direction || traffic_.accesses[port][state.next].write == writes);
      if (asks) asking.push_back(port);
      bank.age[direction][port] = asks ? bank.age[direction][port] + 1 : 0;
    }
    if (asking.empty() || cycle < bank.busy_until) return;
    const Port winner = winner_of(bank, direction, asking);
    const Access& access = traffic_.accesses[winner][ports_[winner].next];
    const auto word = access.word + static_cast<std::uint32_t>(ports_[winner].word);
    if (opens_row(bank, word, cycle) || turns_round(bank, access.write, cycle)) return;
    bank.last[access.write ? 1 : 0] = cycle;
    const PriorityList& list = traffic_.config.arbiter.priority;
    bank.last_port[direction] =
        static_cast<std::size_t>(std::find(list.begin(), list.end(), winner) - list.begin());
    bank.age[direction][winner] = 0;
    PortState& state = ports_[winner];
    all.push_back({cycle, number, access.write, word});
    state.from_cycle = cycle + 1;
    if (++state.word < access.count) return;
    state.word = 0;
    ++state.next;
    begin(winner, traffic_.edges.ps(cycle + static_cast<std::uint64_t>(access.write ? 1 : bank.latency)));
  }
  Port winner_of(const Bank& bank, std::size_t direction, const std::vector<std::size_t>& asking) const {
    const PriorityList& list = traffic_.config.arbiter.priority;
    const std::string& policy = traffic_.config.arbiter.policy;
    if (policy == "fixed_priority") return asking.front();
    if (policy == "age") {
      return *std::max_element(asking.begin(), asking.end(), [&](std::size_t a, std::size_t b) {
        return bank.age[direction][a] < bank.age[direction][b];
      });
    }
    if (policy != "round_robin") throw std::invalid_argument("policy " + policy + ": not in this plain loop");
    for (std::size_t step = 0; step < list.size(); ++step) {
      const std::size_t begin = bank.last_port[direction] ? *bank.last_port[direction] + 1 : 0;
      const Port port = list[(begin + step) % list.size()];
      if (std::find(asking.begin(), asking.end(), port) != asking.end()) return port;
    }
    return asking.front();
  }

  const Traffic& traffic_;
  std::vector<PortState> ports_;
  std::vector<Bank> banks_;
};

class RandomTraffic : public ::testing::TestWithParam<std::uint64_t> {};

// At clocks of 5 to 1,000 MHz. One crossbar for each process: SystemC elaborates once. Ports with even
// numbers use b_transport, the others nb_transport.
TEST_P(RandomTraffic, IsGrantedAsInThePlainLoop) {
  const Traffic traffic = draw(GetParam());
  Bench bench(traffic.config);
  using test::TrafficInitiator;
  std::deque<TrafficInitiator> initiators;
  for (Port port = 0; port < traffic.accesses.size(); ++port) {
    std::vector<test::TrafficAccess> accesses;
    for (const auto& [pause_ps, write, bank, word, count] : traffic.accesses[port])
      accesses.push_back({kernel_time::to_time(pause_ps), write, crossbar_address(bank, word), count});
    const std::string name = fmt::format("initiator{}", port);
    initiators.emplace_back(
        name.c_str(), accesses,
        port % 2 == 1 ? TrafficInitiator::Style::kNonBlocking : TrafficInitiator::Style::kBlocking);
    bench.binder.bind(initiators.back().socket(), bench.crossbar.ports[port], name);
  }
  sc_core::sc_start(sc_time(1, sc_core::SC_MS));
  const std::vector<Grant> expected = PlainCrossbar(traffic).grants();
  std::vector<Grant> found;
  for (std::size_t bank = 0; bank < traffic.config.banks.size(); ++bank) {
    for (const test::SeenAccess& one : bench.accesses(bank)) {
      const std::uint64_t begin_ps = kernel_time::to_ps(one.begin);
      const std::uint64_t cycle = traffic.edges.at_or_after(begin_ps);
      EXPECT_EQ(traffic.edges.ps(cycle), begin_ps);
      found.push_back({cycle, bank, one.write, static_cast<std::uint32_t>(one.address / 4)});
    }
  }
  ASSERT_EQ(found.size(), expected.size());
  const auto in_order = [](const Grant& a, const Grant& b) {
    return std::tie(a.cycle, a.bank, a.write) < std::tie(b.cycle, b.bank, b.write);
  };
  std::vector<Grant> sorted = expected;
  std::sort(sorted.begin(), sorted.end(), in_order);
  std::sort(found.begin(), found.end(), in_order);
  for (std::size_t grant = 0; grant < found.size(); ++grant) ASSERT_EQ(found[grant], sorted[grant]);
  std::uint64_t counted = 0;
  for (std::size_t bank = 0; bank < traffic.config.banks.size(); ++bank) {
    const ArbiterStats stats = bench.crossbar.stats(bank);
    counted += stats.reads() + stats.writes();
    EXPECT_EQ(stats.busy_cycles() + stats.turnaround_cycles() + stats.row_cycles() + stats.refresh_cycles() +
                  stats.idle_cycles(),
              traffic.edges.at_or_after(1'000'000'000));
  }
  EXPECT_EQ(counted, found.size());
}

INSTANTIATE_TEST_SUITE_P(Drawn, RandomTraffic, ::testing::Range<std::uint64_t>(0, 60));

}  // namespace
}  // namespace stereotlm::memory
