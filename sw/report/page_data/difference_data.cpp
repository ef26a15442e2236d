#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "models/fpga/core_ports.h"
#include "platform/config/board_yaml.h"
#include "sw/explore/store/store.h"
#include "sw/report/difference_tables.h"
#include "sw/report/page_data/page_data.h"
#include "sw/report/page_data/recording_data.h"

namespace stereotlm::report {
namespace {

using Json = nlohmann::ordered_json;

// B - A for each row, summed over the frames.
Json rows_data(const stats::RowComparison& rows, std::size_t height) {
  std::vector<std::int64_t> cycles(height);
  std::array<std::vector<std::int64_t>, fpga::kCoreGroupCount> stalls;
  stalls.fill(cycles);
  // With as many ranges as rows, all rows of a range have the same differences.
  for (const stats::RowComparison::Range& range : rows.ranges(height)) {
    const auto count = static_cast<std::int64_t>(range.last_row - range.first_row + 1);
    for (std::size_t row = range.first_row; row <= range.last_row; ++row) {
      cycles[row] = range.cycles / count;
      for (std::size_t group = 0; group < stalls.size(); ++group)
        stalls[group][row] = range.stalls[group] / count;
    }
  }
  Json by_group = Json::object();
  for (std::size_t group = 0; group < stalls.size(); ++group)
    by_group[fpga::kPortGroups[group].name] = stalls[group];
  Json data = {{"frames", rows.frames()}, {"cycles", cycles}, {"stalls", std::move(by_group)}};
  if (const auto& parting = rows.parting()) {
    data["parting"] = {{"frame", parting->frame},
                       {"row", parting->row},
                       {"cycles_a", parting->cycles_a},
                       {"cycles_b", parting->cycles_b}};
  }
  return data;
}

// All values of run.json by path.
Values options_of(const runs::RecordedRun& run) {
  Values values;
  const Json flat = Json::parse(run.run_json).flatten();
  for (const auto& [path, value] : flat.items()) {
    std::string name = path.substr(1);
    std::replace(name.begin(), name.end(), '/', '.');
    values.push_back({name, value.is_string() ? value.get<std::string>() : value.dump()});
  }
  return values;
}

// The figures of a run by path in stats.json. Leaves out those that follow from others, and frame_cycles,
// which is compared frame by frame.
Values figures_of(const Json& stats) {
  Values values;
  for (platform::BoardValue& value : explore::figures_of(stats).values) {
    const auto ends_in = [&value](const std::string& key) {
      return value.path.size() >= key.size() &&
             value.path.compare(value.path.size() - key.size(), key.size(), key) == 0;
    };
    if (ends_in(".utilization") || ends_in(".megabytes_per_second") || value.path == "frame_cycles") continue;
    if (value.path == "cycles") value.value = static_cast<std::int64_t>(cycles_of_frames(stats));
    values.push_back(std::move(value));
  }
  return values;
}

Json frames_json(const std::vector<std::uint64_t>& a, const std::vector<std::uint64_t>& b) {
  Json list = Json::array();
  for (std::size_t frame = 0; frame < std::min(a.size(), b.size()); ++frame) {
    if (a[frame] != b[frame]) list.push_back({{"frame", frame}, {"a", a[frame]}, {"b", b[frame]}});
  }
  return list;
}

Json json_of(const stats::RowComparison& rows) {
  Json ranges = Json::array();
  for (const stats::RowComparison::Range& range : rows.ranges(kMostLines)) {
    Json waits = Json::object();
    for (std::size_t group = 0; group < fpga::kCoreGroupCount; ++group)
      waits[fpga::kPortGroups[group].name] = range.stalls[group];
    ranges.push_back({{"first_row", range.first_row},
                      {"last_row", range.last_row},
                      {"cycles", range.cycles},
                      {"waiting_cycles", std::move(waits)}});
  }
  return {{"frames", rows.frames()}, {"ranges", std::move(ranges)}};
}

Json json_of(const stats::PixelComparison& pixels) {
  return {{"frames", pixels.frames()},
          {"frames_that_differ", pixels.frames_that_differ()},
          {"pixels_that_differ", pixels.pixels()}};
}

Json run_data_of(const ComparedRun& compared) {
  Json data = run_data(compared.run, compared.tables);
  RecordingData recording(compared.run.board, false, compared.run.folder);
  if (!recording.add_folder(compared.run.statistics)) return data;
  Json waits = recording.json();
  waits.erase("tiles");
  for (Json& stalls : waits["stalls"]) stalls.erase("tiles");
  data["recording"] = std::move(waits);
  return data;
}

}  // namespace

Json diff_document(const runs::RecordedRun& a, const runs::RecordedRun& b,
                   const runs::FrameAlignment& aligned, const runs::DiffLimits& limits) {
  const Json stats_a = Json::parse(a.stats_json);
  const Json stats_b = Json::parse(b.stats_json);
  return {{"schema", 1},
          {"a", a.folder},
          {"b", b.folder},
          {"settings", differing_values(platform::values_of(a.board), platform::values_of(b.board))},
          {"options", differing_values(options_of(a), options_of(b))},
          {"figures", differing_values(figures_of(stats_a), figures_of(stats_b))},
          {"frames", frames_json(a.statistics.frame_cycles, b.statistics.frame_cycles)},
          {"waits", differing_waits(a.statistics.blame, b.statistics.blame)},
          {"rows", limits.rows.empty() ? json_of(aligned.rows()) : Json{{"not_compared", limits.rows}}},
          {"disparities",
           limits.pixels.empty() ? json_of(aligned.pixels()) : Json{{"not_compared", limits.pixels}}},
          {"verdict", diff_verdict({stats_a, a.board.fpga.clock_mhz}, {stats_b, b.board.fpga.clock_mhz},
                                   limits.pixels.empty() ? &aligned.pixels() : nullptr)}};
}

Json two_runs_data(const ComparedRun& a, const ComparedRun& b, const runs::FrameAlignment& aligned,
                   const runs::DiffLimits& limits) {
  Json data = {{"runs", {run_data_of(a), run_data_of(b)}},
               {"difference", diff_document(a.run, b.run, aligned, limits)}};
  Json& difference = data["difference"];
  difference["settings"] = shown_values(difference["settings"]);
  if (limits.rows.empty())
    difference["rows"] = rows_data(aligned.rows(), static_cast<std::size_t>(a.run.board.image.height));
  if (const auto& first = aligned.pixels().first()) {
    difference["disparities"]["first"] = {
        {"camera_frame", first->camera_frame}, {"column", first->column}, {"row", first->row}};
  }
  if (const auto& common = aligned.last_common()) {
    data["runs"][0]["pictures"]["disparity"] = picture_url(common->a);
    data["runs"][1]["pictures"]["disparity"] = picture_url(common->b);
    difference["camera_frame"] = common->number;
  }
  return data;
}

}  // namespace stereotlm::report
