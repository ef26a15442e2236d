#include <stdexcept>
#include <string>
#include <vector>

#include "sw/cli/command.h"
#include "sw/process/problems.h"
#include "sw/process/python_script.h"

namespace stereotlm::cli {
namespace {

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
    "installed, in sw/report/plots of its source: python3 plot_window.py DB --out DIR.";

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

  // The arguments of the script, in a form in which it does not take a value such as "--x" for an option.
  std::vector<std::string> arguments() const {
    std::vector<std::string> words;
    for (const std::string& each : only.texts()) words.push_back("--only=" + each);
    for (const Option* option : {&out, &pareto, &format, &size}) {
      if (option->is_given()) words.push_back(option->name() + "=" + option->text());
    }
    if (database.is_given()) words.insert(words.end(), {"--", database.text()});
    return words;
  }
};

int plot(const PlotOptions& options) {
  try {
    process::become_script("plot_all.py", options.arguments());
  } catch (const std::runtime_error& error) {
    process::refuse(error.what());
  }
}

}  // namespace

void add_plot(CLI::App& program, Action& action) {
  add_command(program, action, "plot", "Draw the figures of a sweep", plot, kPlotFooter);
}

}  // namespace stereotlm::cli
