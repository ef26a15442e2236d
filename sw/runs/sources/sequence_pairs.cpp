#include "sw/runs/sources/sequence_pairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "sw/files/sha256.h"
#include "sw/media/load.h"

namespace stereotlm::runs {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLeft = "left_";
constexpr const char* kRight = "right_";
constexpr const char* kSuffix = ".png";
constexpr std::size_t kMostKeptBytes = 128'000'000;

// For the names of the form `beginning*.png`: the parts that stand for `*`, sorted.
std::vector<std::string> stems(const std::vector<std::string>& names, const std::string& beginning) {
  const std::string suffix = kSuffix;
  std::vector<std::string> result;
  for (const std::string& name : names) {
    if (name.size() < beginning.size() + suffix.size() || name.rfind(beginning, 0) != 0) continue;
    if (name.substr(name.size() - suffix.size()) != suffix) continue;
    result.push_back(name.substr(beginning.size(), name.size() - beginning.size() - suffix.size()));
  }
  std::sort(result.begin(), result.end());
  return result;
}

std::vector<std::string> names_in(const std::string& folder) {
  constexpr const char* kRule = "a sequence must be a readable folder";
  std::error_code error;
  std::vector<std::string> names;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    names.push_back(entry->path().filename().string());
  }
  if (error) throw std::runtime_error(fmt::format("'{}': {}: {}", folder, error.message(), kRule));
  return names;
}

// Throws std::runtime_error if a picture has no partner: if an entry of `stems` is not in `others`.
void check_partners(const fs::path& folder, const char* beginning, const std::vector<std::string>& stems,
                    const char* other_beginning, const std::vector<std::string>& others) {
  std::vector<std::string> alone;
  std::set_difference(stems.begin(), stems.end(), others.begin(), others.end(), std::back_inserter(alone));
  if (alone.empty()) return;
  const auto name = [&alone](const char* start) { return start + alone.front() + kSuffix; };
  const std::string more = alone.size() == 1 ? "" : fmt::format(", and {} more", alone.size() - 1);
  throw std::runtime_error(fmt::format("'{}': without partner{}: there must be a '{}'",
                                       (folder / name(beginning)).string(), more, name(other_beginning)));
}

}  // namespace

SequencePairs::SequencePairs(const std::string& folder, const platform::BoardConfig* board)
    : PairSource("--sequence", 0) {
  const std::vector<std::string> names = names_in(folder);
  const std::vector<std::string> left = stems(names, kLeft);
  const std::vector<std::string> right = stems(names, kRight);
  check_partners(folder, kLeft, left, kRight, right);
  check_partners(folder, kRight, right, kLeft, left);
  if (left.empty()) {
    throw std::runtime_error(
        fmt::format("'{}': no pictures: a sequence must have pairs left_*.png and right_*.png", folder));
  }
  std::size_t kept_bytes = 0;
  input_.path = fs::absolute(folder).string();
  for (const std::string& stem : left) {
    for (const char* beginning : {kLeft, kRight}) {
      const std::string name = beginning + stem + kSuffix;
      const std::string path = (fs::path(folder) / name).string();
      media::LoadedGray picture = media::load_gray(path);
      if (const auto problem = size_problem(picture.image.width, picture.image.height, board))
        throw std::runtime_error(fmt::format("'{}'{}", path, *problem));
      converted_ += picture.converted_from_colour ? 1U : 0U;
      input_.files.push_back({name, files::sha256_file(path)});
      kept_bytes += picture.image.pixels.size();
      if (kept_bytes <= kMostKeptBytes) kept_.push_back(std::move(picture.image));
    }
  }
  set_length(left.size());
}

host::StereoPair SequencePairs::load(std::uint64_t index) {
  const auto left = static_cast<std::size_t>(2 * index);
  return {load_picture(left), load_picture(left + 1)};
}

kernels::GrayImage SequencePairs::load_picture(std::size_t number) const {
  const InputFile& file = input_.files[number];
  const std::string path = (fs::path(input_.path) / file.path).string();
  if (files::sha256_file(path) != file.sha256) {
    throw std::runtime_error(fmt::format("'{}': changed: a picture must not change during a run", path));
  }
  return number < kept_.size() ? kept_[number] : media::load_gray(path).image;
}

}  // namespace stereotlm::runs
