#pragma once

#include <cstdint>
#include <systemc>

#include "models/testing/monitoring_binder.h"
#include "platform/assembly/preloaded_system.h"
#include "platform/figures/collect.h"

namespace stereotlm::platform::testing {

constexpr std::uint64_t kPipeline = 16;  // cycles

// A small board without contention: 16 x 6 pixels, 3 x 3 windows, three disparities, no filter.
inline BoardConfig small_board() {
  BoardConfig board;
  board.image = {16, 6};
  board.matcher.window = 3;
  board.matcher.disparities = 3;
  board.matcher.filter.reset();
  for (BankConfig& bank : board.banks) bank.words = 1024;
  return board;
}

// Grey pictures; what is in them has no influence on the timing.
class GreyPictures : public host::FrameSource {
 public:
  explicit GreyPictures(const BoardConfig& board) {
    pair_.left = kernels::GrayImage(board.image.width, board.image.height, 50);
    pair_.right = kernels::GrayImage(board.image.width, board.image.height, 60);
  }
  const host::StereoPair& pair(std::uint64_t /*frame*/) override { return pair_; }

 private:
  host::StereoPair pair_;
};

class NoSink : public host::FrameSink {
  void take(std::uint64_t /*frame*/, const kernels::GrayImage& /*disparity*/) override {}
};

// A board with its ideal host, every link under a monitor. One per process.
struct PreloadedRun {
  PreloadedRun(const BoardConfig& board_config, const Tables& board_tables, std::uint64_t frames)
      : config(board_config),
        tables(board_tables),
        pictures(config),
        system("system", config, tables, frames, pictures, sink, binder) {}

  Statistics collect() const { return collect_statistics(config, tables, system.board); }
  Statistics finish() {
    sc_core::sc_start();
    return collect();
  }

  BoardConfig config;
  Tables tables;
  GreyPictures pictures;
  NoSink sink;
  test::MonitoringBinder binder;
  PreloadedSystem system;
};

}  // namespace stereotlm::platform::testing
