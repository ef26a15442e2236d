#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "models/kernels/rectification_table.h"
#include "models/memory/bank_traits.h"
#include "platform/config/board_area.h"
#include "platform/config/board_keys.h"
#include "platform/config/board_yaml.h"
#include "platform/config/buffer_layout.h"
#include "platform/figures/audit.h"
#include "platform/figures/bounds.h"
#include "platform/figures/derived_figures.h"
#include "sw/files/text_forms.h"
#include "sw/files/whole_file.h"
#include "sw/media/encode.h"
#include "sw/media/load.h"
#include "sw/report/chart/memory_chart.h"
#include "sw/report/page_data/page_data.h"
#include "sw/report/page_data/recording_data.h"
#include "sw/runs/explanation.h"
#include "sw/stats/stats_json.h"

namespace stereotlm::report {
namespace {

using Json = nlohmann::ordered_json;
using platform::BoardConfig;

// The command that runs the run again, with the options of run.json that its figures depend on.
std::string command_of(const runs::RecordedRun& run) {
  static const std::set<std::string> others = {"schema",      "command", "version",  "verify",
                                               "save_frames", "record",  "no_record"};
  std::string text =
      "stereotlm run " + files::shell_word((std::filesystem::path(run.folder) / "config.yaml").string());
  const auto add = [&text](const Json& value) {
    text += " " + files::shell_word(value.is_string() ? value.get<std::string>() : value.dump());
  };
  const Json options = Json::parse(run.run_json);
  for (const auto& [key, value] : options.items()) {
    if (others.count(key) > 0 || value == "camera" || value == "fast") continue;
    std::string option = key;
    std::replace(option.begin(), option.end(), '_', '-');
    text += " --" + option;
    for (const Json& file : value.is_array() ? value : Json::array()) add(file.at("path"));
    if (value.is_object()) add(value.at("path"));
    if (value.is_string() || value.is_number()) add(value);
  }
  return text + " --out DIR";
}

Json settings_of(const BoardConfig& board) {
  Json all = Json::array();
  for (const platform::BoardValue& value : platform::values_of(board)) {
    Json setting = {{"key", value.path}};
    std::visit([&setting](const auto& its) { setting["value"] = its; }, value.value);
    if (const platform::Key* const key = platform::find_key(platform::schema_path(value.path))) {
      setting["meaning"] = key->meaning;
      if (!key->unit.empty()) setting["unit"] = key->unit;
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

// Of the frames that the bound of the run is of: of the whole computer whole turns, else its own frames.
Json bounds_of(const BoardConfig& board, const platform::Tables& tables, const platform::Statistics& run) {
  const platform::FrameAccesses accesses = platform::frame_accesses(board, tables);
  const std::uint64_t turn = platform::allocation_period_frames(board);
  const std::uint64_t frames = run.computer ? turn : run.frames;
  Json core = Json::array();
  for (std::uint64_t frame = 0; frame < std::min(turn, frames); ++frame) {
    Json resources = Json::array();
    for (const platform::ResourceBound& bound : platform::frame_bounds(board, accesses, frame))
      resources.push_back({{"resource", bound.resource}, {"cycles", bound.cycles}});
    core.push_back(std::move(resources));
  }
  Json bounds = {{"core", std::move(core)}};
  if (!run.computer) return bounds;
  bounds["computer"] = Json::array();
  for (const platform::RateBound& bound : platform::computer_bounds(board, accesses, true, frames)) {
    bounds["computer"].push_back(
        {{"resource", bound.resource}, {"frames_per_second", bound.frames_per_second}});
  }
  return bounds;
}

// The area with all that the device has.
Json area_data(const BoardConfig& board) {
  const area::Device& device = platform::device_of(board);
  Json data = stats::area_document(board);
  data["device"] = {{"name", device.name},
                    {"slices", device.slices},
                    {"block_rams", device.block_rams},
                    {"multipliers", device.multipliers}};
  return data;
}

// The identities among the figures of a run that keeps them.
Json identities_of(const BoardConfig& board, const platform::Statistics& statistics) {
  std::vector<platform::Identity> identities;
  platform::Audit audit(&identities);
  platform::audit_core(statistics, audit);
  platform::audit_accesses(board, statistics, audit);
  if (statistics.computer) platform::audit_computer(*statistics.computer, audit);
  Json all = Json::array();
  for (const platform::Identity& each : identities)
    all.push_back({each.what, each.left, each.as, each.right});
  return all;
}

std::string png_url(const std::string& bytes) {
  return "data:image/png;base64," + files::base64(bytes.data(), bytes.size());
}

std::set<std::string> banks_used(const BoardConfig& board) {
  std::set<std::string> banks;
  for (const platform::PlacedBuffer& buffer : platform::buffers(board)) banks.insert(buffer.bank);
  return banks;
}

// Adds the banks that a changed board uses and the board does not: by name those that the board has, and the
// number of the others.
void add_banks_taken(const BoardConfig& board, const BoardConfig& changed, Json& data) {
  const std::set<std::string> used = banks_used(board);
  std::vector<std::string> idle;
  std::size_t lacking = 0;
  for (const std::string& bank : banks_used(changed)) {
    if (used.count(bank) > 0) continue;
    const bool is_there = std::any_of(board.banks.begin(), board.banks.end(),
                                      [&](const platform::BankConfig& own) { return own.name == bank; });
    if (is_there) idle.push_back(bank);
    lacking += is_there ? 0 : 1;
  }
  data["idle_banks"] = idle;
  data["new_banks"] = lacking;
}

// What a board costs and how hard its busiest bank works.
void add_prices(const BoardConfig& board, const runs::Explanation::BusiestBank& busiest, Json& data) {
  const double pixels = static_cast<double>(board.image.width) * board.image.height;
  data["banks_used"] = banks_used(board).size();
  data["busiest_bank"] = {{"name", busiest.name},
                          {"accesses_per_pixel", busiest.accesses_per_frame / pixels}};
  data["clock_mhz"] = board.fpga.clock_mhz;
}

// What follows from a board and the figures of its run.
Json figures_data(const BoardConfig& board, const platform::Tables& tables,
                  const platform::Statistics& statistics, Json stats) {
  return {{"stats", std::move(stats)},
          {"settings", settings_of(board)},
          {"banks", banks_of(board)},
          {"bounds", bounds_of(board, tables, statistics)},
          {"area", area_data(board)},
          {"pins", platform::pins_of(board)},
          {"banks_used", banks_used(board).size()},
          {"identities", identities_of(board, statistics)},
          {"memory_chart", memory_chart_svg({board, statistics.computer.has_value(), &statistics})}};
}

// The left picture of a frame as the matcher sees it.
kernels::GrayImage left_picture(const runs::RunInput& input, std::uint64_t frame) {
  kernels::GrayImage left = input.pairs->pair(frame).left;
  return input.tables.left ? kernels::rectify(left, *input.tables.left) : left;
}

// The nearest disparity of each pixel; where it is unknown or above 254, that of no answer.
kernels::GrayImage truth_picture(const media::Truth& truth) {
  kernels::GrayImage picture(truth.width, truth.height);
  std::transform(truth.levels.begin(), truth.levels.end(), picture.pixels.begin(), [&truth](float level) {
    const double disparity = std::round(level / truth.scale);
    return level > 0 && disparity < kernels::kInvalidDisparity ? static_cast<std::uint8_t>(disparity)
                                                               : kernels::kInvalidDisparity;
  });
  return picture;
}

}  // namespace

std::string picture_url(const kernels::GrayImage& picture) {
  const std::vector<std::uint8_t> png = media::encode_png_gray(picture);
  return png_url(std::string(png.begin(), png.end()));
}

Json run_data(const runs::RecordedRun& run, const platform::Tables& tables) {
  const auto read = [&run](const char* name) {
    return files::read_whole_file(std::filesystem::path(run.folder) / name);
  };
  Json data = {{"folder", run.folder}, {"command", command_of(run)}};
  data.update(figures_data(run.board, tables, run.statistics, Json::parse(run.stats_json)));
  data["config_yaml"] = read("config.yaml");
  if (!run.options.timing_only) {
    data["pictures"] = {{"disparity", png_url(read("disparity.png"))},
                        {"disparities", run.board.matcher.disparities}};
  }
  return data;
}

Json run_data(const runs::RunInput& input, const platform::Statistics& statistics,
              const stats::TableExtras& extras, const runs::Result& last, const RecordingData* recording) {
  Json data = figures_data(input.board, input.tables, statistics, stats::run_document(statistics, extras));
  data["config_yaml"] = platform::to_yaml(input.board);
  if (recording != nullptr) data["recording"] = recording->json();
  if (input.timing_only) return data;
  data["pictures"] = {{"disparity", picture_url(last.disparity)},
                      {"disparities", input.board.matcher.disparities},
                      {"left", picture_url(left_picture(input, last.number))}};
  const std::optional<media::Truth> truth = input.truth         ? input.truth
                                            : input.calibration ? std::nullopt
                                                                : input.pairs->truth(last.number);
  if (truth) data["pictures"]["truth"] = picture_url(truth_picture(*truth));
  return data;
}

bool add_recording(const runs::RecordedRun& run, runs::RunInput& input, Json& data) {
  RecordingData recording(run.board, input.camera, run.folder);
  if (!recording.add_folder(run.statistics)) return false;
  data["recording"] = recording.json();
  if (run.options.timing_only) return true;
  const std::uint64_t last = input.camera ? recording.last_camera_frame() : run.options.frames - 1;
  data["pictures"]["left"] = picture_url(left_picture(input, last));
  return true;
}

Json knobs_data(const BoardConfig& board, runs::Explanation& explanation) {
  Json data = runs::explanation_document(board, explanation);
  add_prices(board, explanation.busiest_bank(), data);
  data["uncertainty_frames_per_second"] = explanation.now().uncertainty;
  std::size_t number = 0;
  for (const runs::Explanation::Step& found : explanation.steps()) {
    if (!found.rate.failure.empty()) continue;
    Json& change = data["changes"][number++];
    add_prices(found.step->board, found.busiest, change);
    add_banks_taken(board, found.step->board, change);
    change["uncertainty_frames_per_second"] = found.rate.uncertainty;
  }
  return data;
}

}  // namespace stereotlm::report
