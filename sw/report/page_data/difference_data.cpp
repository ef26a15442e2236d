#include "sw/report/page_data/difference_data.h"

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "models/fpga/core_ports.h"

namespace stereotlm::report {
namespace {

using Json = nlohmann::ordered_json;

// B - A for each row, summed over the frames.
Json rows_data(const RowComparison& rows, std::size_t height) {
  std::vector<std::int64_t> cycles(height);
  std::array<std::vector<std::int64_t>, fpga::kCorePortCount> stalls;
  stalls.fill(cycles);
  // With as many ranges as rows, all rows of a range have the same differences.
  for (const RowComparison::Range& range : rows.ranges(height)) {
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

Json pixels_data(const PixelComparison& pixels) {
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

}  // namespace

Json difference_data(const platform::ImageConfig& image, const runs::FrameAlignment& aligned,
                     const runs::DiffLimits& limits) {
  Json data = Json::object();
  if (limits.rows.empty()) {
    data["rows"] = rows_data(aligned.rows(), static_cast<std::size_t>(image.height));
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

}  // namespace stereotlm::report
