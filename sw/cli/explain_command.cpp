#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "models/fpga/core_ports.h"
#include "sw/cli/add_command.h"
#include "sw/cli/board_options.h"
#include "sw/cli/commands.h"
#include "sw/cli/exit_status.h"
#include "sw/cli/temporary_files.h"
#include "sw/cli/text.h"
#include "sw/cli/typed_option.h"
#include "sw/explore/plan/knobs.h"
#include "sw/explore/store/bank_names.h"
#include "sw/process/interrupt.h"
#include "sw/process/streams.h"
#include "sw/runs/explanation.h"

namespace stereotlm::cli {
namespace {

using explore::KnobStep;
using platform::BoardConfig;
using runs::Explanation;
using Effect = Explanation::Effect;

constexpr int kMostBlames = 5;
constexpr double kVisibleLoss = 0.01;  // of the cycles

struct ExplainOptions {
  BoardOptions board;
  Typed source;
  bool camera = true;  // set by check_usage()

  void add_to(CLI::App& command) {
    board.add_to(command);
    source.add_to(command, "--source", "camera|preloaded",
                  "The whole computer, the default, or the core alone, fed by an ideal host");
  }

  void check_usage() {
    process::Problems problems;
    board.check_given(problems);
    if (source.is_given() && is_one_of({"camera", "preloaded"}, "--source", source.text, problems)) {
      camera = source.text == "camera";
    }
    problems.check();
  }
};

// The text that `explain` prints.
class ExplanationText {
 public:
  ExplanationText(const BoardConfig& board, Explanation& explanation)
      : board_(board), explanation_(explanation), now_(explanation.now()), steps_(explanation.steps()) {}

  std::string text() {
    return head() + result_queue() + resources() + blames() + prices() +
           knobs_with(Effect::kTooSmall, "less than 0.0005 frames/s: ") +
           knobs_with(Effect::kNone, "no effect on this run: ") + forbidden() + failures();
  }

 private:
  std::string head() {
    const explore::StoredRow& row = explanation_.figures();
    const bool camera = explanation_.camera();
    const char* const of = camera ? "bound.system" : "bound.core";
    return fmt::format("{}, {}: {:.3f} frames/s{} ({} frames); bound {:.3f}, limited by {}{}\n", board_.name,
                       camera ? "the whole computer" : "the core alone", now_.frames_per_second,
                       camera ? " between the first and the last delivery" : "", explanation_.frames(),
                       row.real(of), row.text(std::string(of) + "_limited_by"),
                       now_.loses_pixels ? "; captures lose pixels" : "");
  }

  // A line if the matcher waits for places in the result queue, which no bound counts. Then it is slower than
  // its bound though no port stalls, and the ports that fill the lanes are blocked.
  std::string result_queue() {
    const explore::StoredRow& row = explanation_.figures();
    const double cycles = static_cast<double>(row.integer("cycles"));
    const double lost = cycles * (1 - row.real("frames_per_second.core") / row.real("bound.core"));
    std::int64_t stalled = 0;
    std::int64_t blocked = 0;
    for (const fpga::CorePort& port : fpga::kPorts) {
      const std::string name = std::string("ports.") + port.name;
      stalled += row.integer(name + ".stall_cycles");
      blocked = std::max(blocked, row.integer(name + ".blocked_cycles"));
    }
    const char* const of = explanation_.camera() ? "bound.system_limited_by" : "bound.core_limited_by";
    const bool is_it = row.text(of) == "matcher" && lost > kVisibleLoss * cycles && stalled == 0 &&
                       static_cast<double>(blocked) > lost / 2;
    return is_it ? fmt::format(
                       "the result queue is too short: in {:.2f} % of the cycles the matcher waits for "
                       "fpga.result_fifo_words\n",
                       100 * lost / cycles)
                 : "";
  }

  // The table of resources. Resources of one kind with the same values share a line.
  std::string resources() {
    const std::vector<Explanation::Resource> all = explanation_.resources();
    const std::uint64_t turn = platform::allocation_period_frames(board_);
    std::string text = fmt::format("  {:>12} {:>14}  {}\n", "headroom %", "bound frames/s", "resource");
    for (auto first = all.begin(); first != all.end();) {
      const std::string kind = first->name.substr(0, first->name.find(' ') + 1);
      std::string label = first->name;
      auto next = first + 1;
      for (; next != all.end() && next->headroom_percent == first->headroom_percent && !kind.empty() &&
             next->name.rfind(kind, 0) == 0 && next->varies == first->varies &&
             (!first->varies || next->frame == first->frame);
           ++next) {
        label += ", " + next->name.substr(kind.size());
      }
      if (first->varies) label += fmt::format(", in frame {} of {}", first->frame, turn);
      text += fmt::format("  {:>12.2f} {:>14.3f}  {}\n", first->headroom_percent, first->frames_per_second,
                          label);
      first = next;
    }
    return text;
  }

  std::string blames() {
    const auto cycles = static_cast<double>(explanation_.figures().integer("cycles"));
    std::string text = "who waits for whom, % of the cycles of the frames\n";
    int rows = 0;
    for (const explore::StoredBlame& blame : explanation_.blames()) {
      if (rows == kMostBlames) return text + "  and others, less\n";
      text += fmt::format("  {:<12} on {:<12} for {:<12} {:>8.3f}\n", blame.port, blame.bank, blame.by,
                          100 * static_cast<double>(blame.cycles) / cycles);
      ++rows;
    }
    return rows > 0 ? text : "no port waits for another\n";
  }

  // The table of the steps with a visible effect, the best first.
  std::string prices() const {
    std::string text =
        fmt::format("one step of each knob: {} boards simulated; *: the disparities change too\n",
                    explanation_.knobs().possible.size());
    text += fmt::format("  {:>9} {:>9} {:>8}  knob: from -> to\n", "frames/s", "gained", "%");
    std::map<std::string, int> shown;
    for (const auto& [step, rate, effect, bank] : steps_) {
      if (!rate.failure.empty()) continue;
      if (step->only_best ? shown[step->knob]++ > 0 : effect != Effect::kSeen) continue;
      const double gained = rate.frames_per_second - now_.frames_per_second;
      text += fmt::format("  {:>9.3f} {:>+9.3f} {:>+8.2f}  {}{}: {} -> {}{}\n", rate.frames_per_second,
                          gained, 100 * gained / now_.frames_per_second, step->knob,
                          step->changes_disparities ? " *" : "", step->from, step->to,
                          rate.loses_pixels && !now_.loses_pixels ? "  loses pixels" : "");
    }
    return text;
  }

  std::string forbidden() const {
    std::string text;
    for (const explore::ForbiddenStep& step : explanation_.knobs().forbidden)
      text += paragraph("not possible here: ", 2,
                        fmt::format("{}: {} -> {}, because {}", step.knob, step.from, step.to, step.reason));
    return text;
  }

  std::string failures() const {
    std::string text;
    for (const auto& [step, rate, effect, bank] : steps_) {
      if (rate.failure.empty()) continue;
      text += fmt::format("failed: {}: {} -> {}: {}\n", step->knob, step->from, step->to, rate.failure);
    }
    return text;
  }

  // A paragraph with the knobs whose steps have at most this effect, in the order of the knobs.
  std::string knobs_with(Effect effect, const char* head) const {
    std::map<std::string, Effect> effects;
    for (const auto& [step, rate, its_effect, bank] : steps_) {
      if (step->only_best || !rate.failure.empty()) continue;
      Effect& most = effects[step->knob];
      most = std::max(most, its_effect);
    }
    std::string list;
    for (const KnobStep& step : explanation_.knobs().possible) {
      const auto found = effects.find(step.knob);
      if (found == effects.end() || found->second != effect) continue;
      list += (list.empty() ? "" : "; ") + step.knob;
      effects.erase(found);
    }
    return list.empty() ? "" : paragraph(head, 2, list);
  }

  const BoardConfig& board_;
  Explanation& explanation_;
  Explanation::Rate now_;
  std::vector<Explanation::Step> steps_;
};

int explain(const ExplainOptions& options) {
  process::Problems problems;
  const auto board = options.board.load(problems);
  const auto calibration = options.board.load_calibration(board ? &*board : nullptr, problems);
  temporary_folder(problems);  // the simulations need one: reports now if it cannot be created
  if (const auto problem = board ? explore::bank_names_problem(*board) : std::nullopt)
    problems.add(fmt::format("{}: {}", options.board.name(), *problem));
  problems.check();
  const platform::Tables tables = runs::tables_of(*board, calibration);
  process::catch_interrupts();
  Explanation explanation(*board, tables, options.camera);
  if (!explanation.simulate(calibration ? runs::PointSimulator(tables) : runs::PointSimulator())) {
    return kInterrupted;
  }
  process::print(ExplanationText(*board, explanation).text());
  return kDone;
}

}  // namespace

void add_explain(CLI::App& program, Action& action) {
  add_command(
      program, action, "explain", "Say what limits a board, and what one step of each knob gains or costs",
      explain,
      "The board is simulated, and then once more with each of its knobs one step up or down: a cycle, a "
      "MHz,\n"
      "a place in a queue, a word of a burst, a buffer, a bank. What comes out is sorted by the frame rate. "
      "A\n"
      "bank more is the best of giving any one buffer a new bank of its own, a bank less the best of moving\n"
      "all buffers of one bank into another. The size of the images, the depth of banks and the device "
      "stay.");
}

}  // namespace stereotlm::cli
