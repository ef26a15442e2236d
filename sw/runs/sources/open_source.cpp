#include "sw/runs/sources/open_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <future>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "platform/config/board_config.h"
#include "sw/files/text_forms.h"
#include "sw/media/load.h"
#include "sw/media/synthetic_scene.h"
#include "sw/media/video.h"
#include "sw/runs/run_json.h"

namespace stereotlm::runs {
namespace {

namespace fs = std::filesystem;
using kernels::GrayImage;

constexpr const char* kLeft = "left_";
constexpr const char* kRight = "right_";
constexpr const char* kSuffix = ".png";
constexpr std::size_t kMostKeptBytes = 128'000'000;

// Throws std::runtime_error if a picture of this size does not fit the board. `board`: null if unknown.
void check_size(const std::string& path, int width, int height, const platform::BoardConfig* board) {
  if (board == nullptr || (width == board->image.width && height == board->image.height)) return;
  throw std::runtime_error(fmt::format("'{}': {}x{} pixels: must be as large as the board's images, {}x{}",
                                       path, width, height, board->image.width, board->image.height));
}

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

void check_video_size(const std::string& file, int video_width, int video_height,
                      const PictureSource::Video& options, const platform::BoardConfig& board) {
  if (options.layout == VideoLayout::kTwo) return check_size(file, video_width, video_height, &board);
  const int width = board.image.width * (options.layout == VideoLayout::kSideBySide ? 2 : 1);
  const int height = board.image.height * (options.layout == VideoLayout::kTopBottom ? 2 : 1);
  if (video_width == width && video_height == height) return;
  throw std::runtime_error(
      fmt::format("'{}': {}x{} pixels: must be as large as two of the board's images, {}x{}, with "
                  "--video-layout {}: {}x{}",
                  file, video_width, video_height, board.image.width, board.image.height,
                  options.layout_name(), width, height));
}

// The part of `image` that has this size and its top left pixel at (column, row).
GrayImage part_of(const GrayImage& image, int column, int row, int width, int height) {
  GrayImage part(width, height);
  for (int y = 0; y < height; ++y) {
    std::copy_n(&image.pixels[static_cast<std::size_t>(row + y) * static_cast<std::size_t>(image.width) +
                              static_cast<std::size_t>(column)],
                width, &part.at(0, y));
  }
  return part;
}

// The pairs of `--sequence DIR`: left_*.png and right_*.png with the same `*`, sorted by the bytes of their
// names. Other files in the folder are ignored. The first pictures are kept in memory, up to 128 MB. The
// others are decoded again at each use.
class SequencePairs : public PairSource {
 public:
  // Reads every picture once, and adds them to `opened` and `described`. Throws std::runtime_error, without
  // the name of the option, if the folder cannot be read, holds no pair or a picture without partner, or
  // holds a picture that cannot be read or does not fit the board.
  SequencePairs(const std::string& folder, const platform::BoardConfig* board, OpenedSource& opened,
                RecordedOptions& described)
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
    std::size_t converted = 0;
    input_.path = fs::absolute(folder).string();
    for (const std::string& stem : left) {
      for (const char* beginning : {kLeft, kRight}) {
        const std::string name = beginning + stem + kSuffix;
        const std::string path = (fs::path(folder) / name).string();
        media::LoadedGray picture = media::load_gray(path);
        check_size(path, picture.image.width, picture.image.height, board);
        converted += picture.converted_from_colour ? 1U : 0U;
        input_.files.push_back({name, files::sha256_file(path)});
        opened.files.push_back({"--sequence", path});
        kept_bytes += picture.image.pixels.size();
        if (kept_bytes <= kMostKeptBytes) kept_.push_back(std::move(picture.image));
      }
    }
    if (converted > 0) {
      opened.notes.push_back(fmt::format("--sequence '{}': {} of {} pictures: colour, converted to grey",
                                         folder, converted, input_.files.size()));
    }
    described.sequence = input_;
    set_length(left.size());
  }

 private:
  host::StereoPair load(std::uint64_t index) override {
    const auto left = static_cast<std::size_t>(2 * index);
    return {load_picture(left), load_picture(left + 1)};
  }
  GrayImage load_picture(std::size_t number) const {
    const InputFile& file = input_.files[number];
    const std::string path = (fs::path(input_.path) / file.path).string();
    if (files::sha256_file(path) != file.sha256) {
      throw std::runtime_error(fmt::format("'{}': changed: a picture must not change during a run", path));
    }
    return number < kept_.size() ? kept_[number] : media::load_gray(path).image;
  }

  InputFolder input_;            // its files are left and right in turn
  std::vector<GrayImage> kept_;  // pictures of the first files
};

// The pairs of `--video F [F2] --video-layout L`.
class VideoPairs : public PairSource {
 public:
  // Decodes each video once. Adds a note to `opened` for a video with fewer frames than its header states.
  // Throws std::runtime_error, without the name of the option, if a video cannot be decoded, if its frames
  // have another size than the layout needs, or if two videos differ in their number of frames. `board`: null
  // if unknown; no pair may then be requested.
  VideoPairs(const PictureSource::Video& options, const platform::BoardConfig* board, OpenedSource& opened)
      : PairSource("--video", 0), layout_(options.layout) {
    for (const std::string& file : options.files) {
      const auto check = [&](int width, int height) {
        if (board != nullptr) check_video_size(file, width, height, options, *board);
      };
      videos_.push_back(media::open_video(file, check));
      const media::Video& video = *videos_.back();
      if (video.frames() < video.stated_frames()) {
        opened.notes.push_back(fmt::format("--video '{}': {} frames can be decoded; its header says {}", file,
                                           video.frames(), video.stated_frames()));
      }
    }
    const media::Video& first = *videos_.front();
    const media::Video& last = *videos_.back();
    if (first.frames() != last.frames()) {
      throw std::runtime_error(fmt::format("'{}': {} frames: must have as many as '{}', {}",
                                           options.files.back(), last.frames(), options.files.front(),
                                           first.frames()));
    }
    set_length(first.frames());
  }

 private:
  host::StereoPair load(std::uint64_t index) override {
    const GrayImage& first = videos_.front()->frame(index);
    switch (layout_) {
      case VideoLayout::kSideBySide: {
        const int width = first.width / 2;
        return {part_of(first, 0, 0, width, first.height), part_of(first, width, 0, width, first.height)};
      }
      case VideoLayout::kTopBottom: {
        const int height = first.height / 2;
        return {part_of(first, 0, 0, first.width, height), part_of(first, 0, height, first.width, height)};
      }
      case VideoLayout::kTwo:
        break;
    }
    return {first, videos_.back()->frame(index)};
  }

  std::vector<std::unique_ptr<media::Video>> videos_;
  VideoLayout layout_;
};

// A source that shows one pair in every frame.
class SinglePair : public PairSource {
 public:
  explicit SinglePair(host::StereoPair pair) : PairSource("--left", 1), pair_(std::move(pair)) {}

 private:
  host::StereoPair load(std::uint64_t /*index*/) override { return std::move(pair_); }

  host::StereoPair pair_;  // moved to the held pairs at its first use
};

class SyntheticPairs : public PairSource {
 public:
  SyntheticPairs(std::uint64_t seed, const platform::BoardConfig& board)
      : PairSource("--synthetic", kEndless),
        scene_(seed, board.image.width, board.image.height, board.matcher.disparities) {}

  std::optional<media::Truth> truth(std::uint64_t frame) const override {
    return media::Truth{scene_.frame(frame % length()).disparity, 1};
  }

 private:
  host::StereoPair load(std::uint64_t index) override {
    media::SyntheticScene::Frame frame = scene_.frame(index);
    return {std::move(frame.left), std::move(frame.right)};
  }

  media::SyntheticScene scene_;
};

InputFile described_file(const std::string& path) {
  return {fs::absolute(path).string(), files::sha256_file(path)};
}

}  // namespace

const host::StereoPair& PairSource::pair(std::uint64_t frame) {
  const std::uint64_t index = frame % length_;
  const auto found =
      std::find_if(held_.begin(), held_.end(), [&](const Held& held) { return held.index == index; });
  if (found != held_.end()) {
    held_.splice(held_.begin(), held_, found);
    return held_.front().pair;
  }
  try {
    // Loads on a separate thread: the caller may be a SystemC process, whose stack is too small for decoders.
    held_.push_front({index, std::async(std::launch::async, [&] { return load(index); }).get()});
  } catch (const std::exception& error) {
    throw std::runtime_error(option_ + ' ' + error.what());
  }
  if (held_.size() > kHeld) held_.pop_back();
  return held_.front().pair;
}

OpenedSource open_source(const PictureSource& options, const platform::BoardConfig* board,
                         RecordedOptions& described, process::Problems& problems) {
  OpenedSource opened;
  const auto load_side = [&](const NamedFile& file, GrayImage& image, std::optional<InputFile>& input) {
    opened.files.push_back(file);
    problems.attempt(file.option + ' ', [&] {
      media::LoadedGray loaded = media::load_gray(file.path);
      if (loaded.converted_from_colour) opened.notes.push_back(file.text() + ": colour, converted to grey");
      check_size(file.path, loaded.image.width, loaded.image.height, board);
      image = std::move(loaded.image);
      input = described_file(file.path);
    });
  };
  if (options.pair) {
    host::StereoPair pictures;
    load_side({"--left", options.pair->left}, pictures.left, described.left);
    load_side({"--right", options.pair->right}, pictures.right, described.right);
    if (described.left && described.right) opened.pairs = std::make_unique<SinglePair>(std::move(pictures));
  }
  if (options.sequence) {
    problems.attempt("--sequence ", [&] {
      opened.pairs = std::make_unique<SequencePairs>(*options.sequence, board, opened, described);
    });
  }
  if (options.video) {
    for (const std::string& file : options.video->files) opened.files.push_back({"--video", file});
    problems.attempt("--video ", [&] {
      auto pairs = std::make_unique<VideoPairs>(*options.video, board, opened);
      for (const std::string& file : options.video->files) described.video.push_back(described_file(file));
      described.video_layout = options.video->layout_name();
      opened.pairs = std::move(pairs);
    });
  }
  if (options.synthetic) {
    described.synthetic = options.synthetic;
    if (board != nullptr) opened.pairs = std::make_unique<SyntheticPairs>(*options.synthetic, *board);
  }
  return opened;
}

std::optional<media::Truth> open_truth(const NamedFile& file, double scale,
                                       const platform::BoardConfig* board, process::Problems& problems) {
  std::optional<media::Truth> loaded;
  problems.attempt(file.option + ' ', [&] {
    const media::Truth truth = media::load_truth(file.path, scale);
    check_size(file.path, truth.grey.width, truth.grey.height, board);
    loaded = truth;
  });
  return loaded;
}

}  // namespace stereotlm::runs
