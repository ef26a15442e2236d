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

#include "platform/board_yaml.h"
#include "platform/collect.h"
#include "platform/preloaded_system.h"
#include "platform/statistics.h"
#include "platform/tables.h"

namespace stereotlm::bench {
namespace {

// The one board of a process.
class SteppedBoard : private host::FrameSource, private host::FrameSink {
 public:
  SteppedBoard(const std::string& board, const std::vector<std::string>& sets, const host::StereoPair& pair)
      : config_(platform::load_board(board, sets)),
        tables_(platform::identity_tables(config_)),
        pair_(pair),
        system_("system", config_, tables_, std::numeric_limits<std::uint64_t>::max(), *this, *this,
                binder_) {
    sc_core::sc_start();
  }

  void run_frame() {
    go_.notify(sc_core::SC_ZERO_TIME);
    sc_core::sc_start();
  }

  BoardProcess::Count count() const {
    const platform::Statistics found = platform::collect_statistics(config_, tables_, system_.board);
    if (!found.failed.empty()) throw std::runtime_error(found.failed.front());
    BoardProcess::Count count;
    count.frames = found.frames;
    count.cycles = std::accumulate(found.frame_cycles.begin(), found.frame_cycles.end(), std::uint64_t{0});
    for (const platform::BankStatistics& bank : found.banks) count.accesses += bank.reads + bank.writes;
    for (const platform::PortStatistics& port : found.ports) count.stalls += port.stall_cycles;
    return count;
  }

 private:
  // Called by the host's thread, which waits here until the next frame is wanted.
  const host::StereoPair& pair(std::uint64_t /*frame*/) override {
    sc_core::wait(go_);
    return pair_;
  }
  void take(std::uint64_t /*frame*/, const kernels::GrayImage& /*disparity*/) override {
    sc_core::sc_pause();
  }

  platform::BoardConfig config_;
  platform::Tables tables_;
  const host::StereoPair& pair_;
  Binder binder_;
  sc_core::sc_event go_{"go"};
  platform::PreloadedSystem system_;
};

// Until the parent wants no more frames.
void serve(const std::string& name, const std::vector<std::string>& sets, const host::StereoPair& pair,
           int orders, int counts) {
  const auto tell = [counts](const BoardProcess::Count& count) {
    if (write(counts, &count, sizeof count) != sizeof count) throw std::runtime_error("nobody listens");
  };
  const auto start = std::chrono::steady_clock::now();
  SteppedBoard board(name, sets, pair);
  BoardProcess::Count ready;
  ready.start_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  tell(ready);
  for (char order = 0; read(orders, &order, 1) == 1;) {
    board.run_frame();
    tell(board.count());
  }
}

std::array<int, 2> make_pipe() {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
  return ends;
}

}  // namespace

BoardProcess::BoardProcess(const std::string& board, const std::vector<std::string>& sets,
                           const host::StereoPair& pair) {
  const std::array<int, 2> orders = make_pipe();
  const std::array<int, 2> counts = make_pipe();
  child_ = fork();
  if (child_ < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (child_ == 0) {
    close(orders[1]);
    close(counts[0]);
    try {
      serve(board, sets, pair, orders[0], counts[1]);
    } catch (const std::exception& exception) {
      std::fprintf(stderr, "%s: %s\n", board.c_str(), exception.what());
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

void BoardProcess::run_frame() {
  const char order = 1;
  if (write(orders_, &order, 1) != 1) throw std::runtime_error("the board's process has ended");
  read_count();
}

void BoardProcess::read_count() {
  if (read(counts_, &count_, sizeof count_) != sizeof count_) {
    throw std::runtime_error("the board's process has ended");
  }
}

}  // namespace stereotlm::bench
