#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "models/fpga/core_ports.h"
#include "platform/bounds.h"
#include "sw/cli/add_command.h"
#include "sw/cli/board_options.h"
#include "sw/cli/commands.h"
#include "sw/cli/exit_status.h"
#include "sw/cli/temporary_files.h"
#include "sw/cli/text.h"
#include "sw/cli/typed_option.h"
#include "sw/explore/plan/knobs.h"
#include "sw/explore/store/bank_names.h"
#include "sw/explore/sweep/batch.h"
#include "sw/process/installation.h"
#include "sw/process/interrupt.h"
#include "sw/process/streams.h"
#include "sw/runs/progress.h"
#include "sw/runs/simulation/simulate_point.h"

namespace stereotlm::cli {
namespace {

using explore::KnobStep;
using platform::BoardConfig;

constexpr int kMostBlames = 5;
constexpr double kVisibleLoss = 0.01;  // of the cycles
constexpr double kVisible = 0.0005;    // frames per second: half of the last printed digit

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

// The result of the simulation of one board.
struct Rate {
  double frames_per_second = 0;
  bool loses_pixels = false;
  std::string failure;  // the reason if the run has failed; else empty
};

struct StepRate {
  const KnobStep* step = nullptr;
  Rate rate;
};

// Simulates the board itself and one board for each step of a knob, and makes the report.
class Explanation {
 public:
  Explanation(const BoardConfig& board, const platform::Tables& tables, bool camera)
      : board_(board),
        tables_(tables),
        run_{camera, 0, ""},
        steps_(explore::knob_steps(board, camera, joint_problem(tables))),
        points_(boards(), run_) {}

  // Returns false if interrupted.
  bool simulate(runs::PointSimulator simulator) {
    runs::ProgressLine progress;
    return batch_.run(
        points_, [&simulator](const explore::Point& point) { return simulator(point); }, process::kVersion,
        std::max(1U, std::thread::hardware_concurrency()),
        [&](const explore::SweepCounts& done) {
          progress.show(
              [&](double) { return fmt::format("{}/{} boards simulated", done.done(), done.total); });
          return !process::interrupted();
        });
  }

  std::string text() {
    const Rate now = rate_of(0);
    if (!now.failure.empty()) throw std::runtime_error(now.failure);
    std::vector<StepRate> rates;
    for (std::size_t i = 0; i < steps_.possible.size(); ++i)
      rates.push_back({&steps_.possible[i], rate_of(i + 1)});
    return head(now) + result_queue() + resources(now) + blames() + prices(now, rates) +
           knobs_with(Effect::kTooSmall, "less than 0.0005 frames/s: ", now, rates) +
           knobs_with(Effect::kNone, "no effect on this run: ", now, rates) + forbidden() + failures(rates);
  }

 private:
  static std::optional<std::string> joint_problem(const platform::Tables& tables) {
    return tables.left && tables.right ? platform::joint_tables_problem(tables) : std::nullopt;
  }

  std::vector<BoardConfig> boards() const {
    std::vector<BoardConfig> all = {board_};
    for (const KnobStep& step : steps_.possible) all.push_back(step.board);
    return all;
  }

  Rate rate_of(std::uint64_t number) {
    try {
      const explore::StoredRow& row = batch_.row_of(points_.point(number));
      const auto lost =
          row.integer("cameras.left.dropped_pixels") + row.integer("cameras.right.dropped_pixels");
      return {row.real(run_.camera ? "frames_per_second.steady" : "frames_per_second.core"), lost > 0, ""};
    } catch (const explore::PointFailed& failed) {
      return {0, false, failed.what()};
    }
  }

  std::string head(const Rate& now) {
    const std::uint64_t frames = explore::frames_of(run_, board_);
    const explore::StoredRow& row = batch_.row_of(points_.point(0));
    const char* const of = run_.camera ? "bound.system" : "bound.core";
    return fmt::format("{}, {}: {:.3f} frames/s{} ({} frames); bound {:.3f}, limited by {}{}\n", board_.name,
                       run_.camera ? "the whole computer" : "the core alone", now.frames_per_second,
                       run_.camera ? " between the first and the last delivery" : "", frames, row.real(of),
                       row.text(std::string(of) + "_limited_by"),
                       now.loses_pixels ? "; captures lose pixels" : "");
  }

  // A line if the matcher waits for places in the result queue, which no bound counts. Then it is slower than
  // its bound though no port stalls, and the ports that fill the lanes are blocked.
  std::string result_queue() {
    const explore::StoredRow& row = batch_.row_of(points_.point(0));
    const double cycles = static_cast<double>(row.integer("cycles"));
    const double lost = cycles * (1 - row.real("frames_per_second.core") / row.real("bound.core"));
    std::int64_t stalled = 0;
    std::int64_t blocked = 0;
    for (const fpga::CorePort& port : fpga::kPorts) {
      const std::string name = std::string("ports.") + port.name;
      stalled += row.integer(name + ".stall_cycles");
      blocked = std::max(blocked, row.integer(name + ".blocked_cycles"));
    }
    const char* const of = run_.camera ? "bound.system_limited_by" : "bound.core_limited_by";
    const bool is_it = row.text(of) == "matcher" && lost > kVisibleLoss * cycles && stalled == 0 &&
                       static_cast<double>(blocked) > lost / 2;
    return is_it ? fmt::format(
                       "the result queue is too short: in {:.2f} % of the cycles the matcher waits for "
                       "fpga.result_fifo_words\n",
                       100 * lost / cycles)
                 : "";
  }

  // A resource of the board and its bound.
  struct Resource {
    std::string name;
    double frames_per_second = 0;  // its bound
    double headroom_percent = 0;   // by how much the bound exceeds the present rate
    std::uint64_t frame = 0;       // the frame with the least headroom
    bool varies = false;           // the headroom is larger in other frames
  };

  // All resources, the least headroom first. For a resource of the core, the headroom is the least over the
  // frames of one allocation period. The bound is compared with the time of the frame: its cycles and, for a
  // whole computer, its share of the time between frames.
  std::vector<Resource> resources_of(const Rate& now) {
    const auto frame_cycles = nlohmann::json::parse(batch_.row_of(points_.point(0)).text("frame_cycles"))
                                  .get<std::vector<double>>();
    const double mean = std::accumulate(frame_cycles.begin(), frame_cycles.end(), 0.0) /
                        static_cast<double>(frame_cycles.size());
    const double clock_hz = board_.fpga.clock_mhz * 1e6;
    const double stretch = clock_hz / mean / now.frames_per_second;
    std::vector<Resource> all;
    const auto add = [&all](const Resource& found) {
      const auto known =
          std::find_if(all.begin(), all.end(), [&](const auto& other) { return other.name == found.name; });
      if (known == all.end()) {
        all.push_back(found);
      } else if (found.headroom_percent != known->headroom_percent) {
        if (found.headroom_percent < known->headroom_percent) *known = found;
        known->varies = true;
      }
    };
    const std::uint64_t turn = platform::allocation_period_frames(board_);
    for (std::uint64_t frame = 0; frame < std::min<std::uint64_t>(turn, frame_cycles.size()); ++frame) {
      for (const platform::ResourceBound& bound : platform::frame_bounds(board_, tables_, frame)) {
        const auto cycles = static_cast<double>(bound.cycles);
        add({bound.resource, clock_hz / cycles, 100 * (stretch * frame_cycles[frame] / cycles - 1), frame});
      }
    }
    if (run_.camera) {
      for (const platform::RateBound& part : platform::computer_bounds(board_, !now.loses_pixels)) {
        add({part.resource, part.frames_per_second,
             100 * (part.frames_per_second / now.frames_per_second - 1), 0});
      }
    }
    std::stable_sort(all.begin(), all.end(), [](const Resource& a, const Resource& b) {
      return a.headroom_percent < b.headroom_percent;
    });
    return all;
  }

  // The table of resources. Resources of one kind with the same values share a line.
  std::string resources(const Rate& now) {
    const std::vector<Resource> all = resources_of(now);
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
    const explore::Point point = points_.point(0);
    const auto cycles = static_cast<double>(batch_.row_of(point).integer("cycles"));
    explore::Database store(batch_.path(), explore::Database::Access::kRead);
    explore::Statement find(
        store,
        "SELECT port, bank, by, cycles FROM blame WHERE hash = ? ORDER BY cycles DESC, port, bank, by");
    find.bind(1, point.hash);
    std::string text = "who waits for whom, % of the cycles of the frames\n";
    int rows = 0;
    for (; find.step(); ++rows) {
      if (rows == kMostBlames) return text + "  and others, less\n";
      text += fmt::format("  {:<12} on {:<12} for {:<12} {:>8.3f}\n", find.text(0), find.text(1),
                          find.text(2), 100 * static_cast<double>(find.integer(3)) / cycles);
    }
    return rows > 0 ? text : "no port waits for another\n";
  }

  // The table of the steps with a visible effect, the best first.
  std::string prices(const Rate& now, std::vector<StepRate> rates) const {
    std::stable_sort(rates.begin(), rates.end(), [](const StepRate& a, const StepRate& b) {
      return a.rate.frames_per_second > b.rate.frames_per_second;
    });
    std::string text =
        fmt::format("one step of each knob: {} boards simulated; *: the disparities change too\n",
                    steps_.possible.size());
    text += fmt::format("  {:>9} {:>9} {:>8}  knob: from -> to\n", "frames/s", "gained", "%");
    std::map<std::string, int> shown;
    for (const auto& [step, rate] : rates) {
      if (!rate.failure.empty()) continue;
      if (step->only_best ? shown[step->knob]++ > 0 : effect_of(now, rate) != Effect::kSeen) continue;
      const double gained = rate.frames_per_second - now.frames_per_second;
      text +=
          fmt::format("  {:>9.3f} {:>+9.3f} {:>+8.2f}  {}{}: {} -> {}{}\n", rate.frames_per_second, gained,
                      100 * gained / now.frames_per_second, step->knob, step->changes_disparities ? " *" : "",
                      step->from, step->to, rate.loses_pixels && !now.loses_pixels ? "  loses pixels" : "");
    }
    return text;
  }

  std::string forbidden() const {
    std::string text;
    for (const explore::ForbiddenStep& step : steps_.forbidden)
      text += paragraph("not possible here: ", 2,
                        fmt::format("{}: {} -> {}, because {}", step.knob, step.from, step.to, step.reason));
    return text;
  }

  static std::string failures(const std::vector<StepRate>& rates) {
    std::string text;
    for (const auto& [step, rate] : rates) {
      if (rate.failure.empty()) continue;
      text += fmt::format("failed: {}: {} -> {}: {}\n", step->knob, step->from, step->to, rate.failure);
    }
    return text;
  }

  enum class Effect { kNone, kTooSmall, kSeen };

  static Effect effect_of(const Rate& now, const Rate& rate) {
    if (rate.loses_pixels != now.loses_pixels) return Effect::kSeen;
    const double gained = std::abs(rate.frames_per_second - now.frames_per_second);
    return gained >= kVisible ? Effect::kSeen : gained > 0 ? Effect::kTooSmall : Effect::kNone;
  }

  // A paragraph with the knobs whose steps have at most this effect.
  std::string knobs_with(Effect effect, const char* head, const Rate& now,
                         const std::vector<StepRate>& rates) const {
    std::vector<std::string> knobs;
    std::map<std::string, Effect> effects;
    for (const auto& [step, rate] : rates) {
      if (step->only_best || !rate.failure.empty()) continue;
      if (effects.count(step->knob) == 0) knobs.push_back(step->knob);
      Effect& most = effects[step->knob];
      most = std::max(most, effect_of(now, rate));
    }
    std::string list;
    for (const std::string& knob : knobs) {
      if (effects[knob] == effect) list += (list.empty() ? "" : "; ") + knob;
    }
    return list.empty() ? "" : paragraph(head, 2, list);
  }

  const BoardConfig& board_;
  const platform::Tables& tables_;
  explore::PointRun run_;
  explore::KnobSteps steps_;
  explore::BoardPoints points_;
  explore::Batch batch_;
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
  process::print(explanation.text());
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
