#include "sw/runs/run_results.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "calib/calibration.h"
#include "calib/depth.h"
#include "calib/png.h"
#include "platform/records/conflicts.h"
#include "sw/files/text_forms.h"
#include "sw/media/encode.h"
#include "sw/process/client.h"
#include "sw/process/streams.h"
#include "sw/runs/pair_check.h"
#include "sw/runs/simulation/simulate_point.h"
#include "sw/runs/sources/calibration_library.h"
#include "sw/stats/accuracy.h"
#include "sw/stats/console_table.h"
#include "sw/stats/record_csv.h"
#include "sw/stats/stats_json.h"

namespace stereotlm::runs {
namespace {

void add_pictures(const RunInput& input, const Result& last, files::OutputFolder& folder) {
  const kernels::GrayImage& disparity = last.disparity;
  folder.add("disparity.png", media::encode_png_gray(disparity));
  folder.add("disparity.pfm", media::encode_pfm(disparity));
  folder.add("disparity_color.png",
             media::encode_disparity_color_png(disparity, input.board.matcher.disparities));
  if (!input.calibration) return;
  const calib::DepthGeometry geometry = {input.calibration->rectification.q,
                                         input.calibration->disparity_offset};
  const kernels::GrayImage left = kernels::rectify(input.pairs->pair(last.number).left, *input.tables.left);
  const std::vector<std::uint16_t> depths = calib::depth_millimetres(geometry, disparity);
  folder.add("depth.png",
             calib::encode_png(disparity.width, disparity.height, calib::PngPixel::kGrey16, depths.data()));
  folder.add("depth_color.png",
             calibration_functions().encode_depth_color_png(disparity.width, disparity.height, depths));
  folder.add("depth.ply", calib::point_cloud_ply(geometry, disparity, left));
}

// Sends a picture to the client of this process.
void send(const std::string& name, const kernels::GrayImage& image) {
  process::client->send({name,
                         {static_cast<std::uint64_t>(image.height), static_cast<std::uint64_t>(image.width)},
                         std::string(image.pixels.begin(), image.pixels.end())});
}

void write_files(RunInput& input, platform::Statistics statistics, const Result& last,
                 const std::optional<stats::Accuracy>& accuracy,
                 const std::vector<std::string>& differences) {
  statistics.failed.insert(statistics.failed.end(), differences.begin(), differences.end());
  files::OutputFolder& folder = *input.folder;
  if (!input.timing_only) add_pictures(input, last, folder);
  folder.add("stats.json", stats::stats_json(statistics, accuracy));
  folder.add("config.yaml", platform::to_yaml(input.board));
  // An interrupted run is recorded as a complete run of the frames that it has finished.
  input.described.frames = statistics.frames;
  folder.add("run.json", run_json(input.described));
  folder.commit();
}

// The accuracy to print. Without --truth, it is that against the truth of a synthetic scene, which holds only
// without calibration. stats.json has only the accuracy against --truth.
std::optional<stats::Accuracy> accuracy_to_show(const RunInput& input, const Result& last,
                                                const std::optional<stats::Accuracy>& accuracy) {
  if (accuracy || input.calibration || input.timing_only) return accuracy;
  const std::optional<media::Truth> truth = input.pairs->truth(last.number);
  if (!truth) return std::nullopt;
  return stats::accuracy(last.disparity,
                         media::with_offset(*truth, input.described.disparity_offset.value_or(0)));
}

// `accuracy`: against --truth.
stats::TableExtras extras_of(const RunInput& input, const platform::Statistics& statistics,
                             const Result& last, const std::optional<stats::Accuracy>& accuracy) {
  stats::TableExtras extras;
  if (!statistics.blame.empty()) {
    extras.waitless_frames_per_second =
        waitless_frames_per_second(input.board, input.tables, statistics.frames);
  }
  if (!input.timing_only) {
    const auto& pixels = last.disparity.pixels;
    const auto unanswered = std::count(pixels.begin(), pixels.end(), kernels::kInvalidDisparity);
    extras.answered_percent =
        100 - 100 * static_cast<double>(unanswered) / static_cast<double>(pixels.size());
  }
  extras.accuracy = accuracy_to_show(input, last, accuracy);
  return extras;
}

}  // namespace

std::string frame_file_name(std::uint64_t frame) { return fmt::format("frames/{:06}.png", frame); }

files::OutputContent result_content(std::vector<files::NamedFile> inputs) {
  files::OutputContent content;
  content.called = "result folder";
  content.mark = files::kResultMark;
  content.kind = {"result of run", [](const std::filesystem::path& /*file*/) { return true; }};
  content.rule = "must be empty or hold run.json and only files that run writes";
  content.names = {"@(config.yaml|run.json|stats.json)",
                   "@(conflicts|latency|rows|timeline).csv",
                   "depth.@(ply|png)",
                   "disparity.@(pfm|png)",
                   "@(depth|disparity)_color.png",
                   kKeptTruth,
                   "frames/",
                   "frames/[0-9][0-9][0-9][0-9][0-9]+([0-9]).png",
                   "pictures/",
                   "pictures/@(left|right)_[0-9][0-9][0-9][0-9][0-9]+([0-9]).png"};
  content.inputs = std::move(inputs);
  return content;
}

InputFile keep_file(const std::string& name, const std::string& content, files::OutputFolder& folder) {
  folder.add(name, content);
  return {(folder.path() / name).string(), files::sha256_hex(content.data(), content.size())};
}

InputFolder keep_pictures(PairSource& pairs, files::OutputFolder& folder) {
  InputFolder kept = {(folder.path() / "pictures").string(), {}};
  for (std::uint64_t index = 0; index < pairs.length(); ++index) {
    const host::StereoPair& pair = pairs.pair(index);
    for (const auto& [side, picture] : {std::pair("left", &pair.left), std::pair("right", &pair.right)}) {
      const std::string name = fmt::format("{}_{:06}.png", side, index);
      const std::vector<std::uint8_t> png = media::encode_png_gray(*picture);
      kept.files.push_back({name, files::sha256_hex(png.data(), png.size())});
      folder.add("pictures/" + name, png);
    }
  }
  return kept;
}

void save_frame(const RunInput& input, const Result& result) {
  if (!input.described.save_frames) return;
  const std::string name = frame_file_name(result.number);
  if (input.folder) input.folder->add(name, media::encode_png_gray(result.disparity));
  if (process::client != nullptr) send(name, result.disparity);
}

Records::Records(const RunInput& input) : input_(input) {
  if (input_.recorded_frames == 0) return;
  input_.record("rows.csv", stats::rows_csv_head(input.board));
  if (!input.camera) return;
  input_.record("timeline.csv", stats::timeline_csv_head());
  input_.record("latency.csv", stats::latency_csv_head());
}

void Records::add(Simulation& simulation) {
  for (const fpga::FrameConflicts& frame : simulation.take_conflicts()) {
    if (input_.trace) input_.trace->frame(platform::frame_runs(frame));
    if (input_.recorded_frames > 0)
      input_.record("rows.csv", stats::rows_csv(input_.board, frame.number, frame));
  }
  if (!input_.camera) return;
  platform::TimelineRecords records = simulation.take_timeline();
  if (input_.trace) input_.trace->events(records);
  if (input_.recorded_frames == 0) return;
  for (const platform::FrameLatency& frame : records.latencies) {
    if (frame.frame + 1 == input_.recorded_frames) end_ps_ = frame.begin_ps + frame.sum_ps();
  }
  const auto is_later = [this](const platform::TimelineEvent& event) { return event.end_ps > end_ps_; };
  records.events.erase(std::find_if(records.events.begin(), records.events.end(), is_later),
                       records.events.end());
  input_.record("timeline.csv", stats::timeline_csv(records.events));
  input_.record("latency.csv", stats::latency_csv(records.latencies));
}

void Records::finish(Simulation& simulation) {
  add(simulation);
  if (input_.recorded_frames > 0)
    input_.record("conflicts.csv", stats::conflicts_csv(input_.board, *simulation.conflicts()));
}

void leave_out_truth_of_another_pair(RunInput& input, std::uint64_t frames_done) {
  if (!input.truth) return;
  const std::uint64_t length = input.pairs->length();
  if ((frames_done - 1) % length == (input.frames - 1) % length) return;
  process::say("note", fmt::format("--truth is of the pair of frame {}, which was not reached: no accuracy",
                                   input.frames - 1));
  input.truth.reset();
  input.described.truth.reset();
}

void leave_out_verify(RunInput& input) {
  process::say("note", "--verify: interrupted: nothing is compared");
  input.described.verify = false;
}

void say_lost_pixels(const platform::Statistics& statistics, const std::string& subject) {
  const std::string text = stats::lost_pixels_text(platform::lost_pixels(statistics));
  if (!text.empty()) process::say("warning", subject + text);
}

bool deliver(RunInput& input, const platform::Statistics& statistics, const Result& last,
             const std::vector<std::string>& differences,
             const std::function<std::string(const stats::TableExtras&)>& text_of) {
  std::optional<stats::Accuracy> accuracy;
  if (input.truth) accuracy = stats::accuracy(last.disparity, *input.truth);
  if (input.folder) write_files(input, statistics, last, accuracy, differences);
  if (process::client != nullptr && !input.timing_only) send("disparity", last.disparity);
  for (const std::string& identity : statistics.failed)
    process::say("error", "identity does not hold: " + identity);
  const stats::TableExtras extras = extras_of(input, statistics, last, accuracy);
  process::print(text_of      ? text_of(extras)
                 : input.json ? files::json_text(stats::run_document(statistics, extras))
                              : stats::console_table(statistics, input.board, extras));
  say_lost_pixels(statistics);
  constexpr double kFewAnswers = 50;  // percent: exchanged pictures give no more
  if (!input.calibration && extras.answered_percent.value_or(100) < kFewAnswers)
    say_if_exchanged(input, input.pairs->pair(last.number));
  if (const double bad = accuracy ? accuracy->bad_1_percent.value_or(0) : 0;
      bad > stats::kDoubtfulBad1Percent)
    process::say("note", fmt::format("--truth: {:.2f} % of the answers are off by more than 1: is it of this "
                                     "picture, and is --truth-scale {:g} right?",
                                     bad, input.described.truth_scale));
  for (const std::string& difference : differences) process::say("error", difference);
  return statistics.failed.empty() && differences.empty();
}

}  // namespace stereotlm::runs
