#include "sw/runs/result_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>
#include <utility>

#include "sw/files/folder_entries.h"
#include "sw/files/output_file.h"

namespace stereotlm::runs {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFrames = "frames";

constexpr std::array kFileNames = {"config.yaml",     "conflicts.csv", "depth.ply",     "depth.png",
                                   "depth_color.png", "disparity.pfm", "disparity.png", "disparity_color.png",
                                   "latency.csv",     "rows.csv",      "run.json",      "stats.json",
                                   "timeline.csv"};

bool is_file_name(const std::string& name) {
  return std::find(kFileNames.begin(), kFileNames.end(), name) != kFileNames.end();
}

// Whether the name is that of a frame: NNNNNN.png; from frame 1,000,000 on with more digits.
bool is_frame_name(const std::string& name) {
  const std::size_t dot = name.find('.');
  return dot != std::string::npos && dot >= 6 && name.substr(dot) == ".png" &&
         name.find_first_not_of("0123456789") == dot;
}

bool is_result_name(const std::string& name) {
  const std::string folder = std::string(kFrames) + "/";
  return is_file_name(name) || (name.rfind(folder, 0) == 0 && is_frame_name(name.substr(folder.size())));
}

std::optional<std::string> foreign_part(const fs::path& entry) {
  const std::string name = entry.filename();
  if (is_file_name(name) && files::is_file(entry)) return std::nullopt;
  if (name != kFrames || !files::is_folder(entry)) return name;
  for (const fs::path& frame : files::entries(entry)) {
    if (!is_frame_name(frame) || !files::is_file(entry / frame)) return name / frame;
  }
  return std::nullopt;
}

std::optional<std::string> problem_of(const fs::path& dir, bool was_left) {
  constexpr const char* kRule = "must be empty or hold run.json and only files that run writes";
  std::vector<fs::path> names = files::entries(dir);
  names.erase(std::remove(names.begin(), names.end(), files::kAsideFolder), names.end());
  for (const fs::path& name : names) {
    if (const auto foreign = foreign_part(dir / name)) return fmt::format("holds '{}': {}", *foreign, kRule);
  }
  if (was_left || names.empty() || files::is_file(dir / files::kResultMark)) return std::nullopt;
  return fmt::format("holds '{}' but no run.json: {}", names.front().string(), kRule);
}

}  // namespace

std::string frame_file_name(std::uint64_t frame) { return fmt::format("{}/{:06}.png", kFrames, frame); }

ResultFolder::ResultFolder(const fs::path& dir, std::vector<files::NamedFile> inputs)
    : folder_(dir, files::OutputContent{"result folder", files::kResultMark, foreign_part, problem_of,
                                        nullptr, files::kAsideFolder, std::move(inputs)}) {}

void ResultFolder::check_new(const std::string& name) {
  if (!is_result_name(name))
    throw std::invalid_argument(fmt::format("result file = '{}': not one of run's", name));
  if (!added_.insert(name).second)
    throw std::invalid_argument(fmt::format("result file = '{}': added twice", name));
}

void ResultFolder::add(const std::string& name, std::string_view bytes) {
  check_new(name);
  folder_.add(name, bytes);
}

void ResultFolder::append(const std::string& name, std::string_view bytes) {
  if (appended_.insert(name).second) check_new(name);
  folder_.append(name, bytes);
}

void ResultFolder::add(const std::string& name, const std::vector<std::uint8_t>& bytes) {
  add(name, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

void ResultFolder::commit() {
  const fs::path frames = folder_.path() / kFrames;
  if (files::is_folder(frames)) {
    if (const auto foreign = foreign_part(frames))
      folder_.refuse(fmt::format("has been given '{}' during the run: the result is not written", *foreign));
  }
  folder_.commit();
}

}  // namespace stereotlm::runs
