#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "platform/config/board_area.h"
#include "platform/config/buffer_layout.h"
#include "platform/figures/bounds.h"
#include "sw/cli/command.h"
#include "sw/cli/run_options.h"
#include "sw/files/text_forms.h"
#include "sw/report/page_data/page_data.h"
#include "sw/runs/explanation.h"
#include "sw/stats/console_table.h"

namespace stereotlm::cli {
namespace {

using platform::BoardConfig;
using runs::Explanation;

constexpr std::size_t kMostBlames = 5;
constexpr double kLeastGainPercent = 0.1;  // a change that gains or loses less is not in the table
constexpr double kLeastSavedPercent = 1;  // of the FPGA or the energy: a change that saves it is there anyway

constexpr const char* kBankLess = "a bank less";

std::string signed_text(std::int64_t number) { return number == 0 ? "0" : fmt::format("{:+}", number); }

// A pointer to the search where several buffers share the bank at which ports wait.
std::string shared_bank_text(const BoardConfig& board, const Explanation& explanation) {
  const auto wait = runs::longest_wait(explanation);
  if (!wait) return "";
  const std::vector<platform::PlacedBuffer> all = platform::buffers(board);
  const auto in_bank =
      std::count_if(all.begin(), all.end(), [&](const auto& buffer) { return buffer.bank == wait->bank; });
  const bool has_stripes = std::any_of(all.begin(), all.end(), [](const auto& b) { return b.parts > 1; });
  if (in_bank < 2 || has_stripes) return "";
  return fmt::format("{} holds {} buffers: `stereotlm allocate` searches all their placements\n",
                     platform::bank_text(wait->bank), in_bank);
}

std::string head_text(const BoardConfig& board, const platform::Tables& tables,
                      const Explanation& explanation) {
  const runs::NamedFigures& row = explanation.figures();
  const bool camera = explanation.camera();
  const std::string stepped = runs::stepped_text(board, tables, camera);
  const std::string of = camera ? "bound.system" : "bound.core";
  const Explanation::Rate& now = explanation.now();
  return paragraph(
             fmt::format("{}, {}: ", board.name, camera ? "the whole computer" : "the core alone"), 2,
             fmt::format("{:.3f}{} frames/s{}, limited by {}", now.frames_per_second,
                         now.uncertainty > 0 ? fmt::format(" ± {:.3f}", now.uncertainty) : "",
                         now.loses_pixels() ? " with pixels lost" : "", runs::limiter_text(explanation))) +
         paragraph("the time of a frame: ", 2, runs::budget_text(explanation)) +
         fmt::format("{} bound {:.3f} frames/s{}: {}; {} frames simulated\n", camera ? "steady" : "core",
                     row.real(of), now.loses_pixels() ? " of whole pictures" : "",
                     stats::resource_words(row.text(of + "_limited_by")), explanation.frames()) +
         platform::device_text(board) + '\n' +
         (stepped.empty() ? "" : fmt::format("simulated cycle by cycle, which takes longer: {}\n", stepped)) +
         shared_bank_text(board, explanation);
}

// The table of resources. Resources of one kind whose values are printed alike share a line.
std::string resources_text(const BoardConfig& board, const Explanation& explanation) {
  struct Line {
    std::string kind;    // "port ", "bank ", ..
    std::string values;  // as printed
    std::string frame;
    std::vector<std::string> names{};
  };
  std::vector<Line> lines;
  for (const Explanation::Resource& resource : explanation.resources()) {
    Line line = {
        resource.name.substr(0, resource.name.find(' ') + 1),
        fmt::format("{:>12.2f} {:>8.2f} {:>14.3f}", files::without_minus_zero(resource.headroom_percent, 2),
                    resource.busy_percent, resource.frames_per_second),
        resource.varies
            ? fmt::format(", in frame {} of {}", resource.frame, platform::allocation_period_frames(board))
            : ""};
    auto same = std::find_if(lines.begin(), lines.end(), [&line](const Line& other) {
      return !line.kind.empty() && other.kind == line.kind && other.values == line.values &&
             other.frame == line.frame;
    });
    if (same == lines.end()) same = lines.insert(same, line);
    same->names.push_back(resource.name);
  }
  const auto place_of_bank = [&board](const std::string& resource) {
    return std::find_if(board.banks.begin(), board.banks.end(), [&](const platform::BankConfig& bank) {
      return resource == platform::resource_of_bank(bank.name);
    });
  };
  std::string text =
      fmt::format("  {:>12} {:>8} {:>14}  {}\n", "headroom %", "busy %", "bound frames/s", "resource");
  for (Line& line : lines) {
    const bool are_ports = line.kind == "port ";
    std::stable_sort(line.names.begin(), line.names.end(),
                     [&](const auto& a, const auto& b) { return place_of_bank(a) < place_of_bank(b); });
    for (std::string& name : line.names)
      name = are_ports ? name.substr(line.kind.size()) : stats::resource_text(name);
    text += fmt::format("  {}  {}{}{}\n", line.values, are_ports ? line.kind : "",
                        stats::ports_text(line.names), line.frame);
  }
  return text;
}

std::string blames_text(const Explanation& explanation) {
  const std::vector<platform::BlameRow>& blames = explanation.group_blames();
  std::string text = "who waits for whom, % of the cycles of the frames\n";
  for (std::size_t row = 0; row < blames.size(); ++row) {
    if (row == kMostBlames) return text + "  and others, less\n";
    text += fmt::format("  {:<12} on {:<12} for {:<14} {:>8.3f}\n", blames[row].port,
                        platform::bank_text(blames[row].bank), stats::cause_text(blames[row].by),
                        explanation.percent_of_cycles(blames[row].cycles));
  }
  return blames.empty() ? "no port waits for another\n" : text;
}

// The line of a change. Empty if the change affects neither the rate nor whether pixels are lost, and saves
// neither a part of the FPGA, nor energy, nor a bank.
std::string line_of(const Explanation::Step& found, const BoardConfig& board,
                    const Explanation& explanation) {
  const explore::KnobStep& step = *found.step;
  const Explanation::Rate& now = explanation.now();
  const area::Area its = platform::area_of(step.board);
  const area::Area before = platform::area_of(board);
  const double slices_percent = its.slices_percent - before.slices_percent;
  const double energy_percent = explanation.energy_percent(found);
  const double saved = std::min({slices_percent, its.block_rams_percent - before.block_rams_percent,
                                 its.multipliers_percent - before.multipliers_percent, energy_percent});
  const bool changes_loss = found.rate.loses_pixels() != now.loses_pixels();
  if (std::abs(explanation.gained_percent(found)) < kLeastGainPercent && !changes_loss &&
      saved > -kLeastSavedPercent && step.knob != kBankLess)
    return "";
  const double gained = found.rate.frames_per_second - now.frames_per_second;
  std::string text = fmt::format(
      "  {:>8.3f} {:>+8.3f} {:>+8.2f} {:>+7.2f} {:>6} {:>4}  {}{}: {} -> {}", found.rate.frames_per_second,
      files::without_minus_zero(gained, 3), files::without_minus_zero(explanation.gained_percent(found), 2),
      files::without_minus_zero(energy_percent, 2),
      its.slices == before.slices ? "0"
                                  : fmt::format("{:+.2f}", files::without_minus_zero(slices_percent, 2)),
      signed_text(its.block_rams - before.block_rams), step.knob, step.changes_disparities ? " *" : "",
      step.from, step.to);
  if (its.multipliers != before.multipliers)
    text += fmt::format(", {:+} multipliers", its.multipliers - before.multipliers);
  if (const int pins = platform::pins_of(step.board) - platform::pins_of(board); pins != 0)
    text += fmt::format(", {:+} pins", pins);
  if (!its.fits()) text += "  does not fit";
  if (found.rate.loses_pixels()) text += "  loses pixels";
  if (changes_loss && now.loses_pixels()) text += "  loses no pixels";
  if (gained != 0 && std::abs(gained) <= found.rate.uncertainty + now.uncertainty) text += "  ~";
  text += '\n';
  if (step.sets == std::vector<std::string>{step.knob + "=" + step.to}) return text;
  for (const std::string& set : step.sets) text += fmt::format("{:49}--set {}\n", "", files::shell_word(set));
  return text;
}

// The table of the changes, the best first. Below it, changes without a line are named in the order of the
// keys: by the key, or by its new value if other values of the key have a line.
std::string changes_text(const BoardConfig& board, const Explanation& explanation) {
  std::string text = fmt::format(
      "one change at a time: {} boards simulated; *: the disparities change too{}\n{}{}"
      "to try a change, append --set KEY=TO, and drop an earlier --set of the same key\n"
      "now {:.3f} mJ a frame; mJ %: the change of that, of {}\n"
      "  {:>8} {:>8} {:>8} {:>7} {:>6} {:>4}  change: from -> to\n",
      explanation.simulated(), explanation.camera() ? "; ~: within the uncertainty" : "",
      explanation.shared() == 0
          ? ""
          : fmt::format("{} more do the same at the same time as one of these or as now, and share its run\n",
                        explanation.shared()),
      explanation.left_out() == 0
          ? ""
          : fmt::format("{} other ways of a change are left out: none exceeds the rate of the way listed by "
                        "more than its uncertainty\n",
                        explanation.left_out()),
      explanation.now().memory_mj, platform::kEnergyIsOf, "frames/s", "gained", "%", "mJ %", "FPGA %",
      "RAMs");
  const std::string interruption = explanation.interruption();
  const auto& steps = explanation.steps();
  if (!interruption.empty()) {
    text.insert(0, "interrupted: " + interruption + '\n');
  } else if (explanation.now().loses_pixels() &&
             std::none_of(steps.begin(), steps.end(), [](const auto& step) {
               return step.rate.failure.empty() && !step.rate.loses_pixels();
             })) {
    text += "  none of these changes ends the loss of pixels\n";
  }
  std::set<std::string> listed;              // keys with a line
  std::set<const explore::KnobStep*> small;  // changes without a line
  std::string failures;
  for (const Explanation::Step& found : explanation.steps()) {
    const explore::KnobStep& step = *found.step;
    if (!found.rate.failure.empty()) {
      failures +=
          fmt::format("failed: {}: {} -> {}: {}\n", step.knob, step.from, step.to, found.rate.failure);
    } else if (const std::string line = line_of(found, board, explanation); !line.empty()) {
      listed.insert(step.knob);
      text += line;
    } else {
      small.insert(&step);
    }
  }
  std::vector<std::string> names;
  for (const explore::KnobStep& step : explanation.knobs().possible) {
    const std::string name = listed.count(step.knob) == 0 ? step.knob : step.knob + " -> " + step.to;
    if (small.count(&step) > 0 && std::find(names.begin(), names.end(), name) == names.end())
      names.push_back(name);
  }
  if (!names.empty())
    text += paragraph("no effect, or less than 0.1 %: ", 2, fmt::format("{}", fmt::join(names, "; ")));
  for (const explore::KnobStep& step : explanation.knobs().forbidden)
    text += paragraph("not possible here: ", 2,
                      fmt::format("{}: {} -> {}, because {}", step.knob, step.from, step.to, step.reason));
  return text + failures;
}

struct ExplainOptions : Options {
  using Options::Options;

  void check_together(process::Problems& problems) override {
    if (json.is_given() && page_data.is_given()) problems.add("--page-data: does not go with --json");
    if (!frames.is_given()) return;
    const bool camera = source.is_camera();
    const platform::IntegerRule rule =
        camera
            ? platform::IntegerRule{runs::Explanation::kLeastComputerFrames, 1'000'000}
            : platform::IntegerRule{runs::Explanation::kCoreFrames, 999'996, runs::Explanation::kCoreFrames};
    if (!rule.allows(frames.number<std::int64_t>().value_or(0)))
      problems.add(fmt::format(
          "--frames = {}: {}{}", frames.text(), rule.text(),
          camera ? ", so that every board has a steady rate" : ", whole turns of the lists of every board"));
  }

  BoardOptions board{this};
  SourceOption source{this};
  Option frames = Option(this, "--frames", "N",
                         fmt::format("Frames of each board; by default {}, of the whole computer {}",
                                     runs::Explanation::kCoreFrames, runs::Explanation::kComputerFrames));
  JsonOption json{this};
  Option page_data = Option(this, "--page-data", "",
                            "Print what the page of `report` has of these changes, as JSON: the same, with "
                            "what each change takes");
};

int explain(const ExplainOptions& options) {
  process::Problems problems;
  const LoadedBoard loaded = options.board.load(problems);
  const auto& board = loaded.board;
  problems.check();
  loaded.say_clock_remark();
  const platform::Tables tables = loaded.tables();
  process::catch_interrupts();
  runs::Explanation explanation(*board, tables, options.source.is_camera(),
                                options.frames.number<std::uint64_t>().value_or(0));
  if (!explanation.simulate(loaded.simulator()))
    return interrupted("the board itself was not simulated: there is no result");
  process::print(options.page_data.is_given() ? json_text(report::knobs_data(*board, explanation))
                 : options.json.is_given()
                     ? json_text(runs::explanation_document(*board, explanation))
                     : head_text(*board, tables, explanation) + resources_text(*board, explanation) +
                           blames_text(explanation) + changes_text(*board, explanation));
  const std::string interruption = explanation.interruption();
  return interruption.empty() ? kDone : interrupted(interruption);
}

}  // namespace

void add_explain(Commands& commands) {
  add_command(
      commands, "explain", "Say what limits a board, and what each single change gains or costs", explain,
      "The board is simulated, and then once more for each change: one key one step up or down, such as a\n"
      "cycle, a MHz, a place in a queue, a word of a burst, a buffer or a bank. The changes are sorted by\n"
      "their frame rate, and those that lose pixels are last. FPGA % (of the slices) and RAMs are what a\n"
      "change takes of the FPGA, or frees, mJ % what it does to the energy of a frame. A bank more is the\n"
      "best way to give one buffer a new bank of its own, a bank less the best way to move the buffers of\n"
      "one bank into another. The size of the images, the depth of banks and the device stay.");
}

}  // namespace stereotlm::cli
