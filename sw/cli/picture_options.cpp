#include "sw/cli/picture_options.h"

#include <fmt/format.h>

namespace stereotlm::cli {
namespace {

constexpr const char* kPictureOptions =
    "--left F --right F, --sequence DIR, --video F [F2] or --synthetic SEED";

}  // namespace

void PictureOptions::add_to(CLI::App& command) {
  left_.add_to(command, "--left", "F",
               "The left picture of one pair for every frame, 8-bit, as large as the board's images");
  right_.add_to(command, "--right", "F", "The right picture");
  sequence_.add_to(command, "--sequence", "DIR",
                   "A folder of pairs left_*.png and right_*.png, shown in the order of their names");
  video_.add_to(command, "--video", "F [F2]", "A video of pairs, or two videos, the left one first");
  video_.takes(1, 2);
  video_layout_.add_to(
      command, "--video-layout", "LAYOUT",
      "Where --video has the pictures of a pair: two (files), side_by_side or top_bottom (in one "
      "file, the left one in the left or upper half of each frame)");
  synthetic_.add_to(command, "--synthetic", "SEED",
                    "A synthetic moving scene with known disparities; another one for each SEED, 0 or more");
}

void PictureOptions::check_given(process::Problems& problems, bool may_be_missing) const {
  if (!may_be_missing && sources_given().empty())
    problems.add(fmt::format("pictures: missing: a run needs {}", kPictureOptions));
  if (left_.is_given() == right_.is_given()) return;
  problems.add(left_.is_given() ? "--right: missing: goes with --left F"
                                : "--left: missing: goes with --right F");
}

void PictureOptions::check_usage(process::Problems& problems) {
  const std::vector<std::string> given = sources_given();
  if (given.size() > 1) {
    problems.add(
        fmt::format("{}: a run has one source of pictures: {}", fmt::join(given, ", "), kPictureOptions));
  }
  if (left_.is_given()) source.pair = {left_.text, right_.text};
  if (sequence_.is_given()) source.sequence = sequence_.text;
  check_video(problems);
  check_synthetic(problems);
}

std::vector<std::string> PictureOptions::sources_given() const {
  std::vector<std::string> names;
  if (left_.is_given() || right_.is_given()) names.emplace_back(left_.is_given() ? "--left" : "--right");
  if (sequence_.is_given()) names.emplace_back("--sequence");
  if (video_.is_given()) names.emplace_back("--video");
  if (synthetic_.is_given()) names.emplace_back("--synthetic");
  return names;
}

void PictureOptions::check_video(process::Problems& problems) {
  const std::string option = "--video-layout";
  if (!video_.is_given()) {
    if (video_layout_.is_given()) problems.add(option + ": goes with --video F [F2]");
    return;
  }
  const std::string& name = video_layout_.text;
  if (!video_layout_.is_given()) {
    problems.add(fmt::format("{}: missing: goes with --video, one of {}", option,
                             platform::listed(runs::kVideoLayoutNames)));
  } else if (is_one_of(runs::kVideoLayoutNames, option, name, problems)) {
    source.video = {video_.text, *runs::video_layout_of(name), name};
    const std::size_t needed = source.video->layout == runs::VideoLayout::kTwo ? 2 : 1;
    if (video_.text.size() != needed) {
      problems.add(fmt::format("--video '{}': must name {} with {} {}", fmt::join(video_.text, "' '"),
                               needed == 1 ? "one file" : "two files", option, name));
    }
  }
}

void PictureOptions::check_synthetic(process::Problems& problems) {
  if (!synthetic_.is_given()) return;
  source.synthetic = number_of<std::uint64_t>(synthetic_.text);
  if (!source.synthetic) {
    problems.add(fmt::format("--synthetic = {}: must be an integer, 0..2^64-1", synthetic_.text));
  }
}

}  // namespace stereotlm::cli
