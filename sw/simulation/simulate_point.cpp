#include "sw/simulation/simulate_point.h"

#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>

#include "models/binder.h"
#include "sw/report/sha256.h"
#include "sw/report/stats_json.h"
#include "sw/simulation/child.h"
#include "sw/simulation/make_simulation.h"

namespace stereotlm::simulation {
namespace {

using Json = nlohmann::ordered_json;

bool is_table_of(const std::optional<kernels::RectificationTable>& table, const platform::BoardConfig& board,
                 bool is_used) {
  if (!table || !is_used) return table.has_value() == is_used;
  return table->width == board.image.width && table->height == board.image.height;
}

Json simulate(const explore::Point& point, const platform::Tables& tables) {
  const platform::BoardConfig& board = *point.board;
  Binder binder;
  BlankPairs blank(board);
  const auto simulation = make_simulation(
      board, tables, blank, {point.run.camera, fpga::Fidelity::kTiming, point.run.frames}, binder);
  while (!simulation->finished()) simulation->advance();
  const platform::Statistics statistics = simulation->statistics();
  if (!statistics.failed.empty()) throw std::runtime_error(statistics.failed.front());
  return report::stats_document(statistics, std::nullopt);
}

}  // namespace

explore::Figures PointSimulator::operator()(const explore::Point& point) {
  const platform::BoardConfig& board = *point.board;
  const bool is_usable = is_table_of(tables_.left, board, board.allocation.left_lut.has_value()) &&
                         is_table_of(tables_.right, board, board.allocation.right_lut.has_value());
  if (!is_usable && is_calibrated_)
    throw std::runtime_error("the tables of the calibration are of another board");
  if (!is_usable) tables_ = platform::identity_tables(board);
  Child child([&](const Child::Tell& tell) {
    const auto bytes = Json::to_cbor(simulate(point, tables_));
    tell(std::string(bytes.begin(), bytes.end()));
  });
  const std::string document = child.next().value();
  child.next();
  return explore::figures_of(Json::from_cbor(document));
}

PixelRun simulate_pixels(const platform::BoardConfig& board, const platform::Tables& tables,
                         host::FrameSource& pairs, std::uint64_t frames) {
  Child child([&](const Child::Tell& tell) {
    Binder binder;
    const auto simulation =
        make_simulation(board, tables, pairs, {false, fpga::Fidelity::kFast, frames}, binder);
    std::string pixels;
    while (!simulation->finished()) {
      for (const Result& result : simulation->advance()) {
        pixels.append(result.disparity.pixels.begin(), result.disparity.pixels.end());
      }
    }
    const platform::Statistics statistics = simulation->statistics();
    if (!statistics.failed.empty()) throw std::runtime_error(statistics.failed.front());
    tell(report::sha256_hex(pixels.data(), pixels.size()));
    tell(std::to_string(statistics.cycles));
  });
  PixelRun run;
  run.disparities_sha256 = child.next().value();
  run.cycles = std::stoull(child.next().value());
  child.next();
  return run;
}

}  // namespace stereotlm::simulation
