#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>
#include <vector>

#include "platform/bounds.h"
#include "platform/config/board_area.h"
#include "platform/config/buffer_layout.h"
#include "sw/cli/board_options.h"
#include "sw/cli/command.h"
#include "sw/explore/store/store.h"
#include "sw/files/text_forms.h"
#include "sw/process/interrupt.h"
#include "sw/process/streams.h"
#include "sw/runs/explanation.h"
#include "sw/stats/console_table.h"
#include "sw/stats/stats_json.h"

namespace stereotlm::cli {
namespace {

using Json = nlohmann::ordered_json;
using platform::BoardConfig;
using runs::Explanation;

constexpr int kMostBlames = 5;
constexpr double kLeastGainPercent = 0.1;  // a change that gains or loses less is not in the table
constexpr double kLeastSavedPercent = 1;   // of the FPGA: a change that saves as much is in the table anyway

constexpr const char* kBankLess = "a bank less";

// What a change takes of the FPGA beside the board as it is.
struct Price {
  std::int64_t slices = 0;
  double slices_percent = 0;
  std::int64_t block_rams = 0;
  double block_rams_percent = 0;
  std::int64_t multipliers = 0;
  double multipliers_percent = 0;
  bool fits = true;

  bool saves() const {
    return std::min({slices_percent, block_rams_percent, multipliers_percent}) <= -kLeastSavedPercent;
  }
};

Price price_of(const BoardConfig& changed, const BoardConfig& board) {
  const area::Area its = platform::area_of(changed);
  const area::Area now = platform::area_of(board);
  return {its.slices - now.slices,
          its.slices_percent - now.slices_percent,
          its.block_rams - now.block_rams,
          its.block_rams_percent - now.block_rams_percent,
          its.multipliers - now.multipliers,
          its.multipliers_percent - now.multipliers_percent,
          its.fits()};
}

std::string signed_text(std::int64_t number) { return number == 0 ? "0" : fmt::format("{:+}", number); }

class ExplanationText {
 public:
  ExplanationText(const BoardConfig& board, Explanation& explanation)
      : board_(board), explanation_(explanation), now_(explanation.now()), steps_(explanation.steps()) {}

  std::string text() {
    const std::string table = changes();  // notes the changes for without_effect()
    return head() + resources() + blames() + table + without_effect() + forbidden() + failures();
  }

 private:
  std::string head() {
    const explore::StoredRow& row = explanation_.figures();
    const bool camera = explanation_.camera();
    const std::string of = camera ? "bound.system" : "bound.core";
    const std::string rate = camera ? fmt::format("{:.3f} ± {:.3f}", now_.frames_per_second, now_.uncertainty)
                                    : fmt::format("{:.3f}", now_.frames_per_second);
    return paragraph(fmt::format("{}, {}: ", board_.name, camera ? "the whole computer" : "the core alone"),
                     2, fmt::format("{} frames/s, limited by {}", rate, runs::limiter_text(explanation_))) +
           paragraph("the time of a frame: ", 2, runs::budget_text(explanation_)) +
           fmt::format("bound {:.3f} frames/s: {}; {} frames simulated{}\n", row.real(of),
                       stats::resource_words(row.text(of + "_limited_by")), explanation_.frames(),
                       now_.loses_pixels ? "; captures lose pixels" : "") +
           platform::device_text(board_) + '\n' + shared_bank();
  }

  // A pointer to the search where several buffers share the bank at which ports wait.
  std::string shared_bank() const {
    const auto wait = runs::longest_wait(explanation_);
    if (!wait) return "";
    const std::vector<platform::PlacedBuffer> all = platform::buffers(board_);
    const auto in_bank = std::count_if(
        all.begin(), all.end(), [&](const platform::PlacedBuffer& each) { return each.bank == wait->bank; });
    return in_bank < 2
               ? ""
               : fmt::format("{} holds {} buffers: `stereotlm allocate` searches all their placements\n",
                             wait->bank, in_bank);
  }

  // The table of resources. Resources of one kind with the same values share a line.
  std::string resources() {
    const std::vector<Explanation::Resource> all = explanation_.resources();
    const std::uint64_t turn = platform::allocation_period_frames(board_);
    std::string text =
        fmt::format("  {:>12} {:>8} {:>14}  {}\n", "headroom %", "busy %", "bound frames/s", "resource");
    for (auto first = all.begin(); first != all.end();) {
      const std::string kind = first->name.substr(0, first->name.find(' ') + 1);
      std::string label = stats::resource_text(first->name);
      auto next = first + 1;
      for (; next != all.end() && next->headroom_percent == first->headroom_percent && !kind.empty() &&
             next->busy_percent == first->busy_percent && next->name.rfind(kind, 0) == 0 &&
             next->varies == first->varies && (!first->varies || next->frame == first->frame);
           ++next) {
        label += ", " + next->name.substr(kind.size());
      }
      if (first->varies) label += fmt::format(", in frame {} of {}", first->frame, turn);
      text += fmt::format("  {:>12.2f} {:>8.2f} {:>14.3f}  {}\n", first->headroom_percent,
                          first->busy_percent, first->frames_per_second, label);
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
      text += fmt::format("  {:<12} on {:<12} for {:<14} {:>8.3f}\n", blame.port, blame.bank,
                          stats::cause_text(blame.by), 100 * static_cast<double>(blame.cycles) / cycles);
      ++rows;
    }
    return rows > 0 ? text : "no port waits for another\n";
  }

  double gained_percent(const Explanation::Step& step) const {
    return 100 * (step.rate.frames_per_second / now_.frames_per_second - 1);
  }

  // Whether the gain lies within the uncertainty of both steady rates.
  bool is_uncertain(const Explanation::Step& step) const {
    const double gained = std::abs(step.rate.frames_per_second - now_.frames_per_second);
    return gained > 0 && gained <= step.rate.uncertainty + now_.uncertainty;
  }

  // Whether a change has a line of its own in the table: it changes the rate, or whether pixels are lost, or
  // it saves a part of the FPGA or a bank.
  bool is_listed(const Explanation::Step& step, const Price& price) const {
    return std::abs(gained_percent(step)) >= kLeastGainPercent ||
           step.rate.loses_pixels != now_.loses_pixels || price.saves() || step.step->knob == kBankLess;
  }

  // The table of the changes, the best first. Fills listed_ and small_.
  std::string changes() {
    std::string text = fmt::format(
        "one change at a time: {} boards simulated; *: the disparities change too{}\n"
        "to try a change, append --set KEY=TO, and drop an earlier --set of the same key\n",
        explanation_.knobs().possible.size(), explanation_.camera() ? "; ~: within the uncertainty" : "");
    text += fmt::format("  {:>8} {:>8} {:>8} {:>6} {:>4}  change: from -> to\n", "frames/s", "gained", "%",
                        "FPGA %", "RAMs");
    for (const Explanation::Step& found : steps_) {
      const explore::KnobStep& step = *found.step;
      if (!found.rate.failure.empty()) continue;
      const Price price = price_of(step.board, board_);
      if (!is_listed(found, price)) {
        small_.insert(&step);
        continue;
      }
      listed_.insert(step.knob);
      text += line_of(found, price);
    }
    return text;
  }

  std::string line_of(const Explanation::Step& found, const Price& price) const {
    const explore::KnobStep& step = *found.step;
    std::string text = fmt::format(
        "  {:>8.3f} {:>+8.3f} {:>+8.2f} {:>6} {:>4}  {}{}: {} -> {}", found.rate.frames_per_second,
        found.rate.frames_per_second - now_.frames_per_second, gained_percent(found),
        price.slices == 0 ? "0" : fmt::format("{:+.2f}", price.slices_percent), signed_text(price.block_rams),
        step.knob, step.changes_disparities ? " *" : "", step.from, step.to);
    if (price.multipliers != 0) text += fmt::format(", {:+} multipliers", price.multipliers);
    if (!price.fits) text += "  does not fit";
    if (found.rate.loses_pixels && !now_.loses_pixels) text += "  loses pixels";
    if (!found.rate.loses_pixels && now_.loses_pixels) text += "  loses no pixels";
    if (is_uncertain(found)) text += "  ~";
    text += '\n';
    if (step.sets == std::vector<std::string>{step.knob + "=" + step.to}) return text;
    for (const std::string& set : step.sets)
      text += fmt::format("{:41}--set {}\n", "", files::shell_word(set));
    return text;
  }

  // A paragraph that names the changes without a line, in the order of the keys: by the key, or by its new
  // value if other values of the key have a line.
  std::string without_effect() const {
    std::vector<std::string> names;
    for (const explore::KnobStep& step : explanation_.knobs().possible) {
      if (small_.count(&step) == 0) continue;
      const std::string name = listed_.count(step.knob) == 0 ? step.knob : step.knob + " -> " + step.to;
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
    return names.empty()
               ? ""
               : paragraph("no effect, or less than 0.1 %: ", 2, fmt::format("{}", fmt::join(names, "; ")));
  }

  std::string forbidden() const {
    std::string text;
    for (const explore::KnobStep& step : explanation_.knobs().forbidden)
      text += paragraph("not possible here: ", 2,
                        fmt::format("{}: {} -> {}, because {}", step.knob, step.from, step.to, step.reason));
    return text;
  }

  std::string failures() const {
    std::string text;
    for (const Explanation::Step& found : steps_) {
      if (found.rate.failure.empty()) continue;
      text += fmt::format("failed: {}: {} -> {}: {}\n", found.step->knob, found.step->from, found.step->to,
                          found.rate.failure);
    }
    return text;
  }

  const BoardConfig& board_;
  Explanation& explanation_;
  Explanation::Rate now_;
  std::vector<Explanation::Step> steps_;
  std::set<std::string> listed_;              // keys with a line in the table
  std::set<const explore::KnobStep*> small_;  // changes without a line
};

Json resources_json(Explanation& explanation) {
  Json all = Json::array();
  for (const Explanation::Resource& resource : explanation.resources()) {
    Json row = {{"resource", resource.name},
                {"frames_per_second", resource.frames_per_second},
                {"headroom_percent", resource.headroom_percent},
                {"busy_percent", resource.busy_percent}};
    if (resource.varies) row["frame"] = resource.frame;
    all.push_back(std::move(row));
  }
  return all;
}

Json blame_json(Explanation& explanation) {
  const auto cycles = static_cast<double>(explanation.figures().integer("cycles"));
  Json all = Json::array();
  for (const explore::StoredBlame& blame : explanation.blames()) {
    all.push_back({{"port", blame.port},
                   {"bank", blame.bank},
                   {"by", blame.by},
                   {"cycles", blame.cycles},
                   {"cycles_percent", 100 * static_cast<double>(blame.cycles) / cycles}});
  }
  return all;
}

Json area_json(const BoardConfig& board) {
  const area::Area area = platform::area_of(board);
  Json json = stats::area_json(area);
  json["fits"] = area.fits();
  return json;
}

template <typename Step>
Json change_json(const Step& step) {
  return {{"key", step.knob}, {"from", step.from}, {"to", step.to}};
}

// Adds `changes`, the best first, `failed` and `impossible`.
void add_changes(Explanation& explanation, Json& document) {
  const double now = explanation.now().frames_per_second;
  Json changes = Json::array();
  Json failed = Json::array();
  for (const Explanation::Step& found : explanation.steps()) {
    const explore::KnobStep& step = *found.step;
    Json change = change_json(step);
    if (!found.rate.failure.empty()) {
      change["reason"] = found.rate.failure;
      failed.push_back(std::move(change));
      continue;
    }
    const double rate = found.rate.frames_per_second;
    change["frames_per_second"] = rate;
    change["gained_frames_per_second"] = rate - now;
    change["gained_percent"] = 100 * (rate / now - 1);
    change["changes_disparities"] = step.changes_disparities;
    change["loses_pixels"] = found.rate.loses_pixels;
    change["sets"] = step.sets;
    change["area"] = area_json(step.board);
    changes.push_back(std::move(change));
  }
  document["changes"] = std::move(changes);
  Json& impossible = document["impossible"] = Json::array();
  for (const explore::KnobStep& step : explanation.knobs().forbidden) {
    impossible.push_back(change_json(step));
    impossible.back()["reason"] = step.reason;
  }
  document["failed"] = std::move(failed);
}

std::string explanation_text(const BoardConfig& board, Explanation& explanation) {
  return ExplanationText(board, explanation).text();
}

Json explanation_document(const BoardConfig& board, Explanation& explanation) {
  const Explanation::Rate now = explanation.now();
  const explore::StoredRow& row = explanation.figures();
  const std::string of = explanation.camera() ? "bound.system" : "bound.core";
  Json document = {
      {"schema", 1},
      {"board", board.name},
      {"source", explanation.camera() ? "camera" : "preloaded"},
      {"frames", explanation.frames()},
      {"frames_per_second", now.frames_per_second},
      {"loses_pixels", now.loses_pixels},
      {"bound", {{"frames_per_second", row.real(of)}, {"limited_by", row.text(of + "_limited_by")}}}};
  if (explanation.camera()) document["uncertainty_frames_per_second"] = now.uncertainty;
  document["limited_by"] = runs::limiter_text(explanation);
  const runs::Budget& budget = explanation.budget();
  document["time_percent"] = {{"bound", budget.bound}, {"queues", budget.queues}, {"waits", budget.waits}};
  for (const auto& [why, share] : budget.core_waits) document["time_percent"]["core_waits"][why] = share;
  const double queue = runs::result_queue_percent(explanation);
  if (queue > 0) document["result_queue_wait_percent"] = queue;
  document["resources"] = resources_json(explanation);
  document["blame"] = blame_json(explanation);
  document["area"] = area_json(board);
  add_changes(explanation, document);
  return document;
}

struct ExplainOptions : Options {
  using Options::Options;

  void check_together(process::Problems& problems) override {
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
};

int explain(const ExplainOptions& options) {
  process::Problems problems;
  const LoadedBoard loaded = options.board.load(problems);
  const auto& board = loaded.board;
  check_temporary_folder(problems);
  if (const auto problem = board ? explore::bank_names_problem(*board) : std::nullopt)
    problems.add(fmt::format("{}: {}", options.board.name(), *problem));
  problems.check();
  loaded.say_clock_remark();
  const platform::Tables tables = loaded.tables();
  process::catch_interrupts();
  runs::Explanation explanation(*board, tables, options.source.is_camera(),
                                options.frames.number<std::uint64_t>().value_or(0));
  if (!explanation.simulate(loaded.simulator())) return kInterrupted;
  if (options.json.is_given()) {
    print_json(explanation_document(*board, explanation));
  } else {
    process::print(explanation_text(*board, explanation));
  }
  return kDone;
}

}  // namespace

void add_explain(CLI::App& program, Action& action) {
  add_command(
      program, action, "explain", "Say what limits a board, and what each single change gains or costs",
      explain,
      "The board is simulated, and then once more for each change: one key one step up or down, such as a\n"
      "cycle, a MHz, a place in a queue, a word of a burst, a buffer or a bank. The changes are sorted by\n"
      "their frame rate. FPGA % (of the slices) and RAMs are what a change takes of the FPGA, or frees. A\n"
      "bank more is the best way to give one buffer a new bank of its own, a bank less the best way to\n"
      "move all buffers of one bank into another. The size of the images, the depth of banks and the\n"
      "device stay.");
}

}  // namespace stereotlm::cli
