#include "sw/cli/searching.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "sw/process/streams.h"
#include "sw/runs/progress.h"

namespace stereotlm::cli {
namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

std::string progress_text(const explore::SearchState& state, bool has_gap, double seconds) {
  constexpr std::uint64_t kMostDigits = 10'000'000;
  const std::string boards = state.boards < kMostDigits
                                 ? std::to_string(state.boards)
                                 : fmt::format("{:.3g}", static_cast<double>(state.boards));
  std::string text = fmt::format("{} board{}{}: {} open, {} simulated", boards, state.boards == 1 ? "" : "s",
                                 state.is_counted ? "" : " counted", state.open, state.simulated);
  if (state.has_best && has_gap && !std::isfinite(state.bound)) {
    text += fmt::format(", best {:.6g}, no bound", state.best);
  } else if (state.has_best && has_gap) {
    text += fmt::format(", best {:.6g}, bound {:.6g}, gap {:.2f} %", state.best, state.bound,
                        state.best == 0 ? 0 : 100 * std::abs(state.bound / state.best - 1));
  }
  return text + fmt::format(", {:.0f} s", seconds);
}

bool run_search(explore::Search& search, const explore::SearchStore* store, bool has_gap,
                std::optional<double> most_seconds) {
  constexpr std::chrono::seconds kBetweenWrites{1};
  if (store != nullptr) search.know(store->results());
  runs::ProgressLine line("boards are ruled out by bounds, or simulated");
  const auto start = Clock::now();
  auto next_write = start + kBetweenWrites;
  const bool is_whole = search.run([&](const explore::SearchState& state) {
    line.show(state.boards - state.open, state.boards,
              [&](double seconds) { return progress_text(state, has_gap, seconds); });
    if (store != nullptr && Clock::now() >= next_write) {
      store->add(search.take_results());
      next_write = Clock::now() + kBetweenWrites;
    }
    const std::chrono::duration<double> seconds = Clock::now() - start;
    return !process::interrupted() && !(most_seconds && seconds.count() > *most_seconds);
  });
  if (store != nullptr) store->add(search.take_results());
  return is_whole;
}

const char* resume_text(bool is_kept) {
  return is_kept ? "run the same command to resume" : "nothing is kept: give --out DB to resume later";
}

}  // namespace stereotlm::cli
