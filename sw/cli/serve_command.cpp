#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "platform/config/board_yaml.h"
#include "sw/cli/command.h"
#include "sw/cli/key_schema.h"
#include "sw/cli/run_options.h"
#include "sw/process/client.h"
#include "sw/process/command.h"
#include "sw/report/html_page.h"
#include "sw/report/page_data/page_data.h"
#include "sw/runs/explanation.h"
#include "sw/runs/recorded_run.h"

namespace stereotlm::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kServeFooter =
    "The page shows the board, and what it reaches, as a report does. Each change of a key, and each buffer\n"
    "that is dragged into another bank, is simulated at once. BOARD may also be a folder of run --out, or a\n"
    "database of sweep, whose points can be opened. The server listens on 127.0.0.1 alone. Only who has the\n"
    "address that it prints gets an answer. It reads and writes no file outside the folder, but the input.\n"
    "Ctrl-C ends it. It needs Python with numpy, and the Python module stereotlm.";

// Of the computer, for each change: the first turn of lists of three, and two turns for the steady rate.
constexpr int kComputerFrames = 18;

struct ServeOptions : Options {
  using Options::Options;

  void check_together(process::Problems& problems) override {
    if ((is_run() || is_database()) && board.changes_board())
      problems.add(fmt::format("'{}': a {} has its boards: --set and --calibration do not go with it",
                               board.argument.text(), is_run() ? "run" : "database"));
  }

  // A preset comes before a folder or a file of its name.
  bool is_preset() const {
    const std::vector<std::string> presets = platform::preset_names();
    return std::find(presets.begin(), presets.end(), board.argument.text()) != presets.end();
  }
  bool is_run() const {
    std::error_code error;
    return !is_preset() && fs::is_directory(board.argument.text(), error);
  }
  bool is_database() const {
    std::error_code error;
    const fs::path path = board.argument.text();
    return !is_preset() && path.extension() != ".yaml" && fs::is_regular_file(path, error);
  }

  BoardOptions board{this, "", process::sent_files(),
                     Option(this, "BOARD", " ",
                            "A preset, the path of a board file, a folder of run --out, or a database of "
                            "sweep (default: fpl2003)")};
  Option folder =
      Option(this, "--folder", "DIR",
             "The folder of the board files and pictures that the page can open, and where it saves boards "
             "(default: the current one)",
             {valid("a folder", [](const std::string& text) { return fs::is_directory(text); })});
  Option port =
      Option(this, "--port", "N", "The port of the server, 1024..65535, or 0 for any free one (default: 0)",
             {number<int>("0, or an integer, 1024..65535",
                          [](int its) { return its == 0 || (its >= 1024 && its <= 65535); })});
  Option origin = Option(this, "--origin", "URL",
                         "Another origin under which browsers reach the page: that of a proxy, such as "
                         "https://hub.example.org");
  Option open = Option(this, "--open", "", "Open the page in the browser of this machine");
};

// What the page begins with.
Json data_of(const ServeOptions& options, process::Problems& problems) {
  Json data;
  std::optional<platform::BoardConfig> board;
  std::string calibration;
  const std::string& path = options.board.argument.text();
  if (options.is_database()) {
    problems.attempt("", [&] { data["database"] = report::database_data(path); });
    board = platform::load_board("fpl2003");
  } else if (options.is_run()) {
    if (const auto run = runs::read_recorded_run(
            "RUN", path, "BOARD must be a board, or a folder that run --out has written: ", problems)) {
      board = run->board;
      if (run->options.calibration) calibration = run->options.calibration->file.path;
    }
  } else {
    board = options.board.load(problems).board;
    calibration = options.board.calibration.text();
  }
  problems.check();
  if (!calibration.empty()) calibration = fs::absolute(calibration).string();
  const auto [preset, sets] = platform::sets_of_nearest_preset(*board);
  Json presets = Json::array();
  for (const platform::Preset& each : platform::presets()) presets.push_back(each.name);
  Json keys = Json::array();
  for (const platform::Key& key : platform::board_keys()) {
    keys.push_back(
        {{"key", key.path}, {"meaning", key.meaning}, {"unit", key.unit}, {"range", key.rule.text}});
  }
  data["live"] = {{"preset", preset},
                  {"sets", sets},
                  {"calibration", calibration},
                  {"presets", std::move(presets)},
                  {"keys", std::move(keys)},
                  {"schema", board_schema()["$defs"]},
                  {"core_frames", runs::Explanation::kCoreFrames},
                  {"computer_frames", kComputerFrames}};
  return data;
}

int serve(const ServeOptions& options) {
  if (process::client != nullptr) process::refuse("serve: cannot be a command for a worker");
  process::Problems problems;
  Json data = {{"format", 2}, {"version", process::kVersion}, {"kind", "live"}};
  data.update(data_of(options, problems));
  data["text"] = "The live board needs JavaScript.";
  std::vector<std::string> arguments = {"--folder", options.folder.is_given() ? options.folder.text() : ".",
                                        "--port", options.port.is_given() ? options.port.text() : "0"};
  if (options.origin.is_given()) arguments.push_back("--origin=" + options.origin.text());
  if (options.open.is_given()) arguments.emplace_back("--open");
  if (const std::string calibration = data["live"]["calibration"]; !calibration.empty())
    arguments.push_back("--calibration=" + calibration);
  process::attempt_or_refuse(
      "", [&] { process::become_python("stereotlm.serve", arguments, report::html_page(data)); });
  return kFailed;
}

}  // namespace

void add_serve(Commands& commands) {
  add_command(commands, "serve", "Show a board in the browser, and simulate every change of it at once",
              serve, kServeFooter);
}

}  // namespace stereotlm::cli
