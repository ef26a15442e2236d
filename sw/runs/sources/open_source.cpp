#include "sw/runs/sources/open_source.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "sw/files/sha256.h"
#include "sw/media/load.h"
#include "sw/media/synthetic_scene.h"
#include "sw/runs/sources/sequence_pairs.h"
#include "sw/runs/sources/video_pairs.h"

namespace stereotlm::runs {
namespace {

namespace fs = std::filesystem;
using kernels::GrayImage;

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

class SourceOpener {
 public:
  SourceOpener(const platform::BoardConfig* board, RecordedOptions& described, process::Problems& problems)
      : board_(board), described_(described), problems_(problems) {}

  void open_pair(const PictureSource::Pair& pair) {
    host::StereoPair pictures;
    described_.left = load_side({"--left", pair.left}, pictures.left);
    described_.right = load_side({"--right", pair.right}, pictures.right);
    if (described_.left && described_.right) {
      opened_.pairs = std::make_unique<SinglePair>(std::move(pictures));
    }
  }

  void open_sequence(const std::string& folder) {
    attempt("--sequence", [&] {
      auto pairs = std::make_unique<SequencePairs>(folder, board_);
      for (const InputFile& file : pairs->input().files) {
        opened_.files.push_back({"--sequence", (fs::path(folder) / file.path).string()});
      }
      if (pairs->pictures_converted() > 0) {
        opened_.notes.push_back(fmt::format("--sequence '{}': {} of {} pictures: colour, converted to grey",
                                            folder, pairs->pictures_converted(), 2 * pairs->length()));
      }
      described_.sequence = pairs->input();
      opened_.pairs = std::move(pairs);
    });
  }

  void open_video(const PictureSource::Video& options) {
    for (const std::string& file : options.files) opened_.files.push_back({"--video", file});
    attempt("--video", [&] {
      auto pairs = std::make_unique<VideoPairs>(options, board_);
      opened_.notes = pairs->notes();
      for (const std::string& file : options.files) described_.video.push_back(described(file));
      described_.video_layout = options.layout_name;
      opened_.pairs = std::move(pairs);
    });
  }

  void open_synthetic(std::uint64_t seed) {
    described_.synthetic = seed;
    if (board_ != nullptr) opened_.pairs = std::make_unique<SyntheticPairs>(seed, *board_);
  }

  OpenedSource opened() { return std::move(opened_); }

 private:
  template <typename Step>
  void attempt(const std::string& option, const Step& step) {
    try {
      step();
    } catch (const std::exception& error) {
      problems_.add(option + ' ' + error.what());
    }
  }

  static InputFile described(const std::string& path) {
    return {fs::absolute(path).string(), files::sha256_file(path)};
  }

  std::optional<InputFile> load_side(const NamedFile& file, GrayImage& image) {
    opened_.files.push_back(file);
    std::optional<InputFile> result;
    attempt(file.option, [&] {
      media::LoadedGray loaded = media::load_gray(file.path);
      if (loaded.converted_from_colour) opened_.notes.push_back(file.text() + ": colour, converted to grey");
      const auto problem = size_problem(loaded.image.width, loaded.image.height, board_);
      if (problem) problems_.add(file.text() + *problem);
      image = std::move(loaded.image);
      result = described(file.path);
    });
    return result;
  }

  const platform::BoardConfig* board_;
  RecordedOptions& described_;
  process::Problems& problems_;
  OpenedSource opened_;
};

}  // namespace

OpenedSource open_source(const PictureSource& options, const platform::BoardConfig* board,
                         RecordedOptions& described, process::Problems& problems) {
  SourceOpener opener(board, described, problems);
  if (options.pair) opener.open_pair(*options.pair);
  if (options.sequence) opener.open_sequence(*options.sequence);
  if (options.video) opener.open_video(*options.video);
  if (options.synthetic) opener.open_synthetic(*options.synthetic);
  return opener.opened();
}

std::optional<media::Truth> open_truth(const NamedFile& file, double scale,
                                       const platform::BoardConfig* board, process::Problems& problems) {
  try {
    media::Truth truth = media::load_truth(file.path, scale);
    const auto problem = size_problem(truth.grey.width, truth.grey.height, board);
    if (!problem) return truth;
    problems.add(file.text() + *problem);
  } catch (const std::exception& error) {
    problems.add(file.option + ' ' + error.what());
  }
  return std::nullopt;
}

}  // namespace stereotlm::runs
