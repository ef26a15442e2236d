#include "sw/runs/simulation/simulate_point.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include "models/binder.h"
#include "models/fpga/fast/sdram_parts.h"
#include "models/kernels/rectification_table.h"
#include "platform/config/board_keys.h"
#include "platform/config/buffer_layout.h"
#include "platform/figures/derived_figures.h"
#include "platform/loop/core_loop.h"
#include "sw/explore/optimise/key_effects.h"
#include "sw/explore/sweep/sweep.h"
#include "sw/files/text_forms.h"
#include "sw/process/child.h"
#include "sw/process/streams.h"
#include "sw/runs/simulation/camera_simulation.h"
#include "sw/runs/simulation/simulation.h"
#include "sw/runs/sources/open_source.h"
#include "sw/stats/figures.h"

namespace stereotlm::runs {
namespace {

using Json = nlohmann::ordered_json;
using platform::BoardConfig;

bool is_table_of(const std::optional<kernels::RectificationTable>& table, const platform::BoardConfig& board,
                 bool is_used) {
  if (!table || !is_used) return table.has_value() == is_used;
  return table->width == board.image.width && table->height == board.image.height;
}

// Throws if an identity does not hold.
void check(const platform::Statistics& statistics) {
  if (!statistics.failed.empty()) throw std::runtime_error(statistics.failed.front());
}

Json document_of(const platform::Statistics& statistics, const BoardConfig& board,
                 const std::optional<stats::Accuracy>& accuracy) {
  check(statistics);
  return stats::point_document(statistics, board, accuracy);
}

// Does the work in a child process, because SystemC is elaborated once in a process. Returns its document;
// null after an interrupt.
Json in_child(const std::function<Json()>& work) {
  process::Child child([&work](const process::Child::Tell& tell) {
    const auto bytes = Json::to_cbor(work());
    tell(std::string(bytes.begin(), bytes.end()));
  });
  while (!child.has_news(std::chrono::milliseconds(20))) {
    if (process::interrupted()) return nullptr;
  }
  const std::string bytes = child.next().value();
  child.next();
  return Json::from_cbor(bytes);
}

Json simulate_computer(const explore::Point& point, const platform::Tables& tables,
                       const std::optional<stats::Accuracy>& accuracy, bool with_core_waits) {
  const platform::BoardConfig& board = *point.board;
  const std::uint64_t frames = point.run.frames;
  const auto pairs = blank_pairs(board);
  Binder binder;
  CameraSimulation simulation(board, tables, *pairs, frames, binder, fpga::Fidelity::kTiming);
  if (with_core_waits) simulation.record_timeline();
  simulation.run([] {
    if (process::interrupted()) throw explore::GivenUp();
  });
  double whole_ps = 0;
  std::map<std::string, double> core_waits_ps;
  const std::uint64_t turn = platform::allocation_period_frames(board);
  for (const platform::TimelineEvent& event : simulation.take_timeline().events) {
    const bool is_wait = event.kind == platform::EventKind::kWait && event.what == std::string("core");
    if (!is_wait && event.kind != platform::EventKind::kFrame) continue;
    if (event.frame.value() < frames - platform::steady_frames(frames, turn)) continue;
    const auto time_ps = static_cast<double>(event.end_ps - event.begin_ps);
    whole_ps += time_ps;
    if (is_wait) core_waits_ps[event.why] += time_ps;
  }
  Json document = document_of(simulation.statistics(), board, accuracy);
  for (const auto& [why, time_ps] : core_waits_ps) document["core_waits"][why] = time_ps / whole_ps;
  return document;
}

}  // namespace

explore::Figures PointSimulator::operator()(const explore::Point& point, bool with_core_waits) {
  const platform::BoardConfig& board = *point.board;
  const bool is_usable = is_table_of(tables_.left, board, board.allocation.left_lut.has_value()) &&
                         is_table_of(tables_.right, board, board.allocation.right_lut.has_value());
  if (!is_usable && is_calibrated_)
    throw std::runtime_error("the tables of the calibration are of another board");
  if (!is_usable) tables_ = platform::identity_tables(board);
  const auto accuracy = quality_.of(board, is_calibrated_ ? &tables_ : nullptr);
  return explore::figures_of(point.run.camera
                                 ? simulate_computer(point, tables_, accuracy, with_core_waits)
                                 : document_of(statistics_of(board, core_counts(point)), board, accuracy));
}

// Points that follow each other in a plan differ in the key that varies fastest. The core may not notice it.
const platform::CoreCounts& PointSimulator::core_counts(const explore::Point& point) {
  std::string key = explore::core_cycles_key(*point.board) + std::to_string(point.run.frames);
  for (const platform::BoardValue& value : point.values) {  // banks without a buffer have figures too
    if (value.path.rfind("ssram.", 0) != 0) continue;
    if (explore::effects_of_key(platform::schema_path(value.path)).core_cycles)
      key += fmt::format(" {} {}", value.path, platform::value_text(value.value));
  }
  if (core_ && key == core_key_) return *core_;
  core_ = platform::count_core(*point.board, tables_, point.run.frames);
  core_key_ = std::move(key);
  return *core_;
}

PixelRun simulate_pixels(const platform::BoardConfig& board, const platform::Tables& tables,
                         host::FrameSource& pairs, std::uint64_t frames) {
  const Json document = in_child([&]() -> Json {
    Binder binder;
    const auto simulation =
        make_simulation(board, tables, pairs, {false, fpga::Fidelity::kFast, frames}, binder);
    std::string pixels;
    simulation->run([&] {
      for (const Result& result : simulation->take_results())
        pixels.append(result.disparity.pixels.begin(), result.disparity.pixels.end());
    });
    const platform::Statistics statistics = simulation->statistics();
    check(statistics);
    const auto& cycles = statistics.frame_cycles;
    return {{"sha256", files::sha256_hex(pixels.data(), pixels.size())},
            {"cycles", std::accumulate(cycles.begin(), cycles.end(), std::uint64_t{0})},
            {"last", Json::binary(simulation->last().disparity.pixels)}};
  });
  if (document.is_null()) return {};
  PixelRun run = {document.at("sha256"), document.at("cycles"), {board.image.width, board.image.height}};
  run.last.pixels = document.at("last").get_binary();
  return run;
}

std::string stepped_text(const platform::BoardConfig& board, const platform::Tables& tables, bool camera) {
  const fpga::CoreConfig core = core_config(board);
  const std::vector<memory::SsramBankConfig> banks = ssram_configs(board);
  fpga::SdramTimings timings;
  for (const memory::SsramBankConfig& bank : banks) timings.push_back(bank.sdram ? &*bank.sdram : nullptr);
  const auto points_elsewhere = [&](fpga::Side side) {
    const auto& table = side == fpga::Side::kLeft ? tables.left : tables.right;
    return table && table->entries != kernels::identity_table(table->width, table->height).entries;
  };
  std::set<std::string> found;
  for (std::uint64_t frame = 0; frame < allocation_period_frames(board); ++frame) {
    const fpga::Placements placements = placements_of(core, buffer_bases(board).of_frame(frame));
    const std::vector<fpga::SdramPart> sdram = sdram_parts(core, placements, timings);
    for (const fpga::Side side : fpga::kSides) {
      const std::size_t group = fpga::pixel_group(side);
      const bool is_striped = placements[group].parts().size() > 1;
      const bool is_in_sdram = std::any_of(
          sdram.begin(), sdram.end(), [group](const fpga::SdramPart& part) { return part.group == group; });
      if ((is_striped || is_in_sdram) && points_elsewhere(side))
        found.insert("pictures in stripes or sdram, as their tables point to other pixels");
    }
    if (!are_apart(sdram))
      found.insert("rows of sdram that hold the end of one buffer and the start of another");
    if (camera && !sdram.empty()) found.insert("accesses of captures and of the host in sdram");
  }
  return fmt::format("{}", fmt::join(found, "; "));
}

double waitless_frames_per_second(const platform::BoardConfig& board, const platform::Tables& tables,
                                  std::uint64_t frames) {
  const std::uint64_t turn = std::min(platform::allocation_period_frames(board), frames);
  const std::vector<std::uint64_t> frame_cycles = platform::waitless_frame_cycles(board, tables, turn);
  std::uint64_t cycles = 0;
  for (std::uint64_t frame = 0; frame < turn; ++frame)
    cycles += frame_cycles[frame] * ((frames - frame + turn - 1) / turn);
  return board.fpga.clock_mhz * 1e6 * static_cast<double>(frames) / static_cast<double>(cycles);
}

}  // namespace stereotlm::runs
