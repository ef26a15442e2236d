#include <gtest/gtest.h>

#include <array>
#include <random>
#include <sstream>

#include "tests/support/fork.h"
#include "tests/unit/pci/pci_bus_bench.h"

// The bus, which computes a burst at once, against a loop over its clocks.
namespace stereotlm::pci {
namespace {

struct Request {
  std::uint64_t gap_ps;  // after the end of the master's last burst
  Script script;
};
struct Board {
  PciBusConfig config;
  std::vector<int> read_clocks;  // [window]: what its target takes for a read
  std::vector<std::vector<Request>> masters;
};
// One burst: when, how it ended, and with how many words.
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

Board random_board(unsigned seed) {
  std::mt19937 random(seed);
  const auto below = [&random](unsigned end) { return static_cast<unsigned>(random() % end); };
  Board board;
  board.config.clock_mhz = std::array<double, 4>{33.333, 66.667, 40, 29.97}[below(4)];
  board.config.latency_timer_clocks = static_cast<int>(below(below(2) == 0 ? 8 : 40));
  for (unsigned window = 0; window <= below(3); ++window) {
    board.config.windows.push_back({0x1000 * (1 + window), 0x1000, static_cast<int>(below(10))});
    board.read_clocks.push_back(static_cast<int>(below(20)));
  }
  const std::uint64_t period_ps = Clock(board.config.clock_mhz).edge_ps(1);
  board.masters.resize(1 + below(4));
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

// Clock by clock, with the rules of the contract written down again.
class PlainBus {
 public:
  explicit PlainBus(const Board& board) : board_(board), masters_(board.masters.size()) {
    for (std::size_t i = 0; i < masters_.size(); ++i) masters_[i].request_ps = board.masters[i][0].gap_ps;
    last_ = masters_.size() - 1;
  }
  Log run() {
    for (; running() > 0; ++now_) {
      if (owner_ != kNobody) {
        step_burst();
      } else if (now_ >= earliest_address_clock_) {
        step_idle();
      }
    }
    return log_;
  }

 private:
  static constexpr std::size_t kNobody = SIZE_MAX;
  struct Master {
    std::size_t next = 0;  // request
    std::uint64_t request_ps = 0;
  };

  std::size_t running() const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < masters_.size(); ++i) count += masters_[i].next < board_.masters[i].size();
    return count;
  }
  bool waits(std::size_t i) const {
    return i != owner_ && masters_[i].next < board_.masters[i].size() &&
           masters_[i].request_ps <= clock_.edge_ps(now_);
  }
  const Script& script() const { return board_.masters[owner_][masters_[owner_].next].script; }

  void step_idle() {
    for (std::size_t i = 1; i <= masters_.size() && owner_ == kNobody; ++i) {
      const std::size_t candidate = (last_ + i) % masters_.size();
      if (waits(candidate)) owner_ = candidate;
    }
    if (owner_ == kNobody) return;
    last_ = owner_;
    age_ = 0;
    const std::size_t window = script().address / 0x1000 - 1;
    has_target_ = window < board_.config.windows.size();
    if (has_target_) {
      const int wait_clocks = board_.config.windows[window].wait_clocks;
      first_word_ = 1 + (script().write ? wait_clocks : std::max(wait_clocks, board_.read_clocks[window]));
    }
    log_.push_back({clock_.edge_ps(now_), owner_, BurstEnd::kMasterAbort, 0, 0});
  }

  void step_burst() {
    ++age_;
    if (has_target_ ? transfer() : age_ == 4) end_burst();
  }

  // Whether the burst ends with this clock.
  bool transfer() {
    if (age_ < first_word_) return false;
    Line& line = log_.back();
    const bool all = ++line.words == script().words;
    line.end = all ? BurstEnd::kComplete : BurstEnd::kLatencyTimer;
    bool other_waits = false;
    for (std::size_t i = 0; i < masters_.size(); ++i) other_waits = other_waits || waits(i);
    return all || (other_waits && age_ >= board_.config.latency_timer_clocks);
  }

  void end_burst() {
    Line& line = log_.back();
    line.end_ps = clock_.edge_ps(now_ + 1);
    earliest_address_clock_ = now_ + 2;
    Master& master = masters_[owner_];
    const auto& requests = board_.masters[owner_];
    if (++master.next < requests.size()) master.request_ps = line.end_ps + requests[master.next].gap_ps;
    owner_ = kNobody;
  }

  const Board& board_;
  Clock clock_{board_.config.clock_mhz};
  std::vector<Master> masters_;
  std::size_t last_ = 0;
  std::size_t owner_ = kNobody;
  std::uint64_t now_ = 0;
  std::uint64_t earliest_address_clock_ = 0;
  bool has_target_ = false;
  int age_ = 0;         // of the burst, in clocks
  int first_word_ = 0;  // age
  Log log_;
};

// Requests are made at their times, or announced when the burst before them has ended.
Log model_log(const Board& board, bool announced) {
  PciBusBench bench(board.config, board.masters.size());
  for (std::size_t window = 0; window < board.config.windows.size(); ++window) {
    const Clock clock(board.config.clock_mhz);
    // Less than its clocks by what the rounding of edges can add.
    const auto clocks = static_cast<std::uint64_t>(board.read_clocks[window]);
    const std::uint64_t time_ps = clocks == 0 ? 0 : clock.edge_ps(clocks) - 1;
    bench.targets[window]->read_delays = Clock::to_time(time_ps);
  }
  for (std::size_t i = 0; i < board.masters.size(); ++i) {
    TestMaster& master = *bench.masters[i];
    master.at_once = false;
    for (const Request& request : board.masters[i]) master.bursts.push_back(request.script);
    master.on_end = [&bench, &board, &master, announced, i] {
      if (master.bursts.empty()) return;
      const std::uint64_t gap_ps = board.masters[i][board.masters[i].size() - master.bursts.size()].gap_ps;
      if (gap_ps == 0) {
        master.request();
      } else if (announced) {
        master.pci->request(master, Clock::to_ps(sc_core::sc_time_stamp()) + gap_ps);
      } else {
        bench.at(gap_ps, [&master] { master.request(); });
      }
    };
    bench.request_at(board.masters[i][0].gap_ps, i);
  }
  sc_core::sc_start();
  Log log;
  for (std::size_t i = 0; i < board.masters.size(); ++i) {
    for (const auto& burst : bench.masters[i]->ended) {
      log.push_back({burst.address_ps, i, burst.result.end, burst.result.words, burst.end_ps});
    }
  }
  std::sort(log.begin(), log.end(), [](const Line& a, const Line& b) { return a.address_ps < b.address_ps; });
  std::uint64_t busy = 0;
  const Clock clock(board.config.clock_mhz);
  for (const Line& line : log)
    busy += clock.edge_at_or_after(line.end_ps) - clock.edge_at_or_after(line.address_ps);
  EXPECT_EQ(bench.bus->stats().busy_clocks, busy);
  EXPECT_TRUE(bench.binder.violations().empty());
  return log;
}

constexpr unsigned kSeeds = 150;

TEST(PciBus, MeetsEveryEndOfABurstOnRandomBoards) {
  std::array<int, 3> ends{};
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    const Board board = random_board(seed);
    for (const Line& line : PlainBus(board).run()) {
      ends[0] += line.end == BurstEnd::kComplete;
      ends[1] += line.end == BurstEnd::kLatencyTimer;
      ends[2] += line.end == BurstEnd::kMasterAbort;
    }
  }
  for (const int count : ends) EXPECT_GT(count, 1000);
}

TEST(PciBus, DoesAsALoopOverItsClocksOnRandomBoards) {
  std::vector<test::ChildWork> jobs;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    for (const bool announced : {false, true}) {
      jobs.push_back([seed, announced]() -> std::string {
        const Board board = random_board(seed);
        const std::string expected = text_of(PlainBus(board).run());
        const std::string found = text_of(model_log(board, announced));
        return found == expected ? "" : "expected\n" + expected + "found\n" + found;
      });
    }
  }
  const auto results = test::run_in_children(jobs, 2);
  for (std::size_t i = 0; i < results.size(); ++i) {
    EXPECT_TRUE(results[i].ok()) << "seed " << i / 2 << (i % 2 == 0 ? ": " : ", announced: ")
                                 << results[i].text;
  }
}

}  // namespace
}  // namespace stereotlm::pci
