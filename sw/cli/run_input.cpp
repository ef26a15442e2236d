#include "sw/cli/run_input.h"

#include <fmt/format.h>

#include <filesystem>
#include <functional>

#include "platform/board_yaml.h"
#include "sw/cli/media_library.h"
#include "sw/cli/streams.h"
#include "sw/cli/version.h"
#include "sw/report/run_json.h"
#include "sw/report/sha256.h"

namespace stereotlm::cli {
namespace {

using kernels::GrayImage;

class InputLoader {
 public:
  explicit InputLoader(const RunOptions& options) : options_(options) {}

  RunInput load() {
    const auto board = options_.board.load(problems_);
    attempt([&] { load_pictures(board ? &*board : nullptr); });
    if (options_.out) attempt([&] { input_.folder = std::make_unique<report::ResultFolder>(*options_.out); });
    problems_.check();
    input_.board = *board;
    attempt([&] {
      input_.tables = platform::identity_tables(input_.board);
      input_.config_yaml = platform::to_yaml(input_.board);
      input_.described = describe();
      report::run_json(input_.described);  // refuses now what it would refuse after the run
    });
    problems_.check();
    for (const std::string& path : converted_) say("note", "'" + path + "': colour, converted to grey");
    return std::move(input_);
  }

 private:
  void attempt(const std::function<void()>& step) {
    try {
      step();
    } catch (const std::exception& error) {
      problems_.add(error.what());
    }
  }

  // The sizes that do not fit are reported of the pictures that could be read.
  void load_pictures(const platform::BoardConfig* board) {
    const MediaFunctions& media = media_functions();
    const auto load_side = [&](const char* option, const std::string& path, GrayImage& image) {
      attempt([&] {
        media::LoadedGray loaded = media.load_gray(path);
        if (loaded.converted_from_colour) converted_.push_back(path);
        check_size(option, path, loaded.image, board);
        image = std::move(loaded.image);
      });
    };
    load_side("--left", options_.left, input_.pair.left);
    load_side("--right", options_.right, input_.pair.right);
    if (!options_.truth) return;
    attempt([&] {
      media::Truth truth = media.load_truth(*options_.truth, options_.truth_scale);
      check_size("--truth", *options_.truth, truth.grey, board);
      input_.truth = std::move(truth);
    });
  }

  void check_size(const char* option, const std::string& path, const GrayImage& image,
                  const platform::BoardConfig* board) {
    if (board == nullptr || (image.width == board->image.width && image.height == board->image.height))
      return;
    problems_.add(fmt::format("{} '{}': {}x{} pixels: must be as large as the board's images, {}x{}", option,
                              path, image.width, image.height, board->image.width, board->image.height));
  }

  static report::InputFile file(const std::string& path) {
    return {std::filesystem::absolute(path).string(), report::sha256_file(path)};
  }

  report::RunOptions describe() const {
    report::RunOptions run;
    run.program_version = kVersion;
    run.source = "preloaded";
    run.fidelity = "cycle";
    run.frames = options_.frames;
    run.left = file(options_.left);
    run.right = file(options_.right);
    if (options_.truth) run.truth = file(*options_.truth);
    run.truth_scale = options_.truth_scale;
    return run;
  }

  const RunOptions& options_;
  Problems problems_;
  std::vector<std::string> converted_;
  RunInput input_;
};

}  // namespace

RunInput load_run_input(const RunOptions& options) { return InputLoader(options).load(); }

}  // namespace stereotlm::cli
