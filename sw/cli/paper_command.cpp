#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>

#include "platform/bounds.h"
#include "sw/cli/add_command.h"
#include "sw/cli/commands.h"
#include "sw/cli/exit_status.h"
#include "sw/cli/temporary_files.h"
#include "sw/cli/typed_option.h"
#include "sw/files/document_folder.h"
#include "sw/files/whole_file.h"
#include "sw/paper/document.h"
#include "sw/paper/study.h"
#include "sw/process/installation.h"
#include "sw/process/interrupt.h"
#include "sw/process/problems.h"
#include "sw/process/python_script.h"
#include "sw/process/streams.h"
#include "sw/runs/progress.h"
#include "sw/runs/simulation/simulate_point.h"
#include "sw/runs/sources/calibration_input.h"

namespace stereotlm::cli {
namespace {

constexpr const char* kScript = "plot_paper.py";
constexpr const char* kPaperFooter =
    "Written are paper.md, every claim with paper value, model value, bound, rule, verdict and the commands\n"
    "that give the numbers again; claims.csv with a row for each case; table1.csv, table2.csv and "
    "banks.csv;\n"
    "and their figures table1, table2 and banks as .png and .svg. Other files in DIR stay; files of these\n"
    "names are replaced if paper.md is there. \"At least eight banks\" is settled with every allocation of "
    "the\n"
    "core alone; of the whole computer some allocations are run, see stereotlm allocate for all of them.";

struct PaperOptions {
  Typed out;

  void add_to(CLI::App& command) {
    out.add_to(command, "--out", "DIR", "The folder to write, created if missing");
  }

  void check_usage() const {
    if (!out.is_given()) process::refuse("--out: missing: the folder to write");
  }
};

// Simulates everything that the claims of the paper need. Returns nullopt if interrupted.
std::optional<paper::Findings> study() {
  runs::PointSimulator simulator;
  runs::ProgressLine progress;
  paper::Means means;
  means.evaluate = [&simulator](const explore::Point& point) { return simulator(point); };
  means.bound = [](const platform::BoardConfig& board, std::uint64_t frames) {
    return platform::core_bound(board, runs::tables_of(board, std::nullopt), frames);
  };
  means.version = process::kVersion;
  means.jobs = std::max(1U, std::thread::hardware_concurrency());
  means.keep_going = [&progress](std::uint64_t done, std::uint64_t most_left) {
    progress.show(
        [&](double) { return fmt::format("{} boards simulated, {} left at most", done, most_left); });
    return !process::interrupted();
  };
  return paper::study(paper::claims(), means);
}

// Draws figures from the tables in `files`, which has contents by name, and adds the figures to it. Returns
// false if interrupted. `folder`: for temporary files.
bool draw(const std::filesystem::path& folder, std::map<std::string, std::string>& files) {
  for (const auto& [name, bytes] : files) files::write_whole_file(folder / name, bytes);
  const auto end = process::run_script(kScript, {"--out=" + folder.string(), "--", folder.string()});
  if (process::interrupted()) return false;
  if (end.status != 0) {
    throw std::runtime_error(fmt::format("the figures cannot be drawn: {} has ended with {}: {}", kScript,
                                         end.status, end.errors));
  }
  for (const char* figure : paper::kFigures) {
    for (const char* ending : {".png", ".svg"}) {
      const std::string name = std::string(figure) + ending;
      files[name] = files::read_whole_file(folder / name);
    }
  }
  return true;
}

int compare_with_paper(const PaperOptions& options) {
  process::Problems problems;
  const auto drawings = temporary_folder(problems);
  std::unique_ptr<files::DocumentFolder> folder;
  try {
    folder = std::make_unique<files::DocumentFolder>(options.out.text, paper::kDocument, paper::file_names());
  } catch (const std::runtime_error& error) {
    problems.add(fmt::format("--out {}: {}", options.out.text, error.what()));
  }
  problems.check();
  process::catch_interrupts();
  const auto findings = study();
  auto files = findings ? paper::tables(*findings) : std::map<std::string, std::string>();
  if (!findings || !draw(drawings->path(), files)) {
    process::say("note", "interrupted: nothing was written");
    return kInterrupted;
  }
  files[paper::kDocument] = paper::document(*findings);
  folder->commit(files);
  process::print(paper::summary(*findings) + fmt::format("{}: {} files\n", options.out.text, files.size()));
  return kDone;
}

}  // namespace

void add_paper(CLI::App& program, Action& action) {
  add_command(program, action, "paper", "Compare the paper's figures with the model's", compare_with_paper,
              kPaperFooter);
}

}  // namespace stereotlm::cli
