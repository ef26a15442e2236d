#include <fmt/format.h>

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

constexpr const char* kNames = "@(window|disparities|rows|units|banks|stalls|pareto).@(png|svg|pdf|csv)";
// The endings of pictures, and what the script writes into each picture (METADATA in figures.py).
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
    "  stalls       cycles in which each port waits, by their cause\n"
    "  pareto       two or three columns of the database (the third as colour), and the points that no\n"
    "               other point dominates; beside the columns there are banks_used and units_used\n"
    "Points that differ in keys besides the x axis are on separate lines; more than can be distinguished\n"
    "are drawn as an envelope. Of more than 16 points, stalls shows those that wait most. DIR must be\n"
    "empty or hold only such files, which are replaced. The script that draws is plots/figures.py in\n"
    "share/stereotlm where the program is installed, in sw/report of its source: copy and change it.";

// The options of `plot`. They are passed to the script, which checks them.
struct PlotOptions : Options {
  using Options::Options;

  Option database = Option(this, "DB", " ", "A database of sweep", {required("a database of sweep")});
  Option out = Option(this, "--out", "DIR", "The folder to write, created if missing",
                      {required("the folder of the figures")});
  Option only = Option(this, "--only", "KEY=VALUE", "Only points with that value; once for each key", {},
                       Takes::kRepeated);
  Option pareto = Option(this, "--pareto", "X:SENSE,Y:SENSE,..",
                         "Two or three columns, each with min or max: what is better; default "
                         "area.slices:min,frames_per_second.core:max");
  Option format = Option(this, "--format", "F,..", "png, svg, pdf, or several with commas; default png,svg");
  Option size =
      Option(this, "--size", "WxH",
             "Width and height of each figure in inches, such as 7.2x4.5; default: 7.2 wide, and as high as "
             "its content");

  // The arguments of the script, in a form in which it does not take a value such as "--x" for an option. The
  // script writes the figures into the folder `into`.
  std::vector<std::string> arguments(const fs::path& into) const {
    std::vector<std::string> words = {"--out=" + into.string()};
    for (const std::string& each : only.texts()) words.push_back("--only=" + each);
    for (const Option* option : {&pareto, &format, &size}) {
      if (option->is_given()) words.push_back(option->name() + "=" + option->text());
    }
    words.insert(words.end(), {"--", database.text()});
    return words;
  }
};

// Whether the script has written the file of kNames, or it is empty. A table is known by a picture beside it.
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
  std::unique_ptr<files::OutputFolder> folder;
  problems.attempt("", [&] {
    files::OutputContent content{"--out", "", {"figure of plot", is_made}, kRule, {kNames}};
    content.inputs = {{"DB", options.database.text()}};
    folder = std::make_unique<files::OutputFolder>(options.out.text(), std::move(content));
  });
  problems.check();
  const files::TemporaryFolder drawings;
  process::CommandEnd end;
  process::attempt_or_refuse("", [&] { end = draw("figures.py", options.arguments(drawings.path())); });
  if (process::interrupted()) return interrupted("nothing was written");
  std::istringstream lines(end.errors);
  for (std::string line; std::getline(lines, line);) process::say_line(line);
  if (end.status != 0) return end.status;
  const std::vector<fs::path> names = files::entries(drawings.path());
  for (const fs::path& name : names) folder->add(name, files::read_whole_file(drawings.path() / name));
  folder->commit();
  process::print(fmt::format("{}{}: {} files\n", end.out, options.out.text(), names.size()));
  return kDone;
}

}  // namespace

void add_plot(Commands& commands) {
  add_command(commands, "plot", "Draw the figures of a sweep", plot, kPlotFooter);
}

}  // namespace stereotlm::cli
