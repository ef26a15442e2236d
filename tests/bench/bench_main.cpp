// stereotlm_bench: how fast the simulation is. One thread, wall time. StereoBM runs beside it, so that
// figures of different machines can be compared by their ratio to it.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <cstdlib>
#include <functional>
#include <memory>
#include <opencv2/calib3d.hpp>
#include <stdexcept>
#include <string>
#include <systemc>
#include <vector>

#include "models/kernels/image_filter.h"
#include "models/kernels/image_loops.h"
#include "models/kernels/image_matcher.h"
#include "models/kernels/stereo.h"
#include "models/kernels/stereo_pipeline.h"
#include "tests/bench/bench_pair.h"
#include "tests/bench/board_process.h"

namespace stereotlm::bench {
namespace {

// A contended board has lists of one bank, so that every frame is contended, not only those of some buffers.
struct Case {
  std::string name;
  std::string board;
  std::vector<std::string> sets;
  bool contended = false;
};

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {"fpl2003", "fpl2003", {}},
      {"no_filter", "fpl2003", {"matcher.filter=none"}},
      {"line_buffer", "fpl2003-line-buffer", {}},
      {"left_lut_shared",
       "fpl2003",
       {"allocation.left_image=bank0", "allocation.right_image=bank2", "allocation.left_lut=bank0"},
       true},
      {"syncburst_result_shared",
       "fpl2003-syncburst",
       {"allocation.left_image=bank0", "allocation.right_image=bank2", "allocation.disparity=bank0"},
       true},
  };
  return all;
}

// One iteration is one frame.
void run_frames(benchmark::State& state, const Case& c, const host::StereoPair& pair) {
  BoardProcess board(c.board, c.sets, pair);
  board.run_frame();  // its pages are in memory now
  const BoardProcess::Count before = board.count();
  for (auto _ : state) board.run_frame();
  const BoardProcess::Count after = board.count();
  if (after.frames - before.frames != static_cast<std::uint64_t>(state.iterations())) {
    throw std::runtime_error("an iteration was not one frame");
  }
  if ((after.stalls > before.stalls) != c.contended) {
    throw std::runtime_error(c.name + ": stalls = " + std::to_string(after.stalls - before.stalls) +
                             (c.contended ? ": must be contended" : ": must not be contended"));
  }
  const auto rate = [](std::uint64_t count) {
    return benchmark::Counter(static_cast<double>(count), benchmark::Counter::kIsRate);
  };
  state.counters["frame_cycles"] = benchmark::Counter(static_cast<double>(after.cycles - before.cycles),
                                                      benchmark::Counter::kAvgIterations);
  state.counters["fpga_cycles"] = rate(after.cycles - before.cycles);
  state.counters["bank_accesses"] = rate(after.accesses - before.accesses);
}

void start(benchmark::State& state, const host::StereoPair& pair) {
  for (auto _ : state) state.SetIterationTime(BoardProcess("fpl2003", {}, pair).count().start_seconds);
}

cv::Mat view(const kernels::GrayImage& image) {
  // OpenCV has no read-only view; an input array is not written to.
  return {image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.pixels.data())};
}

void stereo_bm(benchmark::State& state, const host::StereoPair& pair) {
  const auto matcher = cv::StereoBM::create(80, 7);
  cv::Mat disparity;
  for (auto _ : state) matcher->compute(view(pair.left), view(pair.right), disparity);
}

void add(const std::string& name, const std::function<void(benchmark::State&)>& run) {
  benchmark::RegisterBenchmark(name.c_str(), run)->Unit(benchmark::kMillisecond)->UseRealTime();
}

// The arithmetic on whole images, part by part, with each instruction set of this machine.
void add_kernels(const host::StereoPair& pair) {
  const int width = pair.left.width;
  const int height = pair.left.height;
  const auto table = std::make_shared<kernels::RectificationTable>(kernels::identity_table(width, height));
  for (const kernels::ImageLoops* loops : kernels::image_loops()) {
    const std::string end = std::string("_") + loops->name;
    add("kernels/two_tables" + end, [=, &pair](benchmark::State& state) {
      kernels::GrayImage out(width, height);
      for (auto _ : state) {
        for (const auto* image : {&pair.left, &pair.right})
          loops->rectify(image->pixels.data(), table->entries.data(), width * height, width,
                         out.pixels.data());
      }
    });
    add("kernels/two_filters" + end, [=, &pair](benchmark::State& state) {
      kernels::ImageFilter filter(width, height, kernels::log7(), *loops);
      std::vector<std::uint8_t> out(pair.left.pixels.size() + kernels::ImageFilter::kPadding);
      for (auto _ : state) {
        for (const auto* image : {&pair.left, &pair.right}) filter.run(image->pixels.data(), out.data());
      }
    });
    add("kernels/match" + end, [=, &pair](benchmark::State& state) {
      kernels::ImageMatcher matcher(width, height, 7, 80, true, *loops);
      kernels::GrayImage left_based(width, height);
      kernels::GrayImage right_based(width, height);
      for (auto _ : state) {
        matcher.run(pair.left.pixels.data(), pair.right.pixels.data(), left_based.pixels.data(),
                    right_based.pixels.data());
      }
    });
    add("kernels/pipeline" + end, [=, &pair](benchmark::State& state) {
      kernels::StereoPipeline pipeline(width, height, {}, *loops);
      kernels::GrayImage out(width, height);
      for (auto _ : state) {
        pipeline.run(pair.left.pixels.data(), pair.right.pixels.data(), table->entries.data(),
                     table->entries.data(), out.pixels.data());
      }
    });
  }
  add("kernels/disparity_image", [=, &pair](benchmark::State& state) {
    for (auto _ : state)
      benchmark::DoNotOptimize(kernels::disparity_image(pair.left, pair.right, table.get(), table.get(), {}));
  });
}

int run(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  cv::setNumThreads(1);
  const BenchPair input = bench_pair(STEREOTLM_PICTURES);
  benchmark::AddCustomContext("pair", input.origin);
  benchmark::RegisterBenchmark("start/fpl2003", start, input.pair)
      ->Unit(benchmark::kMillisecond)
      ->UseManualTime();
  add("opencv/stereo_bm", [&input](benchmark::State& state) { stereo_bm(state, input.pair); });
  add_kernels(input.pair);
  for (const Case& c : cases())
    add("frame/" + c.name, [&c, &input](benchmark::State& state) { run_frames(state, c, input.pair); });
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}

}  // namespace
}  // namespace stereotlm::bench

int sc_main(int argc, char** argv) { return stereotlm::bench::run(argc, argv); }

// Takes the place of libsystemc's own main, which prints the copyright banner before sc_main can turn it off.
int main(int argc, char** argv) {
  setenv("SYSTEMC_DISABLE_COPYRIGHT_MESSAGE", "1", 1);
  return sc_core::sc_elab_and_sim(argc, argv);
}
