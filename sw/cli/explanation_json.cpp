#include "sw/cli/explanation_json.h"

#include <cstdint>
#include <string>
#include <utility>

#include "platform/config/board_area.h"
#include "sw/runs/limiter_text.h"
#include "sw/stats/stats_json.h"

namespace stereotlm::cli {
namespace {

using Json = nlohmann::ordered_json;
using platform::BoardConfig;
using runs::Explanation;

Json resources_json(Explanation& explanation) {
  Json all = Json::array();
  for (const Explanation::Resource& resource : explanation.resources()) {
    Json row = {{"resource", resource.name},
                {"frames_per_second", resource.frames_per_second},
                {"headroom_percent", resource.headroom_percent},
                {"busy_percent", resource.busy_percent}};
    if (resource.varies) row["frame"] = resource.frame;
    all.push_back(std::move(row));
  }
  return all;
}

Json blame_json(Explanation& explanation) {
  const auto cycles = static_cast<double>(explanation.figures().integer("cycles"));
  Json all = Json::array();
  for (const explore::StoredBlame& blame : explanation.blames()) {
    all.push_back({{"port", blame.port},
                   {"bank", blame.bank},
                   {"by", blame.by},
                   {"cycles", blame.cycles},
                   {"cycles_percent", 100 * static_cast<double>(blame.cycles) / cycles}});
  }
  return all;
}

Json area_json(const BoardConfig& board) {
  const area::Area area = platform::area_of(board);
  Json json = stats::area_json(area);
  json["fits"] = area.fits();
  return json;
}

template <typename Step>
Json change_json(const Step& step) {
  return {{"key", step.knob}, {"from", step.from}, {"to", step.to}};
}

// Adds `changes`, the best first, `failed` and `impossible`.
void add_changes(Explanation& explanation, Json& document) {
  const double now = explanation.now().frames_per_second;
  Json changes = Json::array();
  Json failed = Json::array();
  for (const Explanation::Step& found : explanation.steps()) {
    const explore::KnobStep& step = *found.step;
    Json change = change_json(step);
    if (!found.rate.failure.empty()) {
      change["reason"] = found.rate.failure;
      failed.push_back(std::move(change));
      continue;
    }
    const double rate = found.rate.frames_per_second;
    change["frames_per_second"] = rate;
    change["gained_frames_per_second"] = rate - now;
    change["gained_percent"] = 100 * (rate / now - 1);
    change["changes_disparities"] = step.changes_disparities;
    change["loses_pixels"] = found.rate.loses_pixels;
    change["sets"] = step.sets;
    change["area"] = area_json(step.board);
    changes.push_back(std::move(change));
  }
  document["changes"] = std::move(changes);
  Json& impossible = document["impossible"] = Json::array();
  for (const explore::ForbiddenStep& step : explanation.knobs().forbidden) {
    impossible.push_back(change_json(step));
    impossible.back()["reason"] = step.reason;
  }
  document["failed"] = std::move(failed);
}

}  // namespace

Json explanation_document(const BoardConfig& board, Explanation& explanation) {
  const Explanation::Rate now = explanation.now();
  const explore::StoredRow& row = explanation.figures();
  const std::string of = explanation.camera() ? "bound.system" : "bound.core";
  Json document = {
      {"schema", 1},
      {"board", board.name},
      {"source", explanation.camera() ? "camera" : "preloaded"},
      {"frames", explanation.frames()},
      {"frames_per_second", now.frames_per_second},
      {"loses_pixels", now.loses_pixels},
      {"bound", {{"frames_per_second", row.real(of)}, {"limited_by", row.text(of + "_limited_by")}}}};
  if (explanation.camera()) document["uncertainty_frames_per_second"] = now.uncertainty;
  document["limited_by"] = runs::limiter_text(explanation);
  const runs::Explanation::Budget& budget = explanation.budget();
  document["time_percent"] = {{"bound", budget.bound}, {"queues", budget.queues}, {"waits", budget.waits}};
  for (const auto& [why, share] : budget.core_waits) document["time_percent"]["core_waits"][why] = share;
  const double queue = runs::result_queue_percent(explanation);
  if (queue > 0) document["result_queue_wait_percent"] = queue;
  document["resources"] = resources_json(explanation);
  document["blame"] = blame_json(explanation);
  document["area"] = area_json(board);
  add_changes(explanation, document);
  return document;
}

}  // namespace stereotlm::cli
