#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "models/kernels/rectification_table.h"
#include "models/memory/bank_traits.h"
#include "platform/bounds.h"
#include "platform/config/board_area.h"
#include "platform/config/board_keys.h"
#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"
#include "sw/files/text_forms.h"
#include "sw/files/whole_file.h"
#include "sw/media/encode.h"
#include "sw/process/interrupt.h"
#include "sw/report/chart/memory_chart.h"
#include "sw/report/page_data/page_data.h"
#include "sw/runs/explanation.h"
#include "sw/runs/progress.h"
#include "sw/stats/stats_json.h"

namespace stereotlm::report {
namespace {

using Json = nlohmann::ordered_json;
using platform::BoardConfig;

constexpr std::chrono::milliseconds kBetweenPolls{100};
constexpr double kVisible =
    0.0005;  // frames per second: a change that changes the rate by less has no effect

// The command that runs the run again.
std::string command_of(const runs::RecordedRun& run) {
  const runs::RecordedOptions& options = run.options;
  std::string text =
      "stereotlm run " + files::shell_word((std::filesystem::path(run.folder) / "config.yaml").string());
  const auto add = [&text](const char* name, const std::string& value) {
    text += fmt::format(" {} {}", name, files::shell_word(value));
  };
  if (options.source != "camera") add("--source", options.source);
  if (options.fidelity != "fast") add("--fidelity", options.fidelity);
  add("--frames", std::to_string(options.frames));
  if (options.left) add("--left", options.left->path);
  if (options.right) add("--right", options.right->path);
  if (options.sequence) add("--sequence", options.sequence->path);
  if (!options.video.empty()) {
    text += " --video";
    for (const runs::InputFile& file : options.video) text += " " + files::shell_word(file.path);
    add("--video-layout", options.video_layout);
  }
  if (options.synthetic) add("--synthetic", std::to_string(*options.synthetic));
  if (options.calibration) add("--calibration", options.calibration->file.path);
  if (options.truth) {
    add("--truth", options.truth->path);
    add("--truth-scale", fmt::format("{}", options.truth_scale));
  }
  if (options.timing_only) text += " --timing-only";
  return text + " --out DIR";
}

Json settings_of(const BoardConfig& board) {
  std::map<std::string, platform::KeyInfo> known;
  for (const platform::KeyInfo& key : platform::keys()) known[key.path] = key;
  Json all = Json::array();
  for (const platform::BoardValue& value : platform::values_of(board)) {
    Json setting = {{"key", value.path}};
    std::visit([&setting](const auto& its) { setting["value"] = its; }, value.value);
    const auto key = known.find(platform::schema_path(value.path));
    if (key != known.end()) {
      setting["meaning"] = key->second.meaning;
      if (!key->second.unit.empty()) setting["unit"] = key->second.unit;
    }
    all.push_back(std::move(setting));
  }
  return all;
}

Json banks_of(const BoardConfig& board) {
  Json all = Json::array();
  for (const platform::BankConfig& bank : board.banks) {
    Json buffers = Json::array();
    for (const platform::PlacedBuffer& buffer : platform::buffers(board)) {
      if (buffer.bank == bank.name) buffers.push_back(buffer.label());
    }
    all.push_back({{"name", bank.name},
                   {"accesses_per_cycle", memory::traits_of(bank.kind).ports},
                   {"buffers", std::move(buffers)}});
  }
  return all;
}

Json bounds_of(const BoardConfig& board, const platform::Tables& tables, bool camera) {
  const platform::FrameAccesses accesses = platform::frame_accesses(board, tables);
  Json core = Json::array();
  for (std::uint64_t frame = 0; frame < platform::allocation_period_frames(board); ++frame) {
    Json resources = Json::array();
    for (const platform::ResourceBound& bound : platform::frame_bounds(board, accesses, frame))
      resources.push_back({{"resource", bound.resource}, {"cycles", bound.cycles}});
    core.push_back(std::move(resources));
  }
  Json bounds = {{"core", std::move(core)}};
  if (!camera) return bounds;
  bounds["computer"] = Json::array();
  for (const platform::RateBound& bound : platform::computer_bounds(board, accesses, true)) {
    bounds["computer"].push_back(
        {{"resource", bound.resource}, {"frames_per_second", bound.frames_per_second}});
  }
  return bounds;
}

Json json_of(const area::Area& area) {
  Json json = stats::area_json(area);
  json["fits"] = area.fits();
  return json;
}

Json area_data(const BoardConfig& board) {
  const area::Device& device = platform::device_of(board);
  Json items = Json::array();
  for (const area::Item& item : platform::area_items(board)) {
    items.push_back({{"name", item.name},
                     {"count", item.count},
                     {"luts", item.all.luts},
                     {"flip_flops", item.all.flip_flops},
                     {"block_rams", item.all.block_rams},
                     {"multipliers", item.all.multipliers},
                     {"lut_equivalents", item.lut_equivalents()}});
  }
  return {{"device",
           {{"name", device.name},
            {"slices", device.slices},
            {"block_rams", device.block_rams},
            {"multipliers", device.multipliers}}},
          {"items", std::move(items)},
          {"total", json_of(platform::area_of(board))}};
}

std::string png_url(const std::string& bytes) {
  return "data:image/png;base64," + files::base64(bytes.data(), bytes.size());
}

std::set<std::string> banks_used(const BoardConfig& board) {
  std::set<std::string> banks;
  for (const platform::PlacedBuffer& buffer : platform::buffers(board)) banks.insert(buffer.bank);
  return banks;
}

// Where a changed board uses banks that the board does not use: those that the board has, and how many it
// lacks.
void add_banks_taken(const BoardConfig& board, const BoardConfig& changed, Json& data) {
  const std::set<std::string> used = banks_used(board);
  std::vector<std::string> idle;
  std::size_t lacking = 0;
  for (const std::string& bank : banks_used(changed)) {
    if (used.count(bank) > 0) continue;
    const bool is_there = std::any_of(board.banks.begin(), board.banks.end(),
                                      [&](const platform::BankConfig& own) { return own.name == bank; });
    if (is_there) {
      idle.push_back(bank);
    } else {
      ++lacking;
    }
  }
  data["idle_banks"] = idle;
  data["new_banks"] = lacking;
}

// What a board costs and how hard its busiest bank works.
void add_prices(const BoardConfig& board, const runs::Explanation::BusiestBank& busiest, Json& data) {
  const double pixels = static_cast<double>(board.image.width) * board.image.height;
  data["area"] = json_of(platform::area_of(board));
  data["banks_used"] = banks_used(board).size();
  data["busiest_bank"] = {{"name", busiest.name},
                          {"accesses_per_pixel", busiest.accesses_per_frame / pixels}};
  data["clock_mhz"] = board.fpga.clock_mhz;
}

}  // namespace

std::string picture_url(const kernels::GrayImage& picture) {
  const std::vector<std::uint8_t> png = media::encode_png_gray(picture);
  return png_url(std::string(png.begin(), png.end()));
}

Json run_data(const runs::RecordedRun& run, const platform::Tables& tables) {
  const BoardConfig& board = run.board;
  const auto read = [&run](const char* name) {
    return files::read_whole_file(std::filesystem::path(run.folder) / name);
  };
  Json data = {
      {"folder", run.folder},
      {"command", command_of(run)},
      {"stats", Json::parse(run.stats_json)},
      {"config_yaml", read("config.yaml")},
      {"settings", settings_of(board)},
      {"banks", banks_of(board)},
      {"bounds", bounds_of(board, tables, run.options.source == "camera")},
      {"area", area_data(board)},
      {"memory_chart", memory_chart_svg({board, run.statistics.computer.has_value(), &run.statistics})}};
  if (!run.options.timing_only) {
    data["pictures"] = {{"disparity", png_url(read("disparity.png"))},
                        {"disparities", board.matcher.disparities}};
  }
  return data;
}

bool add_repetition(const runs::RecordedRun& run, runs::RunInput& input, Json& data) {
  RecordingData recording(run.board, input.camera);
  runs::Rerun rerun(
      run, [&recording](const std::string& name, const std::string& text) { recording.add(name, text); });
  runs::ProgressLine progress;
  std::uint64_t frames = 0;
  std::uint64_t last = 0;  // camera frame
  while (true) {
    while (!rerun.has_news(kBetweenPolls)) {
      if (process::interrupted()) return false;
      progress.show([&](double) { return fmt::format("{}/{} frames repeated", frames, run.options.frames); });
    }
    const auto frame = rerun.next();
    if (!frame) break;
    ++frames;
    last = frame->number;
  }
  data["recording"] = recording.json();
  if (run.options.timing_only) return true;
  kernels::GrayImage left = input.pairs->pair(last).left;
  if (input.tables.left) left = kernels::rectify(left, *input.tables.left);
  data["pictures"]["left"] = picture_url(left);
  return true;
}

void add_recorded_files(const runs::RecordedRun& run, Json& data) {
  RecordingData recording(run.board, run.options.source == "camera", run.folder);
  if (recording.add_folder(run.statistics)) data["recording"] = recording.json();
}

Json knobs_data(const BoardConfig& board, runs::Explanation& explanation) {
  using Explanation = runs::Explanation;
  const Explanation::Rate now = explanation.now();
  Json base = {{"frames_per_second", now.frames_per_second},
               {"frames", explanation.frames()},
               {"loses_pixels", now.loses_pixels},
               {"limited_by", runs::limiter_text(explanation)}};
  add_prices(board, explanation.busiest_bank(), base);
  Json steps = Json::array();
  Json failed = Json::array();
  for (const Explanation::Step& found : explanation.steps()) {
    const explore::KnobStep& knob = *found.step;
    Json step = {{"knob", knob.knob}, {"from", knob.from}, {"to", knob.to}};
    if (!found.rate.failure.empty()) {
      step["reason"] = found.rate.failure;
      failed.push_back(std::move(step));
      continue;
    }
    step["frames_per_second"] = found.rate.frames_per_second;
    step["has_effect"] = found.rate.loses_pixels != now.loses_pixels ||
                         std::abs(found.rate.frames_per_second - now.frames_per_second) >= kVisible;
    step["changes_disparities"] = knob.changes_disparities;
    step["loses_pixels"] = found.rate.loses_pixels;
    step["sets"] = knob.sets;
    add_prices(knob.board, found.busiest, step);
    add_banks_taken(board, knob.board, step);
    steps.push_back(std::move(step));
  }
  Json forbidden = Json::array();
  for (const explore::KnobStep& step : explanation.knobs().forbidden)
    forbidden.push_back({{"knob", step.knob}, {"from", step.from}, {"to", step.to}, {"reason", step.reason}});
  return {{"board", std::move(base)},
          {"steps", std::move(steps)},
          {"forbidden", std::move(forbidden)},
          {"failed", std::move(failed)}};
}

}  // namespace stereotlm::report
