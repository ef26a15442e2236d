#include "sw/runs/result_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>

namespace stereotlm::runs {
namespace {

constexpr const char* kFrames = "frames/";

constexpr std::array kFileNames = {"config.yaml",     "conflicts.csv", "depth.ply",     "depth.png",
                                   "depth_color.png", "disparity.pfm", "disparity.png", "disparity_color.png",
                                   "latency.csv",     "rows.csv",      "run.json",      "stats.json",
                                   "timeline.csv",    kFrames};

// Whether the name is that of a frame: NNNNNN.png; from frame 1,000,000 on with more digits.
bool is_frame_name(const std::string& name) {
  const std::size_t dot = name.find('.');
  return dot != std::string::npos && dot >= 6 && name.substr(dot) == ".png" &&
         name.find_first_not_of("0123456789") == dot;
}

bool is_result_name(const std::string& name) {
  const std::string frames = kFrames;
  return std::find(kFileNames.begin(), kFileNames.end(), name) != kFileNames.end() ||
         (name.rfind(frames, 0) == 0 && is_frame_name(name.substr(frames.size())));
}

}  // namespace

std::string frame_file_name(std::uint64_t frame) { return fmt::format("{}{:06}.png", kFrames, frame); }

files::OutputContent result_content(std::vector<files::NamedFile> inputs) {
  files::OutputContent content;
  content.called = "result folder";
  content.mark = files::kResultMark;
  content.kind = {"result of run", [](const std::filesystem::path& /*file*/) { return true; }};
  content.rule = "must be empty or hold run.json and only files that run writes";
  content.is_ours = is_result_name;
  content.inputs = std::move(inputs);
  return content;
}

}  // namespace stereotlm::runs
