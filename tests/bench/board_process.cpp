#include "tests/bench/board_process.h"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <exception>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <system_error>
#include <systemc>

#include "platform/config/board_yaml.h"
#include "platform/statistics.h"
#include "sw/runs/simulation/make_simulation.h"

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

// The one board of a process.
class SteppedBoard {
 public:
  SteppedBoard(const BoardProcess::Setting& setting, const host::StereoPair& pair)
      : config_(platform::load_board(setting.board, setting.sets)),
        tables_(setting.tables != nullptr ? *setting.tables : platform::identity_tables(config_)),
        pair_(pair),
        simulation_(runs::make_simulation(
            config_, tables_, pair_,
            {setting.camera, setting.fidelity, std::numeric_limits<std::uint64_t>::max()}, binder_)) {
    if (setting.fidelity == fpga::Fidelity::kCycle) sc_core::sc_start(sc_core::SC_ZERO_TIME);
  }

  void run_frames(std::uint32_t frames) {
    for (const std::uint64_t end = simulation_->frames_done() + frames; simulation_->frames_done() < end;)
      simulation_->advance();
  }

  // The board alone; a computer is seldom between two frames.
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

// Until the parent wants no more frames.
void serve(const BoardProcess::Setting& setting, const host::StereoPair& pair, int orders, int counts) {
  const auto tell = [counts](const BoardProcess::Count& count) {
    if (write(counts, &count, sizeof count) != sizeof count) throw std::runtime_error("nobody listens");
  };
  const auto start = std::chrono::steady_clock::now();
  SteppedBoard board(setting, pair);
  BoardProcess::Count ready;
  ready.start_seconds = seconds_since(start);
  tell(ready);
  for (std::uint32_t frames = 0; read(orders, &frames, sizeof frames) == sizeof frames;) {
    const auto begin = std::chrono::steady_clock::now();
    board.run_frames(frames);
    const double seconds = seconds_since(begin);
    BoardProcess::Count count;
    if (!setting.camera) count = board.count();
    count.frames = board.frames();
    count.seconds = seconds;
    tell(count);
  }
}

std::array<int, 2> make_pipe() {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
  return ends;
}

}  // namespace

BoardProcess::BoardProcess(const Setting& setting, const host::StereoPair& pair) {
  const std::array<int, 2> orders = make_pipe();
  const std::array<int, 2> counts = make_pipe();
  child_ = fork();
  if (child_ < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (child_ == 0) {
    close(orders[1]);
    close(counts[0]);
    try {
      serve(setting, pair, orders[0], counts[1]);
    } catch (const std::exception& exception) {
      std::fprintf(stderr, "%s: %s\n", setting.board.c_str(), exception.what());
      _exit(1);
    }
    _exit(0);
  }
  close(orders[0]);
  close(counts[1]);
  orders_ = orders[1];
  counts_ = counts[0];
  read_count();
}

BoardProcess::~BoardProcess() {
  close(orders_);
  close(counts_);
  waitpid(child_, nullptr, 0);
}

void BoardProcess::run_frames(std::uint32_t frames) {
  if (write(orders_, &frames, sizeof frames) != sizeof frames)
    throw std::runtime_error("the board's process has ended");
  read_count();
}

void BoardProcess::read_count() {
  Count count;
  if (read(counts_, &count, sizeof count) != sizeof count) {
    throw std::runtime_error("the board's process has ended");
  }
  count_ = count;
}

}  // namespace stereotlm::bench
