#include "sw/explore/search/allocation_run.h"

#include <vector>

#include "sw/explore/plan/points.h"
#include "sw/explore/store/store_reader.h"

namespace stereotlm::explore {
namespace {

// Records the results of some boards in the search. Reads them from the database. If the sweep of the boards
// is whole, it has given up a board that is not in the database.
void record_outcomes(const std::vector<std::size_t>& numbers, const std::string& path, bool is_whole,
                     AllocationSearch& search) {
  StoredRow row(path);
  for (const std::size_t number : numbers) {
    const Point point = search.point(number);
    if (!row.find(point.hash)) {
      if (is_whole) search.record_given_up(number);
      continue;
    }
    AllocationOutcome outcome;
    if (row.text("status") != "ok") {
      outcome.failure = row.text("reason");
      search.record(number, outcome);
      continue;
    }
    const auto behind_last_write = static_cast<std::uint64_t>(point.board->fpga.pipeline_latency_cycles);
    outcome.cycles = static_cast<std::uint64_t>(row.integer("cycles")) + point.run.frames * behind_last_write;
    outcome.frames_per_second =
        row.real(search.run().camera ? "frames_per_second.steady" : "frames_per_second.core");
    outcome.uncertainty = row.real("frames_per_second.steady_uncertainty");
    outcome.loses_pixels =
        row.integer("cameras.left.dropped_pixels") + row.integer("cameras.right.dropped_pixels") > 0;
    search.record(number, outcome);
  }
}

}  // namespace

bool simulate(AllocationSearch& search, const Evaluate& evaluate, const SweepOptions& sweep,
              const std::function<bool(const SearchProgress& progress)>& keep_going) {
  SearchProgress before;
  before.is_narrowed = search.by_frames();
  for (auto numbers = search.next(); !numbers.empty(); numbers = search.next()) {
    const std::uint64_t left = search.most_left();
    const auto progress_of = [&](const SweepCounts& counts) {
      return SearchProgress{before.done + counts.done(), before.simulated + counts.done() - counts.known,
                            left - counts.done(), before.is_narrowed};
    };
    const auto counts =
        explore::sweep(AllocationPoints(search, numbers), evaluate, sweep,
                       [&](const SweepCounts& running) { return keep_going(progress_of(running)); });
    const bool is_whole = counts.done() == counts.total;
    // Without a point the database has no columns of figures.
    if (counts.done() > 0) record_outcomes(numbers, sweep.store, is_whole, search);
    if (!is_whole) return false;
    before = progress_of(counts);
    before.is_narrowed = true;
  }
  return true;
}

}  // namespace stereotlm::explore
