#include <algorithm>
#include <array>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "sw/cli/command.h"
#include "sw/files/aside.h"
#include "sw/files/output_folder.h"
#include "sw/files/whole_file.h"
#include "sw/process/command.h"

namespace stereotlm::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNames =
    "@(window|disparities|rows|units|banks|states|stalls|use|pareto).@(png|svg|pdf|csv)";
// The endings of pictures, and what the scripts write into each picture (METADATA in style.py).
const std::array<std::pair<const char*, std::string>, 3> kMade = {
    {{".png", std::string("\0\0\0\x12tEXtSoftware\0stereotlm", 26)},
     {".svg", "\n    <dc:creator>\n     <cc:Agent>\n      <dc:title>stereotlm</dc:title>\n"},
     {".pdf", "\n<< /Creator (stereotlm) >>\nendobj\nxref\n"}}};
constexpr const char* kRule =
    "must be empty or hold only files that plot has written: move it away, or give another folder";
constexpr const char* kPlotFooter =
    "Each figure that applies to the database is drawn, as NAME.png and NAME.svg or in the formats of\n"
    "--format, with its data in NAME.csv:\n"
    "  window       frames per second against matcher.window\n"
    "  disparities  frames per second, and area, against matcher.disparities\n"
    "  rows         the same against matcher.rows\n"
    "  units        the same against the number of modules, matcher.units\n"
    "  banks        frames per second against the banks that the allocation uses\n"
    "  states       what each port does in the cycles of a frame\n"
    "  stalls       cycles in which each port waits, by their cause\n"
    "  use          how busy each bank is\n"
    "  pareto       two columns of the database, and the points that no other point dominates;\n"
    "               beside the columns there are banks_used and units_used\n"
    "Points that differ in keys besides the x axis are on separate lines; more than can be distinguished\n"
    "are drawn as envelopes. Of more than 16 points, states, stalls and use show some; the figure says\n"
    "which. DIR must be empty or hold only such files, which are replaced.\n"
    "The scripts that draw, one for each figure, lie in share/stereotlm/plots where the program is\n"
    "installed, in sw/report/plots of its source: python3 plot_window.py DB --out NEW_DIR.";

// The options of `plot`. They are passed to the script, which checks them.
struct PlotOptions : Options {
  using Options::Options;

  Option database = Option(this, "DB", " ", "A database of sweep");
  Option out = Option(this, "--out", "DIR", "The folder to write, created if missing");
  Option only = Option(this, "--only", "KEY=VALUE", "Only points with that value; once for each key", {},
                       Takes::kRepeated);
  Option pareto = Option(this, "--pareto", "X:SENSE,Y:SENSE",
                         "Two columns, each with min or max: what is better; default "
                         "area.slices:min,frames_per_second.core:max");
  Option format = Option(this, "--format", "F,..", "png, svg, pdf, or several with commas; default png,svg");
  Option size =
      Option(this, "--size", "WxH",
             "Width and height of each figure in inches, such as 7.2x4.5; default: 7.2 wide, and as high as "
             "its content");

  // The arguments of the script, in a form in which it does not take a value such as "--x" for an option. The
  // script writes the figures into the folder `into`. `problem`: why --out cannot be used; empty if it can.
  std::vector<std::string> arguments(const fs::path& into, const std::string& problem) const {
    std::vector<std::string> words = {"--out=" + out.text(), "--into=" + into.string(),
                                      "--problem=" + problem};
    for (const std::string& each : only.texts()) words.push_back("--only=" + each);
    for (const Option* option : {&pareto, &format, &size}) {
      if (option->is_given()) words.push_back(option->name() + "=" + option->text());
    }
    if (database.is_given()) words.insert(words.end(), {"--", database.text()});
    return words;
  }
};

// Whether a script has written the file of kNames, or it is empty. A table is known by a picture beside it.
bool is_made(const fs::path& file) {
  if (!files::is_file(file)) return false;
  if (fs::file_size(file) == 0) return true;
  return std::any_of(kMade.begin(), kMade.end(), [&file](const auto& kind) {
    const auto& [ending, made] = kind;
    if (file.extension() == ".csv") return is_made(fs::path(file).replace_extension(ending));
    return file.extension() == ending && files::read_whole_file(file).find(made) != std::string::npos;
  });
}

int plot(const PlotOptions& options) {
  process::catch_interrupts();
  process::Problems problems;
  check_temporary_folder(problems);
  problems.check();
  const files::TemporaryFolder drawings;
  std::unique_ptr<files::OutputFolder> folder;
  std::string problem = "--out: missing: the folder of the figures";
  if (options.out.is_given()) {
    try {
      files::OutputContent content{"--out", "", {"figure of plot", is_made}, kRule, {kNames}};
      content.inputs = {{"DB", options.database.text()}};
      folder = std::make_unique<files::OutputFolder>(options.out.text(), std::move(content));
      problem.clear();
    } catch (const std::runtime_error& error) {
      problem = error.what();
    }
  }
  process::CommandEnd end;
  try {
    end = draw("plot_all.py", options.arguments(drawings.path(), problem));
  } catch (const std::runtime_error& error) {
    process::refuse(error.what());
  }
  if (process::interrupted()) return interrupted("nothing was written");
  std::istringstream lines(end.errors);
  for (std::string line; std::getline(lines, line);) process::say_line(line);
  if (end.status != 0) return end.status;
  for (const fs::path& name : files::entries(drawings.path()))
    folder->add(name, files::read_whole_file(drawings.path() / name));
  folder->commit();
  process::print(end.out);
  return kDone;
}

}  // namespace

void add_plot(Commands& commands) {
  add_command(commands, "plot", "Draw the figures of a sweep", plot, kPlotFooter);
}

}  // namespace stereotlm::cli
