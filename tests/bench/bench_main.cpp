// stereotlm_bench measures how fast the simulation is: one thread, wall time. StereoBM runs beside it, so
// that figures of different machines can be compared as ratios.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <systemc>
#include <vector>

#include "calib/opencv_conversions.h"
#include "calib/tables.h"
#include "models/binder.h"
#include "models/kernels/image_filter.h"
#include "models/kernels/image_matcher.h"
#include "models/kernels/simd.h"
#include "models/kernels/stereo.h"
#include "models/kernels/stereo_pipeline.h"
#include "platform/config/board_yaml.h"
#include "sw/demo/half_size.h"
#include "sw/files/whole_file.h"
#include "sw/media/load.h"
#include "sw/process/child.h"
#include "sw/runs/simulation/simulation.h"
#include "sw/runs/sources/open_source.h"
#include "sw/stats/stats_json.h"
#include "tests/bench/board_process.h"

namespace stereotlm::bench {
namespace {

using fpga::Fidelity;
using kernels::GrayImage;

struct BenchPair {
  host::StereoPair pair;  // 640x480
  std::string origin;     // "aloe" or "random texture"
};

constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr int kShift = 20;  // columns

host::StereoPair random_texture() {
  std::mt19937 random(1);
  GrayImage wide(kWidth + kShift, kHeight);
  for (auto& pixel : wide.pixels) pixel = static_cast<std::uint8_t>(random());
  host::StereoPair pair{GrayImage(kWidth, kHeight), GrayImage(kWidth, kHeight)};
  for (int row = 0; row < kHeight; ++row) {
    for (int column = 0; column < kWidth; ++column) {
      pair.left.at(column, row) = wide.at(column, row);
      pair.right.at(column, row) = wide.at(column + kShift, row);
    }
  }
  return pair;
}

// The pair of ./demo, made from the pictures in `folder`. Without these pictures it is a random texture and a
// copy that is shifted by 20 columns.
BenchPair bench_pair(const std::string& folder) {
  const std::filesystem::path pictures(folder);
  if (!std::filesystem::exists(pictures / "aloeL.jpg")) return {random_texture(), "random texture"};
  const auto side = [&pictures](const char* name) {
    return demo::middle_at_half_size(media::load_gray((pictures / name).string()).image);
  };
  return {{side("aloeL.jpg"), side("aloeR.jpg")}, "aloe"};
}

// The buffers of a contended board lie in one bank each, so that every frame is contended.
struct Case {
  std::string name;
  std::string board;
  std::vector<std::string> sets;
  bool contended = false;
};

// Puts the five buffers of a frame into one bank that is large enough for them.
std::vector<std::string> one_bank(std::vector<std::string> sets) {
  sets.emplace_back("ssram.default.words=1048576");
  for (const char* buffer : {"left_image", "right_image", "disparity", "left_lut", "right_lut"})
    sets.push_back(std::string("allocation.") + buffer + "=bank0");
  return sets;
}

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
      {"one_bank", "fpl2003", one_bank({}), true},
      {"one_bank_in_turn", "fpl2003-syncburst", one_bank({"fpga.arbitration=round_robin"}), true},
  };
  return all;
}

// Whole computers. `contended` is not checked.
const std::vector<Case>& computers() {
  static const std::vector<Case> all = {
      {"fpl2003", "fpl2003", {}},
      {"left_captures_shared", "fpl2003", {"allocation.left_image=[bank6, bank7]"}},
      {"four_banks",
       "fpl2003",
       {"allocation.left_image=[bank0, bank0]", "allocation.right_image=[bank1, bank1]",
        "allocation.disparity=[bank2, bank2]", "allocation.left_lut=bank3", "allocation.right_lut=bank2"}},
      {"one_bank",
       "fpl2003",
       {"ssram.default.words=2097152", "allocation.left_image=[bank0, bank0]",
        "allocation.right_image=[bank0, bank0]", "allocation.disparity=[bank0, bank0]",
        "allocation.left_lut=bank0", "allocation.right_lut=bank0"}},
      {"wvga-60hz", "wvga-60hz", {}},
      {"megapixel-pci64", "megapixel-pci64", {}},
  };
  return all;
}

// The pair in the size of the board's pictures.
host::StereoPair of_size(const host::StereoPair& pair, const Case& c) {
  const platform::ImageConfig size = platform::load_board(c.board, c.sets).image;
  const auto sized = [&size](const kernels::GrayImage& image) {
    kernels::GrayImage found(size.width, size.height);
    cv::Mat out(size.height, size.width, CV_8UC1, found.pixels.data());
    cv::resize(calib::view(image), out, out.size());
    return found;
  };
  return {sized(pair.left), sized(pair.right)};
}

// OpenCV's matcher on the same pair.
class StereoBm {
 public:
  explicit StereoBm(const host::StereoPair& pair)
      : left_(calib::view(pair.left)), right_(calib::view(pair.right)) {}
  void run() { matcher_->compute(left_, right_, disparity_); }
  double seconds() {
    const auto start = std::chrono::steady_clock::now();
    run();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

 private:
  cv::Ptr<cv::StereoBM> matcher_ = cv::StereoBM::create(80, 7);
  cv::Mat left_;
  cv::Mat right_;
  cv::Mat disparity_;
};

void stereo_bm(benchmark::State& state, const host::StereoPair& pair) {
  StereoBm matcher(pair);
  for (auto _ : state) matcher.run();
}

// An iteration simulates enough frames to last some milliseconds; frame_ms is the time of one. StereoBM runs
// between iterations (at kTiming before every 16th), so that other load on the machine slows down both.
// `ratio`: the time of a frame, divided by that of StereoBM.
void run_frames(benchmark::State& state, const Case& c, const BoardProcess::Setting& setting,
                const host::StereoPair& pair) {
  const std::uint32_t frames = setting.fidelity == Fidelity::kTiming ? 20
                               : setting.fidelity == Fidelity::kFast ? 5
                                                                     : 1;
  BoardProcess board(setting, pair);
  board.run_frames(1);  // brings its pages into memory
  const BoardProcess::Count before = board.count();
  double seconds = 0;
  StereoBm matcher(pair);
  matcher.run();
  double matcher_seconds = 0;
  std::uint64_t matched = 0;
  std::uint64_t iteration = 0;
  for (auto _ : state) {
    if (iteration++ % (setting.fidelity == Fidelity::kTiming ? 16 : 1) == 0) {
      matcher_seconds += matcher.seconds();
      ++matched;
    }
    board.run_frames(frames);
    state.SetIterationTime(board.count().seconds);
    seconds += board.count().seconds;
  }
  const double frame_seconds = seconds / static_cast<double>(board.count().frames - before.frames);
  state.counters["frame_ms"] = benchmark::Counter(1e3 * frame_seconds);
  state.counters["ratio"] =
      benchmark::Counter(frame_seconds * static_cast<double>(matched) / matcher_seconds);
  if (setting.camera) return;
  const BoardProcess::Count after = board.count();
  if ((after.stalls > before.stalls) != c.contended) {
    throw std::runtime_error(c.name + ": stalls = " + std::to_string(after.stalls - before.stalls) +
                             (c.contended ? ": must be contended" : ": must not be contended"));
  }
  const auto a_frame = [frames = static_cast<double>(after.frames - before.frames)](std::uint64_t count) {
    return benchmark::Counter(static_cast<double>(count) / frames);
  };
  state.counters["frame_cycles"] = a_frame(after.cycles - before.cycles);
  state.counters["frame_accesses"] = a_frame(after.accesses - before.accesses);
}

void start(benchmark::State& state, const host::StereoPair& pair) {
  for (auto _ : state) state.SetIterationTime(BoardProcess({"fpl2003", {}}, pair).count().start_seconds);
}

// A point of a sweep: a child of this process simulates a frame without pixels, and sends its statistics.
void run_point(benchmark::State& state, const std::vector<std::string>& sets, bool camera) {
  for (auto _ : state) {
    process::Child child([&](const process::Child::Tell& tell) {
      const platform::BoardConfig board = platform::load_board("fpl2003", sets);
      const platform::Tables tables = platform::identity_tables(board);
      const auto pairs = runs::blank_pairs(board);
      Binder binder;
      const auto run = runs::make_simulation(board, tables, *pairs, {camera, Fidelity::kTiming, 1}, binder);
      run->run([] {});
      tell(stats::stats_json(run->statistics(), std::nullopt));
    });
    while (child.next()) {
    }
  }
}

void add(const std::string& name, const std::function<void(benchmark::State&)>& run) {
  benchmark::RegisterBenchmark(name.c_str(), run)->Unit(benchmark::kMillisecond)->UseRealTime();
}

// Every cost, with what it adds to the names of benchmarks.
const std::vector<std::pair<std::string, kernels::MatchingCost>>& costs() {
  using kernels::CostKind;
  static const std::vector<std::pair<std::string, kernels::MatchingCost>> all = {
      {"", {}},
      {"_ssd", {CostKind::kSsd, 0}},
      {"_zncc", {CostKind::kZncc, 0}},
      {"_census3", {CostKind::kCensus, 3}},
      {"_census5", {CostKind::kCensus, 5}},
      {"_census7", {CostKind::kCensus, 7}}};
  return all;
}

// The arithmetic on whole images, part by part, with each instruction set of this machine.
void add_kernels(const host::StereoPair& pair) {
  const int width = pair.left.width;
  const int height = pair.left.height;
  const auto table = std::make_shared<kernels::RectificationTable>(kernels::identity_table(width, height));
  for (const kernels::Simd* simd : kernels::simd_sets()) {
    const std::string end = std::string("_") + simd->name;
    add("kernels/two_tables" + end, [=, &pair](benchmark::State& state) {
      kernels::GrayImage out(width, height);
      for (auto _ : state) {
        for (const auto* image : {&pair.left, &pair.right})
          simd->rectify(image->pixels.data(), table->entries.data(), width * height, width,
                        out.pixels.data());
      }
    });
    add("kernels/two_filters" + end, [=, &pair](benchmark::State& state) {
      kernels::ImageFilter filter(width, height, kernels::log7(), *simd);
      std::vector<std::uint8_t> out(pair.left.pixels.size() + kernels::ImageFilter::kPadding);
      for (auto _ : state) {
        for (const auto* image : {&pair.left, &pair.right}) filter.run(image->pixels.data(), out.data());
      }
    });
    add("kernels/match" + end, [=, &pair](benchmark::State& state) {
      kernels::ImageMatcher matcher(width, height, 7, 80, true, {}, *simd);
      kernels::GrayImage left_based(width, height);
      kernels::GrayImage right_based(width, height);
      for (auto _ : state) {
        matcher.run(pair.left.pixels.data(), pair.right.pixels.data(), left_based.pixels.data(),
                    right_based.pixels.data());
      }
    });
    const auto add_pipeline = [=, &pair](const std::string& name, const kernels::StereoConfig& config) {
      add("kernels/pipeline" + name + end, [=, &pair](benchmark::State& state) {
        kernels::StereoPipeline pipeline(width, height, config, *simd);
        kernels::GrayImage out(width, height);
        for (auto _ : state) {
          pipeline.run(pair.left.pixels.data(), pair.right.pixels.data(), table->entries.data(),
                       table->entries.data(), out.pixels.data());
        }
      });
    };
    kernels::StereoConfig config;
    for (const auto& [name, cost] : costs()) {
      config.cost = cost;
      add_pipeline(name, config);
    }
    config.cost = {kernels::CostKind::kZncc, 0};
    config.window = 31;
    add_pipeline("_zncc_31", config);
  }
  add("kernels/disparity_image", [=, &pair](benchmark::State& state) {
    for (auto _ : state)
      benchmark::DoNotOptimize(kernels::disparity_image(pair.left, pair.right, table.get(), table.get(), {}));
  });
}

void add_timed(const std::string& name, const std::function<void(benchmark::State&)>& run) {
  benchmark::RegisterBenchmark(name.c_str(), run)->Unit(benchmark::kMillisecond)->UseManualTime();
}

void add_frames(const host::StereoPair& pair, const platform::Tables* rig_tables) {
  const std::vector<std::pair<std::string, Fidelity>> fidelities = {{"fast", Fidelity::kFast},
                                                                    {"timing", Fidelity::kTiming},
                                                                    {"cycle_timing", Fidelity::kCycleTiming},
                                                                    {"cycle", Fidelity::kCycle}};
  for (const auto& [fidelity_name, fidelity] : fidelities) {
    const auto add_case = [&, fidelity = fidelity](const std::string& name, const Case& c,
                                                   const platform::Tables* tables, bool camera) {
      add_timed(name, [=, &pair](benchmark::State& state) {
        run_frames(state, c, {c.board, c.sets, tables, camera, fidelity}, of_size(pair, c));
      });
    };
    const Case& usual = cases().front();
    if (fidelity == Fidelity::kCycleTiming) {
      add_case("frame_" + fidelity_name + '/' + usual.name, usual, nullptr, false);
      continue;
    }
    for (const Case& c : cases()) add_case("frame_" + fidelity_name + '/' + c.name, c, nullptr, false);
    if (rig_tables != nullptr) add_case("frame_" + fidelity_name + "/rig", usual, rig_tables, false);
    for (const Case& c : computers()) add_case("computer_" + fidelity_name + '/' + c.name, c, nullptr, true);
  }
}

// The value of `option`, which leaves the command line; empty without it.
std::string take_option(const std::string& option, int& argc, char** argv) {
  char** const found = std::find(argv + 1, argv + argc, option);
  if (found + 1 >= argv + argc) return {};
  const std::string value = found[1];
  std::copy(found + 2, argv + argc, found);
  argc -= 2;
  return value;
}

// The tables that `--left-lut F --right-lut F` name, of images of 640x480.
std::optional<platform::Tables> take_tables(int& argc, char** argv) {
  const std::string left = take_option("--left-lut", argc, argv);
  const std::string right = take_option("--right-lut", argc, argv);
  if (left.empty() || right.empty()) return std::nullopt;
  const auto table = [](const std::string& file) {
    return calib::parse_lut(files::read_whole_file(file), 640, 480);
  };
  return platform::Tables{table(left), table(right)};
}

int run(int argc, char** argv) {
  const std::optional<platform::Tables> rig_tables = take_tables(argc, argv);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  cv::setNumThreads(1);
  const BenchPair input = bench_pair(STEREOTLM_PICTURES);
  benchmark::AddCustomContext("pair", input.origin);
  benchmark::AddCustomContext("vectors", kernels::best_simd().name);
  add_timed("start/fpl2003", [&input](benchmark::State& state) { start(state, input.pair); });
  add("opencv/stereo_bm", [&input](benchmark::State& state) { stereo_bm(state, input.pair); });
  add_kernels(input.pair);
  add_frames(input.pair, rig_tables ? &*rig_tables : nullptr);
  const std::vector<std::string> small = {"image.width=160", "image.height=120"};
  add("point/fpl2003", [](benchmark::State& state) { run_point(state, {}, false); });
  add("point/small", [small](benchmark::State& state) { run_point(state, small, false); });
  add("point/computer", [](benchmark::State& state) { run_point(state, {}, true); });
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}

}  // namespace
}  // namespace stereotlm::bench

int sc_main(int argc, char** argv) { return stereotlm::bench::run(argc, argv); }

// Replaces libsystemc's main, which prints the copyright banner before sc_main can turn it off.
int main(int argc, char** argv) {
  setenv("SYSTEMC_DISABLE_COPYRIGHT_MESSAGE", "1", 1);
  return sc_core::sc_elab_and_sim(argc, argv);
}
