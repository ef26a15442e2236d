#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "models/fpga/core_ports.h"
#include "sw/report/difference_tables.h"
#include "sw/report/page_data/page_data.h"

namespace stereotlm::report {
namespace {

using Json = nlohmann::ordered_json;

// B - A for each row, summed over the frames.
Json rows_data(const stats::RowComparison& rows, std::size_t height) {
  std::vector<std::int64_t> cycles(height);
  std::array<std::vector<std::int64_t>, fpga::kCorePortCount> stalls;
  stalls.fill(cycles);
  // With as many ranges as rows, all rows of a range have the same differences.
  for (const stats::RowComparison::Range& range : rows.ranges(height)) {
    const auto count = static_cast<std::int64_t>(range.last_row - range.first_row + 1);
    for (std::size_t row = range.first_row; row <= range.last_row; ++row) {
      cycles[row] = range.cycles / count;
      for (std::size_t port = 0; port < stalls.size(); ++port) stalls[port][row] = range.stalls[port] / count;
    }
  }
  Json by_port = Json::object();
  for (std::size_t port = 0; port < stalls.size(); ++port) by_port[fpga::kPorts[port].name] = stalls[port];
  Json data = {{"frames", rows.frames()}, {"cycles", cycles}, {"stalls", std::move(by_port)}};
  if (const auto& parting = rows.parting()) {
    data["parting"] = {{"frame", parting->frame},
                       {"row", parting->row},
                       {"cycles_a", parting->cycles_a},
                       {"cycles_b", parting->cycles_b}};
  }
  return data;
}

Json pixels_data(const stats::PixelComparison& pixels) {
  Json data = {{"frames", pixels.frames()},
               {"frames_that_differ", pixels.frames_that_differ()},
               {"pixels", pixels.pixels()}};
  if (const auto& first = pixels.first()) {
    data["first"] = {{"camera_frame", first->camera_frame},
                     {"column", first->column},
                     {"row", first->row},
                     {"a", first->a},
                     {"b", first->b}};
  }
  return data;
}

Json run_data_of(const ComparedRun& compared) {
  Json data = run_data(compared.run, compared.tables);
  Json waits = compared.waits.json();
  waits.erase("tiles");
  for (Json& stalls : waits["stalls"]) stalls.erase("tiles");
  data["recording"] = std::move(waits);
  return data;
}

Json difference_data(const ComparedRun& a, const ComparedRun& b, const runs::FrameAlignment& aligned,
                     const runs::DiffLimits& limits) {
  const Json stats_a = Json::parse(a.run.stats_json);
  const Json stats_b = Json::parse(b.run.stats_json);
  Json data = {
      {"verdict", diff_verdict({stats_a, a.run.board.fpga.clock_mhz}, {stats_b, b.run.board.fpga.clock_mhz},
                               limits.pixels.empty() ? &aligned.pixels() : nullptr)}};
  if (limits.rows.empty()) {
    data["rows"] = rows_data(aligned.rows(), static_cast<std::size_t>(a.run.board.image.height));
  } else {
    data["no_rows"] = limits.rows;
  }
  if (limits.pixels.empty()) {
    data["pixels"] = pixels_data(aligned.pixels());
  } else {
    data["no_pixels"] = limits.pixels;
  }
  return data;
}

}  // namespace

Json two_runs_data(const ComparedRun& a, const ComparedRun& b, const runs::FrameAlignment& aligned,
                   const runs::DiffLimits& limits) {
  Json data = {{"runs", {run_data_of(a), run_data_of(b)}},
               {"difference", difference_data(a, b, aligned, limits)}};
  if (const auto& common = aligned.last_common()) {
    data["runs"][0]["pictures"]["disparity"] = picture_url(common->a);
    data["runs"][1]["pictures"]["disparity"] = picture_url(common->b);
    data["difference"]["camera_frame"] = common->number;
  }
  return data;
}

}  // namespace stereotlm::report
