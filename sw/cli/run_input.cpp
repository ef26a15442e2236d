#include "sw/cli/run_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <system_error>

#include "platform/board_yaml.h"
#include "sw/cli/media_library.h"
#include "sw/cli/streams.h"
#include "sw/cli/version.h"
#include "sw/report/run_json.h"
#include "sw/report/sha256.h"

namespace stereotlm::cli {
namespace {

namespace fs = std::filesystem;
using kernels::GrayImage;

// A picture as the command line names it.
struct NamedPicture {
  const char* option;
  std::string path;

  std::string text() const { return fmt::format("{} '{}'", option, path); }
};

// Whether the file lies in the folder or below it, whatever links and dots the two paths have. What does not
// exist lies nowhere.
bool lies_in(const std::string& file, const std::string& folder) {
  std::error_code no_file;
  std::error_code no_folder;
  const fs::path inner = fs::canonical(file, no_file);
  const fs::path outer = fs::canonical(folder, no_folder);
  if (no_file || no_folder || inner == outer) return false;
  return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

class InputLoader {
 public:
  explicit InputLoader(const RunOptions& options) : options_(options) {}

  RunInput load() {
    const auto board = options_.board.load(problems_);
    attempt(nullptr, [&] { load_pictures(board ? &*board : nullptr); });
    if (options_.out && pictures_survive()) {
      attempt(nullptr, [&] { input_.folder = std::make_unique<report::ResultFolder>(*options_.out); });
    }
    problems_.check();
    input_.board = *board;
    attempt(nullptr, [&] {
      input_.tables = platform::identity_tables(input_.board);
      input_.config_yaml = platform::to_yaml(input_.board);
    });
    describe();
    problems_.check();
    for (const std::string& picture : converted_) say("note", picture + ": colour, converted to grey");
    return std::move(input_);
  }

 private:
  // `option`: the one that an error of this step comes from, or null.
  void attempt(const char* option, const std::function<void()>& step) {
    try {
      step();
    } catch (const std::exception& error) {
      problems_.add((option != nullptr ? std::string(option) + ' ' : "") + error.what());
    }
  }

  NamedPicture left() const { return {"--left", options_.left}; }
  NamedPicture right() const { return {"--right", options_.right}; }
  NamedPicture truth() const { return {"--truth", *options_.truth}; }

  // The sizes that do not fit are reported of the pictures that could be read.
  void load_pictures(const platform::BoardConfig* board) {
    const MediaFunctions& media = media_functions();
    const auto load_side = [&](const NamedPicture& picture, GrayImage& image) {
      attempt(picture.option, [&] {
        media::LoadedGray loaded = media.load_gray(picture.path);
        if (loaded.converted_from_colour) converted_.push_back(picture.text());
        check_size(picture, loaded.image, board);
        image = std::move(loaded.image);
      });
    };
    load_side(left(), input_.pair.left);
    load_side(right(), input_.pair.right);
    if (!options_.truth) return;
    attempt(truth().option, [&] {
      media::Truth loaded = media.load_truth(*options_.truth, options_.truth_scale);
      check_size(truth(), loaded.grey, board);
      input_.truth = std::move(loaded);
    });
  }

  void check_size(const NamedPicture& picture, const GrayImage& image, const platform::BoardConfig* board) {
    if (board == nullptr || (image.width == board->image.width && image.height == board->image.height))
      return;
    problems_.add(fmt::format("{}: {}x{} pixels: must be as large as the board's images, {}x{}",
                              picture.text(), image.width, image.height, board->image.width,
                              board->image.height));
  }

  // False, and reported, if one lies in the result folder, which is replaced whole.
  bool pictures_survive() {
    bool survive = true;
    std::vector<NamedPicture> pictures = {left(), right()};
    if (options_.truth) pictures.push_back(truth());
    for (const NamedPicture& picture : pictures) {
      if (!lies_in(picture.path, *options_.out)) continue;
      problems_.add(
          fmt::format("{}: inside the result folder '{}', which is replaced whole: "
                      "a picture must lie outside the folder of --out",
                      picture.text(), *options_.out));
      survive = false;
    }
    return survive;
  }

  void describe() {
    report::RunOptions& run = input_.described;
    run.program_version = kVersion;
    run.source = "preloaded";
    run.fidelity = "cycle";
    run.frames = options_.frames;
    run.truth_scale = options_.truth_scale;
    const auto name = [this](const NamedPicture& picture, std::optional<report::InputFile>& file) {
      attempt(picture.option, [&] {
        file = {fs::absolute(picture.path).string(), report::sha256_file(picture.path)};
      });
    };
    name(left(), run.left);
    name(right(), run.right);
    if (options_.truth) name(truth(), run.truth);
    problems_.check();
    attempt(nullptr, [&] { report::run_json(run); });  // refuses now what it would refuse after the run
  }

  const RunOptions& options_;
  Problems problems_;
  std::vector<std::string> converted_;
  RunInput input_;
};

}  // namespace

RunInput load_run_input(const RunOptions& options) { return InputLoader(options).load(); }

}  // namespace stereotlm::cli
