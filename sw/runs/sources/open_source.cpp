#include "sw/runs/sources/open_source.h"

#include <fmt/format.h>

#include <climits>
#include <filesystem>
#include <future>
#include <iterator>
#include <stdexcept>
#include <system_error>

#include "sw/files/text_forms.h"
#include "sw/media/synthetic_scene.h"
#include "sw/process/client.h"
#include "sw/runs/sources/pair_files.h"

namespace stereotlm::runs {
namespace {

namespace fs = std::filesystem;
using kernels::GrayImage;

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

// The size of one of the two pictures in a frame of a video.
media::Size picture_size(const media::Size& frame, const std::string& layout) {
  return {frame.width / (layout == "side_by_side" ? 2 : 1), frame.height / (layout == "top_bottom" ? 2 : 1)};
}

void check_video_size(const std::string& file, const media::Size& frame, const std::string& layout,
                      const media::Fit& fit) {
  const media::Size size = picture_size(frame, layout);
  const int columns = layout == "side_by_side" ? 2 : 1;
  const int rows = layout == "top_bottom" ? 2 : 1;
  const bool is_split = frame == media::Size{columns * size.width, rows * size.height};
  if (!fit.image || (is_split && size == *fit.image)) return;
  if (layout == "two" || (is_split && !fit.name.empty())) return fit.check(fmt::format("'{}'", file), size);
  throw std::runtime_error(fmt::format(
      "'{}': {}x{} pixels: must be as large as two of the board's images, {}x{}, with --video-layout {}: "
      "{}x{}{}",
      file, frame.width, frame.height, fit.image->width, fit.image->height, layout,
      columns * fit.image->width, rows * fit.image->height, is_split ? fit.cure(size) : ""));
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

InputFile described_file(const std::string& path) {
  return {fs::absolute(path).string(), files::sha256_file(path)};
}

// `left`: the left picture, as messages name it.
void check_same_size(const std::string& path, const media::Size& size, const std::string& left,
                     const media::Size& of_left) {
  if (size == of_left) return;
  throw std::runtime_error(fmt::format("'{}': {}x{} pixels: must be as large as {}, {}x{}", path, size.width,
                                       size.height, left, of_left.width, of_left.height));
}

// The following functions open a source. They throw std::runtime_error, without the name of the option.

// The pictures of one side.
struct Side {
  std::vector<InputFile> files;
  std::vector<GrayImage> kept;     // pictures of the first files
  std::vector<media::Size> sizes;  // of all pictures
  std::size_t converted = 0;       // pictures that were in colour
};

// Reads every file once. The first pictures are kept in memory, up to half of kMostKeptBytes. `left`: the
// other side, if it has been read.
Side read_side(const std::string& option, const std::vector<std::string>& paths, const Side& left,
               OpenedSource& opened) {
  Side side;
  std::size_t kept_bytes = 0;
  for (const std::string& path : paths) {
    const NamedFile& file = opened.files.emplace_back(NamedFile{option, path});
    media::LoadedGray picture = media::load_gray(path);
    const media::Size size = media::size_of(picture.image);
    opened.fit.check(fmt::format("'{}'", path), size);
    if (!opened.fit.name.empty() && side.sizes.size() < left.sizes.size())
      check_same_size(path, size, fmt::format("'{}'", left.files[side.sizes.size()].path),
                      left.sizes[side.sizes.size()]);
    side.sizes.push_back(size);
    side.converted += picture.converted_from_colour ? 1U : 0U;
    for (const std::string& note : picture.notes) opened.notes.push_back(file.text() + ": " + note);
    side.files.push_back(described_file(path));
    kept_bytes += picture.image.pixels.size();
    if (kept_bytes <= kMostKeptBytes / 2) side.kept.push_back(std::move(picture.image));
  }
  return side;
}

void note_converted(const std::string& named, std::size_t converted, std::size_t pictures,
                    OpenedSource& opened) {
  const std::string count = pictures == 1 ? "" : fmt::format("{} of {} pictures: ", converted, pictures);
  if (converted > 0) opened.notes.push_back(fmt::format("{}: {}colour, converted to grey", named, count));
}

// Pictures that are not kept are decoded again at each use. One pair is read only once.
void set_pairs(const std::string& option, Side left, Side right, OpenedSource& opened) {
  const std::size_t length = left.files.size();
  opened.sizes = left.sizes;
  const auto picture = [](const Side& side, std::size_t number) {
    if (side.files.size() == 1) return side.kept.front();
    const auto& [path, sha256] = side.files[number];
    if (files::sha256_file(path) != sha256)
      throw std::runtime_error(fmt::format("'{}': changed: a picture must not change during a run", path));
    return number < side.kept.size() ? side.kept[number] : media::load_gray(path).image;
  };
  opened.pairs = std::make_unique<PairSource>(
      option, length,
      [picture, fit = opened.fit, left = std::move(left), right = std::move(right)](std::uint64_t index) {
        const auto number = static_cast<std::size_t>(index);
        return host::StereoPair{fit.fitted(picture(left, number)), fit.fitted(picture(right, number))};
      });
}

// The pairs of `--sequence DIR`: left_*.png and right_*.png with the same `*`, sorted by the bytes of their
// names. Other files in the folder are ignored.
void open_sequence(InputFolder& sequence, OpenedSource& opened) {
  const std::string folder = sequence.path;
  const std::vector<std::string> names = names_in(folder);
  const std::vector<std::string> left = stems(names, kLeft);
  const std::vector<std::string> right = stems(names, kRight);
  check_partners(folder, kLeft, left, kRight, right);
  check_partners(folder, kRight, right, kLeft, left);
  if (left.empty()) {
    throw std::runtime_error(
        fmt::format("'{}': no pictures: a sequence must have pairs left_*.png and right_*.png", folder));
  }
  const auto read = [&](const char* beginning, const Side& other) {
    std::vector<std::string> paths;
    for (const std::string& stem : left)
      paths.push_back((fs::path(folder) / (beginning + stem + kSuffix)).string());
    return read_side("--sequence", paths, other, opened);
  };
  Side lefts = read(kLeft, {});
  Side rights = read(kRight, lefts);
  sequence = {fs::absolute(folder).string(), {}};
  for (std::size_t i = 0; i < left.size(); ++i) {
    for (const Side* side : {&lefts, &rights})
      sequence.files.push_back({fs::path(side->files[i].path).filename(), side->files[i].sha256});
  }
  note_converted(fmt::format("--sequence '{}'", folder), lefts.converted + rights.converted,
                 sequence.files.size(), opened);
  set_pairs("--sequence", std::move(lefts), std::move(rights), opened);
}

// The pairs of --left and --right.
void open_pairs(InputPictures& pictures, OpenedSource& opened, process::Problems& problems) {
  const auto paths_of = [](const std::vector<InputFile>& files) {
    std::vector<std::string> paths;
    for (const InputFile& file : files) paths.push_back(file.path);
    return paths;
  };
  const PairFiles found = find_pairs(paths_of(pictures.left), paths_of(pictures.right), problems);
  opened.notes = found.notes;
  const auto read = [&](const std::string& option, const std::vector<std::string>& paths, const Side& other,
                        std::vector<InputFile>& side) {
    Side result;
    const std::string named = NamedFile{option, side.front().path}.text();
    const bool is_read =
        problems.attempt(option + ' ', [&] { result = read_side(option, paths, other, opened); });
    if (is_read) side = result.files;
    note_converted(named, result.converted, paths.size(), opened);
    return result;
  };
  Side left = read("--left", found.left, {}, pictures.left);
  Side right = read("--right", found.right, left, pictures.right);
  if (!left.files.empty() && left.files.size() == right.files.size())
    set_pairs("--left, --right", std::move(left), std::move(right), opened);
}

// The pairs of `--video F [F2] --video-layout L`. Decodes each video once. Adds a note to `opened` for a
// video with fewer frames than its header states. Without a board, pairs have the size of the videos.
void open_videos(const InputPictures& pictures, OpenedSource& opened) {
  const std::string& layout = pictures.video_layout;
  std::vector<std::shared_ptr<media::Video>> videos;
  for (const InputFile& input : pictures.video) {
    const std::string& file = input.path;
    media::Size size;
    videos.push_back(media::open_video(file, [&](int width, int height) {
      size = {width, height};
      check_video_size(file, size, layout, opened.fit);
    }));
    if (!opened.sizes.empty() && !opened.fit.name.empty())
      check_same_size(file, size, fmt::format("'{}'", pictures.video.front().path), opened.sizes.front());
    opened.sizes = {picture_size(size, layout)};
    const media::Video& video = *videos.back();
    if (video.frames() < video.stated_frames()) {
      opened.notes.push_back(fmt::format("--video '{}': {} frames can be decoded; its header says {}", file,
                                         video.frames(), video.stated_frames()));
    }
  }
  const std::uint64_t frames = videos.front()->frames();
  if (frames != videos.back()->frames()) {
    throw std::runtime_error(fmt::format("'{}': {} frames: must have as many as '{}', {}",
                                         pictures.video.back().path, videos.back()->frames(),
                                         pictures.video.front().path, frames));
  }
  const auto load = [videos, layout, size = opened.sizes.front(), fit = opened.fit](std::uint64_t index) {
    const GrayImage& first = videos.front()->frame(index);
    const auto part = [&](int column, int row) {
      return fit.fitted(part_of(first, column, row, size.width, size.height));
    };
    if (layout == "two") return host::StereoPair{part(0, 0), fit.fitted(videos.back()->frame(index))};
    const bool is_beside = layout == "side_by_side";
    return host::StereoPair{part(0, 0), part(is_beside ? size.width : 0, is_beside ? 0 : size.height)};
  };
  opened.pairs = std::make_unique<PairSource>("--video", frames, load);
}

std::unique_ptr<PairSource> open_synthetic(std::uint64_t seed, const platform::BoardConfig& board) {
  const media::SyntheticScene scene(seed, board.image.width, board.image.height, board.matcher.disparities);
  return std::make_unique<PairSource>(
      "--synthetic", PairSource::kEndless,
      [scene](std::uint64_t index) {
        media::SyntheticScene::Frame frame = scene.frame(index);
        return host::StereoPair{std::move(frame.left), std::move(frame.right)};
      },
      [scene](std::uint64_t index) {
        return media::Truth{scene.frame(index).disparity, 1};
      });
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
    held_.push_front({index, std::async(std::launch::async, [&] { return load_(index); }).get()});
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(option_ + ' ' + error.what());
  }
  if (held_.size() > kHeld) held_.pop_back();
  return held_.front().pair;
}

std::unique_ptr<PairSource> blank_pairs(const platform::BoardConfig& board) {
  return std::make_unique<PairSource>("", 1, [size = board.image](std::uint64_t /*index*/) {
    return host::StereoPair{{size.width, size.height}, {size.width, size.height}};
  });
}

void open_arrays(OpenedSource& opened) {
  const process::Array* const left = process::client->given("left");
  const process::Array* const right = process::client->given("right");
  if (left == nullptr || right == nullptr)
    throw std::runtime_error("arrays left and right: must both be there");
  const auto shape_text = [](const process::Array& array) {
    return fmt::format("({})", fmt::join(array.shape, ", "));
  };
  if (left->shape != right->shape) {
    throw std::runtime_error(fmt::format("arrays left and right: shapes {} and {}: must be equal",
                                         shape_text(*left), shape_text(*right)));
  }
  std::vector<std::uint64_t> shape = left->shape;
  if (shape.size() != 3) shape.insert(shape.begin(), 1);
  const media::Fit& fit = opened.fit;
  const bool is_pairs = shape.size() == 3 && shape.front() > 0 && std::max(shape[1], shape[2]) <= INT_MAX;
  const media::Size size =
      is_pairs ? media::Size{static_cast<int>(shape[2]), static_cast<int>(shape[1])} : media::Size{};
  if (!is_pairs || (fit.name.empty() && !(size == *fit.image))) {
    throw std::runtime_error(fmt::format(
        "arrays left and right: shape {}: must be ({}, {}) or (pairs, {}, {}), as the board's images{}",
        shape_text(*left), fit.image->height, fit.image->width, fit.image->height, fit.image->width,
        is_pairs ? fit.cure(size) : ""));
  }
  fit.check("arrays left and right", size);
  const auto picture = [size, fit](const process::Array& array, std::uint64_t index) {
    GrayImage image(size.width, size.height);
    std::copy_n(array.bytes.begin() + static_cast<std::ptrdiff_t>(index * image.pixels.size()),
                image.pixels.size(), image.pixels.begin());
    return fit.fitted(image);
  };
  opened.sizes = {size};
  opened.pairs = std::make_unique<PairSource>("arrays", shape.front(), [=](std::uint64_t index) {
    return host::StereoPair{picture(*left, index), picture(*right, index)};
  });
}

OpenedSource open_source(InputPictures& pictures, const platform::BoardConfig* board,
                         process::Problems& problems, bool has_calibration) {
  OpenedSource opened;
  opened.fit = {pictures.fit, std::nullopt, has_calibration};
  if (board != nullptr) opened.fit.image = {board->image.width, board->image.height};
  if (!pictures.left.empty() && !pictures.right.empty()) open_pairs(pictures, opened, problems);
  if (pictures.sequence) problems.attempt("--sequence ", [&] { open_sequence(*pictures.sequence, opened); });
  if (!pictures.video.empty()) {
    for (const InputFile& file : pictures.video) opened.files.push_back({"--video", file.path});
    problems.attempt("--video ", [&] {
      open_videos(pictures, opened);
      for (InputFile& file : pictures.video) file = described_file(file.path);
    });
  }
  if (pictures.synthetic && board != nullptr) opened.pairs = open_synthetic(*pictures.synthetic, *board);
  return opened;
}

std::optional<media::Truth> open_truth(const NamedFile& file, std::optional<double> scale,
                                       const OpenedSource& source, std::uint64_t frame,
                                       process::Problems& problems, const std::string* content) {
  std::optional<media::Truth> loaded;
  problems.attempt(file.option + ' ', [&] {
    const media::Truth truth = media::load_truth(file.path, scale, content);
    const media::Size size = {truth.width, truth.height};
    if (!source.fit.name.empty() && !source.sizes.empty())
      check_same_size(file.path, size, "the left picture", source.sizes[frame % source.sizes.size()]);
    source.fit.check(fmt::format("'{}'", file.path), size);
    loaded = media::with_offset(source.fit.fitted(truth), source.truth_offset);
  });
  return loaded;
}

}  // namespace stereotlm::runs
