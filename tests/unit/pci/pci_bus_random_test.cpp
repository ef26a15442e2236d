// Random masters and targets on the bus, against the literal bus of plain_pci_bus.h.
#include <gtest/gtest.h>

#include <array>
#include <deque>
#include <random>
#include <sstream>

#include "tests/support/fork.h"
#include "tests/support/plain_pci_bus.h"
#include "tests/unit/pci/pci_bus_bench.h"

namespace stereotlm::pci {
namespace {

struct Request {
  std::uint64_t gap_ps;  // after the end of the master's last burst
  Script script;
};
struct Board {
  std::string mhz;
  PciBusConfig config;
  std::vector<int> read_clocks;  // [window]; time that its target takes for a read
  std::vector<std::vector<Request>> masters;
};
struct Line {
  std::uint64_t address_ps;
  std::size_t master;
  BurstEnd end;
  std::size_t words;
  std::uint64_t end_ps;
};
using Log = std::vector<Line>;

std::string text_of(const Log& log) {
  std::ostringstream text;
  for (const Line& line : log) {
    text << line.address_ps << " m" << line.master << " end " << int(line.end) << " words " << line.words
         << " to " << line.end_ps << '\n';
  }
  return text.str();
}
template <class MasterStats>
std::string text_of(std::uint64_t busy_clocks, const std::vector<MasterStats>& masters) {
  std::ostringstream text;
  text << "busy " << busy_clocks << '\n';
  for (const MasterStats& master : masters)
    text << master.transactions << " bursts " << master.words << " words " << master.wait_clocks
         << " waits\n";
  return text.str();
}

Board random_board(unsigned seed) {
  std::mt19937 random(seed);
  const auto below = [&random](unsigned end) { return static_cast<unsigned>(random() % end); };
  Board board;
  board.mhz = std::array<const char*, 4>{"33.333", "66.667", "40", "29.97"}[below(4)];
  board.config.clock_mhz = std::stod(board.mhz);
  board.config.latency_timer_clocks = static_cast<int>(below(below(2) == 0 ? 8 : 40));
  for (unsigned window = 0; window <= below(3); ++window) {
    board.config.windows.push_back({0x1000 * (1 + window), 0x1000, static_cast<int>(below(10))});
    board.read_clocks.push_back(static_cast<int>(below(20)));
  }
  const std::uint64_t period_ps = Clock(board.config.clock_mhz).edge_ps(1);
  board.masters.resize(1 + below(4));
  if (seed % 2 == 1) board.config.width_bits = 64;
  for (auto& requests : board.masters) {
    for (unsigned i = 0; i < 40; ++i) {
      const std::uint64_t gap = below(3) == 0   ? 0
                                : below(3) == 0 ? period_ps * below(30)
                                                : below(50) * 10'007;
      requests.push_back({gap, {below(2) == 0, 0x1000 * (1 + below(4)), 1 + below(60)}});
    }
  }
  return board;
}

// A master of the literal bus and the targets of its bursts.
class PlainScript : private test::PlainMaster, private test::PlainTarget {
 public:
  PlainScript(test::PlainEvents& events, test::PlainPciBus& bus, const Board& board, Log& log)
      : events_(events), bus_(bus), board_(board), log_(log), number_(bus.add(*this)) {
    await_request();
  }
  bool done() const { return next_ == board_.masters[number_].size(); }

 private:
  const Request& next() const { return board_.masters[number_][next_]; }
  std::size_t window() const { return next().script.address / 0x1000 - 1; }
  void await_request() {
    events_.at(events_.now() + next().gap_ps, test::PlainPhase::kEffects, [this] { bus_.request(number_); });
  }
  test::PlainBurst burst() override {
    line_ = log_.size();
    log_.push_back({events_.now(), number_, BurstEnd::kMasterAbort, 0, 0});
    const test::PlainWords words(next().script.words);
    if (window() >= board_.config.windows.size()) return {next().script.write, nullptr, 0, 0, words};
    return {next().script.write, this, board_.config.windows[window()].wait_clocks, 0, words};
  }
  void write(std::uint64_t /*word*/, const test::PlainWords& /*words*/) override {}
  void read(std::uint64_t /*word*/, std::size_t count, test::PlainTime end_ps,
            std::function<void(test::PlainWords)> answer) override {
    const test::PlainClock clock(test::plain_number(board_.mhz));
    const auto clocks = static_cast<std::uint64_t>(board_.read_clocks[window()]);
    events_.at(clock.edge(clock.first_edge(end_ps) + clocks), test::PlainPhase::kEffects,
               [count, answer] { answer(test::PlainWords(count)); });
  }
  void ended(const test::PlainWords& words) override {
    Line& line = log_[line_];
    line.words = words.size();
    line.end_ps = events_.now();
    if (line.words > 0)
      line.end = line.words == next().script.words ? BurstEnd::kComplete : BurstEnd::kLatencyTimer;
    ++next_;
    if (!done()) await_request();
  }

  test::PlainEvents& events_;
  test::PlainPciBus& bus_;
  const Board& board_;
  Log& log_;
  std::size_t number_;
  std::size_t next_ = 0;  // number of the next request
  std::size_t line_ = 0;  // line of the running burst in the log
};

struct Outcome {
  Log log;
  std::string text;
};

Outcome literal(const Board& board) {
  test::PlainEvents events;
  test::PlainPciBus bus(events, test::plain_number(board.mhz), board.config.latency_timer_clocks,
                        board.config.width_bits);
  Outcome outcome;
  std::deque<PlainScript> masters;
  for (std::size_t i = 0; i < board.masters.size(); ++i)
    masters.emplace_back(events, bus, board, outcome.log);
  while (!std::all_of(masters.begin(), masters.end(), [](const auto& master) { return master.done(); }))
    events.run_next();
  std::vector<test::PlainPciBus::MasterStats> stats;
  for (std::size_t i = 0; i < board.masters.size(); ++i) stats.push_back(bus.stats(i));
  outcome.text = text_of(outcome.log) + text_of(bus.busy_clocks(), stats);
  return outcome;
}

// Requests are made at their times, or announced when the burst before them has ended.
std::string modelled(const Board& board, bool announced) {
  PciBusBench bench(board.config, board.masters.size());
  for (std::size_t window = 0; window < board.config.windows.size(); ++window) {
    // Less than its clocks by what the rounding of edges can add.
    const auto clocks = static_cast<std::uint64_t>(board.read_clocks[window]);
    bench.targets[window]->read_delays = kernel_time::to_time(clocks == 0 ? 0 : bench.edge(clocks) - 1);
  }
  for (std::size_t i = 0; i < board.masters.size(); ++i) {
    TestMaster& master = *bench.masters[i];
    master.at_once = false;
    for (const Request& request : board.masters[i]) master.bursts.push_back(request.script);
    master.on_end = [&bench, &board, &master, announced, i] {
      if (master.bursts.empty()) return;
      const std::uint64_t gap_ps = board.masters[i][board.masters[i].size() - master.bursts.size()].gap_ps;
      if (announced || gap_ps == 0) {
        master.pci->request(master, kernel_time::now_ps() + gap_ps);
      } else {
        bench.at(gap_ps, [&master] { master.request(); });
      }
    };
    bench.request_at(board.masters[i][0].gap_ps, i);
  }
  sc_core::sc_start();
  Log log;
  for (std::size_t i = 0; i < board.masters.size(); ++i) {
    for (const auto& burst : bench.masters[i]->ended)
      log.push_back({burst.address_ps, i, burst.result.end, burst.result.words, burst.end_ps});
  }
  std::sort(log.begin(), log.end(), [](const Line& a, const Line& b) { return a.address_ps < b.address_ps; });
  const PciBus::Stats stats = bench.bus->stats();
  return text_of(log) + text_of(stats.busy_clocks, stats.masters);
}

constexpr unsigned kSeeds = 150;

TEST(PciBus, RunsAsTheLiteralBusOnRandomBoards) {
  std::vector<test::ChildWork> jobs;
  std::array<int, 3> ends{};
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    const Board board = random_board(seed);
    const Outcome expected = literal(board);
    for (const Line& line : expected.log) {
      ends[0] += line.end == BurstEnd::kComplete;
      ends[1] += line.end == BurstEnd::kLatencyTimer;
      ends[2] += line.end == BurstEnd::kMasterAbort;
    }
    for (const bool announced : {false, true}) {
      jobs.push_back([board, expected, announced]() -> std::string {
        const std::string found = modelled(board, announced);
        return found == expected.text ? "" : "expected\n" + expected.text + "found\n" + found;
      });
    }
  }
  for (const int count : ends) EXPECT_GT(count, 1000);  // every end of a burst occurs
  const auto results = test::run_in_children(jobs, 2);
  for (std::size_t i = 0; i < results.size(); ++i) {
    EXPECT_TRUE(results[i].ok()) << "seed " << i / 2 << (i % 2 == 0 ? ": " : ", announced: ")
                                 << results[i].text;
  }
}

}  // namespace
}  // namespace stereotlm::pci
