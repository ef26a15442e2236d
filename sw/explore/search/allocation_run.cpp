#include "sw/explore/search/allocation_run.h"

#include <fmt/format.h>

#include <stdexcept>
#include <vector>

#include "sw/explore/plan/points.h"
#include "sw/explore/store/database.h"

namespace stereotlm::explore {
namespace {

// Records the results of some boards in the search. Reads them from the database. The sweep has given up a
// board that is not in the database.
void record_outcomes(const std::vector<std::size_t>& numbers, const std::string& path,
                     AllocationSearch& search) {
  Database store(path, Database::Access::kRead);
  Statement find(
      store,
      search.run().camera
          ? "SELECT status, reason, cycles, \"frames_per_second.system\", \"frames_per_second.steady\", "
            "\"cameras.left.dropped_pixels\" + \"cameras.right.dropped_pixels\" FROM points WHERE hash = ?"
          : "SELECT status, reason, cycles, \"frames_per_second.core\" FROM points WHERE hash = ?");
  for (const std::size_t number : numbers) {
    const Point point = search.point(number);
    find.bind(1, point.hash);
    if (!find.step()) {
      search.record_given_up(number);
      find.reset();
      continue;
    }
    AllocationOutcome outcome;
    if (find.text(0) != "ok") {
      outcome.failure = find.text(1);
      search.record(number, outcome);
      find.reset();
      continue;
    }
    const auto behind_last_write = static_cast<std::uint64_t>(point.board->fpga.pipeline_latency_cycles);
    outcome.cycles = static_cast<std::uint64_t>(find.integer(2)) + point.run.frames * behind_last_write;
    outcome.frames_per_second = find.real(3);
    if (search.run().camera) {
      outcome.steady = find.real(4);
      outcome.loses_pixels = find.integer(5) > 0;
    }
    search.record(number, outcome);
    find.reset();
  }
}

}  // namespace

bool simulate(AllocationSearch& search, const Evaluate& evaluate, const SweepOptions& sweep,
              const std::function<bool(std::uint64_t done, std::uint64_t most_left)>& keep_going) {
  std::uint64_t before = 0;
  for (auto numbers = search.next(); !numbers.empty(); numbers = search.next()) {
    const std::uint64_t left = search.most_left();
    const auto counts = explore::sweep(
        AllocationPoints(search, numbers), evaluate, sweep,
        [&](const SweepCounts& done) { return keep_going(before + done.done(), left - done.done()); });
    if (counts.done() < counts.total) return false;
    record_outcomes(numbers, sweep.store, search);
    before += numbers.size();
  }
  return true;
}

}  // namespace stereotlm::explore
