#include "sw/report/stats_json.h"

#include "sw/files/json_text.h"
#include "sw/report/console_table.h"

namespace stereotlm::report {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const platform::BankStatistics& bank) {
  return {{"name", bank.name},
          {"reads", bank.reads},
          {"writes", bank.writes},
          {"busy_cycles", bank.busy_cycles},
          {"turnaround_cycles", bank.turnaround_cycles},
          {"idle_cycles", bank.idle_cycles},
          {"contended_cycles", bank.contended_cycles},
          {"utilization", bank.utilization},
          {"megabytes_per_second", bank.megabytes_per_second}};
}

Json to_json(const platform::PortStatistics& port) {
  return {{"name", port.name},
          {"grants", port.grants},
          {"stall_cycles", port.stall_cycles},
          {"passed_cycles", port.passed_cycles},
          {"idle_cycles", port.idle_cycles},
          {"blocked_cycles", port.blocked_cycles},
          {"starved_cycles", port.starved_cycles}};
}

Json to_json(const platform::BlameRow& row) {
  return {{"port", row.port}, {"bank", row.bank}, {"by", row.by}, {"cycles", row.cycles}};
}

Json to_json(const platform::PciMasterStatistics& master) {
  return {{"name", master.name},
          {"transactions", master.transactions},
          {"words", master.words},
          {"wait_clocks", master.wait_clocks}};
}

Json to_json(const platform::CameraStatistics& camera) {
  return {{"name", camera.name},
          {"frames", camera.frames},
          {"captured_frames", camera.captured_frames},
          {"dropped_frames", camera.dropped_frames},
          {"dropped_pixels", camera.dropped_pixels},
          {"dropped_not_armed", camera.dropped_not_armed},
          {"dropped_busy", camera.dropped_busy},
          {"dropped_by_partner", camera.dropped_by_partner}};
}

Json to_json(const platform::Percentiles& values) {
  return {{"min", values.min},
          {"p50", values.p50},
          {"p95", values.p95},
          {"p99", values.p99},
          {"max", values.max}};
}

Json to_json(const Accuracy& accuracy) {
  Json result = Json::object();
  const auto add = [&result](const char* key, const std::optional<double>& percent) {
    if (percent) result[key] = *percent;
  };
  add("bad_1_percent", accuracy.bad_1_percent);
  add("bad_2_percent", accuracy.bad_2_percent);
  add("answered_percent", accuracy.answered_percent);
  return result;
}

template <typename Row>
Json rows(const std::vector<Row>& values) {
  Json result = Json::array();
  for (const Row& value : values) result.push_back(to_json(value));
  return result;
}

void add_computer(const platform::ComputerStatistics& computer, Json& document) {
  document["pci"] = {{"clocks", computer.pci_clocks},
                     {"busy_clocks", computer.pci_busy_clocks},
                     {"masters", rows(computer.pci_masters)}};
  document["bridge"] = {{"posted_words", computer.posted_words},
                        {"dma_words", computer.dma_words},
                        {"local_clocks", computer.local_clocks},
                        {"local_busy_clocks", computer.local_busy_clocks}};
  document["cameras"] = rows(computer.cameras);
  document["latency_ms"] = {{"capture_to_host", to_json(computer.capture_to_host_ms)}};
}

}  // namespace

Json area_json(const area::Area& area) {
  return {{"slices", area.slices},
          {"slices_percent", area.slices_percent},
          {"luts", area.luts},
          {"flip_flops", area.flip_flops},
          {"block_rams", area.block_rams},
          {"block_rams_percent", area.block_rams_percent},
          {"multipliers", area.multipliers},
          {"multipliers_percent", area.multipliers_percent}};
}

Json stats_document(const platform::Statistics& statistics, const std::optional<Accuracy>& accuracy) {
  Json document = {{"schema", 1},
                   {"board", statistics.board},
                   {"fidelity", statistics.fidelity},
                   {"frames", statistics.frames},
                   {"cycles", statistics.cycles},
                   {"frame_cycles", statistics.frame_cycles}};
  Json& rate = document["frames_per_second"] = {{"core", statistics.frames_per_second.core}};
  if (statistics.frames_per_second.system) rate["system"] = *statistics.frames_per_second.system;
  if (statistics.frames_per_second.steady) {
    rate["steady"] = statistics.frames_per_second.steady->frames_per_second;
    rate["steady_uncertainty"] = statistics.frames_per_second.steady->uncertainty;
  }
  Json& bound = document["bound"] = {{"core", statistics.bound.core},
                                     {"core_limited_by", statistics.bound.core_limited_by}};
  if (statistics.bound.system) {
    bound["system"] = *statistics.bound.system;
    bound["system_limited_by"] = statistics.bound.system_limited_by;
  }
  document["banks"] = rows(statistics.banks);
  document["ports"] = rows(statistics.ports);
  document["blame"] = rows(statistics.blame);
  if (statistics.computer) add_computer(*statistics.computer, document);
  document["area"] = area_json(statistics.area);
  if (!statistics.failed.empty()) document["failed"] = statistics.failed;
  if (accuracy) document["accuracy"] = to_json(*accuracy);
  return document;
}

nlohmann::ordered_json run_document(const platform::Statistics& statistics, const TableExtras& extras) {
  Json document = stats_document(statistics, extras.accuracy);
  if (extras.waitless_frames_per_second)
    document["waitless_frames_per_second"] = *extras.waitless_frames_per_second;
  if (extras.answered_percent) document["disparities_percent"] = *extras.answered_percent;
  return document;
}

std::string stats_json(const platform::Statistics& statistics, const std::optional<Accuracy>& accuracy) {
  return files::json_text(stats_document(statistics, accuracy));
}

}  // namespace stereotlm::report
