#include "sw/cli/run_options.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "platform/config/board_keys.h"

namespace stereotlm::cli {
namespace {

constexpr const char* kPictureOptions =
    "--left F --right F, --sequence DIR, --video F [F2] or --synthetic SEED";

}  // namespace

TruthOptions::TruthOptions(Options* of, const std::string& picture)
    : file_(of, "--truth", "F", fmt::format("Ground truth of {}, 8-bit grey, 0 = unknown", picture)),
      scale_(
          of, "--truth-scale", "S", "Grey levels of the truth per disparity (default 1)",
          {number<double>("a number above 0", [](double scale) { return std::isfinite(scale) && scale > 0; }),
           goes_with(file_, "F")}) {}

PictureOptions::PictureOptions(Options* of)
    : left_(of, "--left", "F",
            "The left picture of one pair for every frame, 8-bit, as large as the board's images"),
      right_(of, "--right", "F", "The right picture"),
      sequence_(of, "--sequence", "DIR",
                "A folder of pairs left_*.png and right_*.png, shown in the order of their names"),
      video_(of, "--video", "F [F2]", "A video of pairs, or two videos, the left one first", {},
             Takes::kOneOrTwo),
      video_layout_(
          of, "--video-layout", "LAYOUT",
          "Where --video has the pictures of a pair: two (files), side_by_side or top_bottom (in one "
          "file, the left one in the left or upper half of each frame)",
          {goes_with(video_, "F [F2]"), one_of(runs::kVideoLayoutNames)}),
      synthetic_(of, "--synthetic", "SEED",
                 "A synthetic moving scene with known disparities; another one for each SEED, 0 or more",
                 {number<std::uint64_t>(kSeedRule)}) {}

bool PictureOptions::check_given(process::Problems& problems, bool may_be_missing) const {
  const bool is_missing = !may_be_missing && sources_given().empty();
  if (is_missing) problems.add(fmt::format("pictures: missing: a run needs {}", kPictureOptions));
  if (left_.is_given() == right_.is_given()) return !is_missing;
  problems.add(left_.is_given() ? "--right: missing: goes with --left F"
                                : "--left: missing: goes with --right F");
  return false;
}

void PictureOptions::check_together(process::Problems& problems) const {
  const std::vector<std::string> given = sources_given();
  if (given.size() > 1) {
    problems.add(
        fmt::format("{}: a run has one source of pictures: {}", fmt::join(given, ", "), kPictureOptions));
  }
  if (!video_.is_given()) return;
  const std::string& layout = video_layout_.text();
  if (!video_layout_.is_given()) {
    problems.add(fmt::format("--video-layout: missing: goes with --video, one of {}",
                             platform::listed(runs::kVideoLayoutNames)));
  } else if (runs::video_layout_of(layout)) {
    const std::size_t needed = runs::video_layout_of(layout) == runs::VideoLayout::kTwo ? 2 : 1;
    if (video_.texts().size() != needed) {
      problems.add(fmt::format("--video '{}': must name {} with --video-layout {}",
                               fmt::join(video_.texts(), "' '"), needed == 1 ? "one file" : "two files",
                               layout));
    }
  }
}

std::vector<std::string> PictureOptions::sources_given() const {
  std::vector<std::string> names;
  if (left_.is_given() || right_.is_given()) names.push_back(left_.is_given() ? "--left" : "--right");
  for (const Option* option : {&sequence_, &video_, &synthetic_}) {
    if (option->is_given()) names.push_back(option->name());
  }
  return names;
}

runs::PictureSource PictureOptions::source() const {
  runs::PictureSource source;
  if (left_.is_given()) source.pair = {left_.text(), right_.text()};
  source.sequence = sequence_.if_given();
  if (const auto layout = runs::video_layout_of(video_layout_.text()); video_.is_given() && layout)
    source.video = {video_.texts(), *layout, video_layout_.text()};
  source.synthetic = synthetic_.number<std::uint64_t>();
  return source;
}

RunOptions::RunOptions(Options* of, Options* more, const std::string& beside_board)
    : board(of, beside_board),
      pictures(of),
      frames(of, "--frames", "N",
             "Frames to deliver, 1 or more; frame f of the cameras, or of the board if preloaded, shows "
             "pair f modulo the "
             "number of pairs (default 1; with --sequence and --video as many as there are pairs)",
             {number<std::uint64_t>("an integer, 1 or more", [](std::uint64_t count) { return count > 0; })}),
      source(
          of,
          "camera (the default): cameras of a whole computer; preloaded: pictures appear in their buffers in "
          "no time"),
      fidelity(of, "--fidelity", "fast|cycle",
               "How the simulation works; the results are the same to the bit and to the "
               "cycle: fast (the default), "
               "or cycle by cycle, every access a transaction",
               {one_of({"fast", "cycle"})}),
      timing_only(
          of, "--timing-only", "",
          "Leave out all pixels: the times and counts are the same, and no picture is needed; writes no "
          "disparities"),
      verify(more, "--verify", "",
             "Run at the other fidelity too, in a second process, and compare every figure, time and pixel"),
      truth(more, "the left picture that the last frame shows"),
      out(more, "--out", "DIR",
          "Folder for the result files: created if missing, else empty or an earlier result, which is "
          "replaced (default: no files)"),
      save_frames(
          more, "--save-frames", "",
          "Write the disparities of every frame too: frames/000000.png and so on in the folder of --out, "
          "numbered by camera frame",
          {goes_with(out, "DIR")}),
      record(
          more, "--record,--conflicts", "",
          "Write where and when ports wait: rows.csv and conflicts.csv in the folder of --out; with cameras "
          "also what happened when, and why it waited: timeline.csv and latency.csv",
          {goes_with(out, "DIR")}),
      trace(more),
      json(more) {}

bool RunOptions::has_board_only() const {
  return !board.changes_board() && !pictures.is_given() && !frames.is_given() && !source.is_given() &&
         !fidelity.is_given() && !timing_only.is_given();
}

void RunOptions::check_together(const std::string& command, process::Problems& problems) const {
  const bool has_pictures = pictures.check_given(problems, timing_only.is_given());
  pictures.check_together(problems);
  trace.check_together(problems);
  if (truth.file() && pictures.source().synthetic)
    problems.add("--truth: does not go with --synthetic, whose scene is its own truth");
  for (const auto& [name, given] :
       {std::pair("--truth", truth.file().has_value()), std::pair("--save-frames", save_frames.is_given())}) {
    if (timing_only.is_given() && given)
      problems.add(fmt::format("{}: does not go with --timing-only, which has no disparities", name));
  }
  if (!problems.empty() && board.is_given()) board.load(problems);  // all at once: those of its files too
  if (!board.is_given() || !has_pictures)
    problems.add_note(
        fmt::format("a complete command: stereotlm {} fpl2003 --left left.png --right right.png", command));
}

}  // namespace stereotlm::cli
