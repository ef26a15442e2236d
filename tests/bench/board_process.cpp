#include "tests/bench/board_process.h"

#include <chrono>
#include <functional>
#include <limits>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <systemc>

#include "models/binder.h"
#include "platform/config/board_yaml.h"
#include "platform/figures/statistics.h"
#include "sw/runs/simulation/simulation.h"

namespace stereotlm::bench {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

class OnePair : public host::FrameSource {
 public:
  explicit OnePair(const host::StereoPair& pair) : pair_(pair) {}
  const host::StereoPair& pair(std::uint64_t /*frame*/) override { return pair_; }

 private:
  const host::StereoPair& pair_;
};

// A process can elaborate only one board.
class SteppedBoard {
 public:
  SteppedBoard(const BoardProcess::Setting& setting, const host::StereoPair& pair)
      : config_(platform::load_board(setting.board, setting.sets)),
        tables_(setting.tables != nullptr ? *setting.tables : platform::identity_tables(config_)),
        pair_(pair),
        simulation_(runs::make_simulation(
            config_, tables_, pair_,
            {setting.camera, setting.fidelity, std::numeric_limits<std::uint64_t>::max()}, binder_)) {
    if (fpga::steps_cycles(setting.fidelity)) sc_core::sc_start(sc_core::SC_ZERO_TIME);
  }

  void run(const std::function<void()>& between) { simulation_->run(between); }

  // For a board without computer: a computer is seldom between two frames.
  BoardProcess::Count count() const {
    const platform::Statistics found = simulation_->statistics();
    if (!found.failed.empty()) throw std::runtime_error(found.failed.front());
    BoardProcess::Count count;
    count.cycles = std::accumulate(found.frame_cycles.begin(), found.frame_cycles.end(), std::uint64_t{0});
    for (const platform::BankStatistics& bank : found.banks) count.accesses += bank.reads + bank.writes;
    for (const platform::PortStatistics& port : found.ports) count.stalls += port.stall_cycles;
    return count;
  }
  std::uint64_t frames() const { return simulation_->frames_done(); }

 private:
  platform::BoardConfig config_;
  platform::Tables tables_;
  OnePair pair_;
  Binder binder_;
  std::unique_ptr<runs::Simulation> simulation_;
};

struct NoMoreOrders {};

// Sends the counts at the start and after each order, until the parent closes its end.
void serve(const BoardProcess::Setting& setting, const host::StereoPair& pair, int orders,
           const process::Child::Tell& tell) {
  const auto send = [&tell](const BoardProcess::Count& count) {
    tell({reinterpret_cast<const char*>(&count), sizeof count});
  };
  const auto start = std::chrono::steady_clock::now();
  SteppedBoard board(setting, pair);
  BoardProcess::Count ready;
  ready.start_seconds = seconds_since(start);
  send(ready);
  std::uint64_t end = 0;  // frames with which the order is done
  auto begin = start;     // of the order
  const auto receive = [&] {
    std::uint32_t frames = 0;
    if (!process::read_all(orders, &frames, sizeof frames)) throw NoMoreOrders();
    end = board.frames() + frames;
    begin = std::chrono::steady_clock::now();
  };
  try {
    receive();
    board.run([&] {
      if (board.frames() < end) return;
      const double seconds = seconds_since(begin);
      BoardProcess::Count count;
      if (!setting.camera) count = board.count();
      count.frames = board.frames();
      count.seconds = seconds;
      send(count);
      receive();
    });
  } catch (const NoMoreOrders& /*end*/) {
    // the parent has what it needs
  }
}

}  // namespace

BoardProcess::BoardProcess(const Setting& setting, const host::StereoPair& pair)
    : child_([&](const process::Child::Tell& tell) {
        orders_.close_write_end();
        serve(setting, pair, orders_.read_end(), tell);
      }) {
  orders_.close_read_end();
  receive_count();
}

void BoardProcess::run_frames(std::uint32_t frames) {
  process::write_all(orders_.write_end(), &frames, sizeof frames);
  receive_count();
}

void BoardProcess::receive_count() {
  const auto message = child_.next();
  if (!message) throw std::runtime_error("the board's process has ended");
  message->copy(reinterpret_cast<char*>(&count_), sizeof count_);
}

}  // namespace stereotlm::bench
