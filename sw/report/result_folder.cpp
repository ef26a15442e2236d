#include "sw/report/result_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "sw/report/whole_file.h"

namespace stereotlm::report {
namespace {

namespace fs = std::filesystem;

constexpr const char* kAside = ".partial";  // holds kNew and, during a commit, kEarlier
constexpr const char* kNew = "new";
constexpr const char* kEarlier = "earlier";
constexpr const char* kProbe = "probe";
constexpr const char* kFrames = "frames";
constexpr const char* kRunJson = "run.json";

constexpr std::array kFileNames = {"config.yaml",   "depth.ply", "depth.png",           "disparity.pfm",
                                   "disparity.png", "run.json",  "disparity_color.png", "stats.json"};

bool is_file_name(const std::string& name) {
  return std::find(kFileNames.begin(), kFileNames.end(), name) != kFileNames.end();
}

// NNNNNN.png; a seventh digit appears after a million frames.
bool is_frame_name(const std::string& name) {
  const std::size_t dot = name.find('.');
  return dot != std::string::npos && dot >= 6 && name.substr(dot) == ".png" &&
         name.find_first_not_of("0123456789") == dot;
}

bool is_result_name(const std::string& name) {
  const std::string folder = std::string(kFrames) + "/";
  return is_file_name(name) || (name.rfind(folder, 0) == 0 && is_frame_name(name.substr(folder.size())));
}

// In order of name. A symbolic link is neither a file nor a folder of ours.
std::vector<fs::path> entries(const fs::path& folder) {
  std::vector<fs::path> result(fs::directory_iterator(folder), fs::directory_iterator{});
  for (fs::path& entry : result) entry = entry.filename();
  std::sort(result.begin(), result.end());
  return result;
}
bool is_file(const fs::path& path) { return fs::is_regular_file(fs::symlink_status(path)); }
bool is_folder(const fs::path& path) { return fs::is_directory(fs::symlink_status(path)); }

// The first entry of a folder of frames that `run` does not write.
std::optional<std::string> foreign_frame(const fs::path& frames) {
  for (const fs::path& name : entries(frames)) {
    if (!is_frame_name(name) || !is_file(frames / name)) return name;
  }
  return std::nullopt;
}

// The first entry that `run` does not write, seen from `folder`; `.partial` does not count.
std::optional<std::string> foreign_entry(const fs::path& folder) {
  for (const fs::path& name : entries(folder)) {
    if (name == kAside) continue;
    if (name == kFrames && is_folder(folder / name)) {
      if (const auto foreign = foreign_frame(folder / name)) return name / *foreign;
    } else if (!is_file_name(name) || !is_file(folder / name)) {
      return name;
    }
  }
  return std::nullopt;
}

// The first entry of DIR/.partial that no killed run left there.
std::optional<std::string> foreign_entry_aside(const fs::path& aside) {
  if (!is_folder(aside)) return kAside;
  for (const fs::path& name : entries(aside)) {
    const fs::path path = aside / name;
    if (name == kProbe && is_file(path)) continue;
    if ((name != kNew && name != kEarlier) || !is_folder(path)) return kAside / name;
    if (const auto foreign = foreign_entry(path)) return kAside / name / *foreign;
    if (fs::exists(fs::symlink_status(path / kAside))) return kAside / name / kAside;
  }
  return std::nullopt;
}

}  // namespace

std::string frame_file_name(std::uint64_t frame) { return fmt::format("{}/{:06}.png", kFrames, frame); }

ResultFolder::ResultFolder(const fs::path& dir) : dir_(dir.empty() ? dir : fs::absolute(dir)) {
  if (dir_.empty()) throw std::runtime_error("result folder '': must be named");
  if (!dir_.has_filename()) dir_ = dir_.parent_path();
  try {
    created_.create(dir_);
    if (!fs::is_directory(dir_)) refuse("not a folder");
    lock();
    check_content();
    start_aside();
  } catch (const std::system_error& error) {
    discard();
    refuse("cannot be written to: " + error.code().message());
  } catch (...) {
    discard();
    throw;
  }
}

ResultFolder::~ResultFolder() { discard(); }

void ResultFolder::lock() {
  lock_ = open(dir_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0) throw std::system_error(errno, std::generic_category());
  // A file system without locks has no second run refused.
  if (flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) refuse("in use by another run");
}

void ResultFolder::check_content() const {
  constexpr const char* kRule = "must be empty or hold run.json and only files that run writes";
  if (const auto foreign = foreign_entry(dir_)) refuse(fmt::format("holds '{}': {}", *foreign, kRule));
  if (fs::exists(fs::symlink_status(dir_ / kAside))) {
    if (const auto foreign = foreign_entry_aside(dir_ / kAside))
      refuse(fmt::format("holds '{}': {}", *foreign, kRule));
  } else if (!fs::is_empty(dir_) && !is_file(dir_ / kRunJson)) {
    refuse(fmt::format("holds '{}' but no run.json: {}", entries(dir_).front().string(), kRule));
  }
}

void ResultFolder::start_aside() {
  const fs::path aside = dir_ / kAside;
  fs::remove_all(aside);
  fs::create_directory(aside);
  owns_aside_ = true;
  fs::create_directory(aside / kNew);
  write_whole_file(aside / kProbe, "can this folder be written to?");
  fs::remove(aside / kProbe);
}

void ResultFolder::add(const std::string& name, std::string_view bytes) {
  if (!is_result_name(name))
    throw std::invalid_argument(fmt::format("result file = '{}': not one of run's", name));
  if (!added_.insert(name).second)
    throw std::invalid_argument(fmt::format("result file = '{}': added twice", name));
  const fs::path path = dir_ / kAside / kNew / name;
  try {
    fs::create_directory(path.parent_path());
    write_whole_file(path, bytes);
  } catch (const std::system_error& error) {
    std::error_code ignored;
    fs::remove(path, ignored);
    refuse(fmt::format("'{}' cannot be written: {}", name, error.code().message()));
  }
}

void ResultFolder::add(const std::string& name, const std::vector<std::uint8_t>& bytes) {
  add(name, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

void ResultFolder::commit() {
  if (committed_ || added_.count(kRunJson) == 0)
    throw std::logic_error("a result is committed once, with run.json");
  const fs::path made = dir_ / kAside / kNew;
  const fs::path earlier = dir_ / kAside / kEarlier;
  if (is_folder(dir_ / kFrames)) {
    if (const auto foreign = foreign_frame(dir_ / kFrames)) {
      refuse(
          fmt::format("has been given '{}/{}' during the run: the result is not written", kFrames, *foreign));
    }
  }
  std::vector<std::pair<fs::path, fs::path>> moves;
  const auto move = [&moves](const fs::path& from, const fs::path& to) {
    fs::rename(from, to);
    moves.emplace_back(from, to);
  };
  try {
    fs::create_directory(earlier);
    for (const fs::path& name : entries(dir_)) {
      const fs::path path = dir_ / name;
      if ((is_file_name(name) && is_file(path)) || name == kFrames) move(path, earlier / name);
    }
    if (is_folder(made / kFrames)) sync_folder(made / kFrames);
    for (const fs::path& name : entries(made)) {
      if (name != kRunJson) move(made / name, dir_ / name);
    }
    move(made / kRunJson, dir_ / kRunJson);  // last: a folder without it is no result
    sync_folder(dir_);
  } catch (const std::system_error& error) {
    std::error_code ignored;
    for (auto last = moves.rbegin(); last != moves.rend(); ++last)
      fs::rename(last->second, last->first, ignored);
    refuse(fmt::format("the result cannot be moved into place: {}", error.code().message()));
  }
  committed_ = true;
  discard();
}

void ResultFolder::discard() noexcept {
  std::error_code ignored;
  if (owns_aside_) fs::remove_all(dir_ / kAside, ignored);
  owns_aside_ = false;
  if (committed_) created_.keep();
  created_.remove();
  if (lock_ >= 0) close(lock_);
  lock_ = -1;
}

void ResultFolder::refuse(const std::string& found) const {
  throw std::runtime_error(fmt::format("result folder '{}': {}", dir_.string(), found));
}

}  // namespace stereotlm::report
