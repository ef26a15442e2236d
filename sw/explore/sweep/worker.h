#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "sw/explore/plan/points.h"
#include "sw/explore/store/store.h"
#include "sw/explore/sweep/claims.h"
#include "sw/explore/sweep/sweep.h"
#include "sw/process/child_process.h"
#include "sw/process/shared_memory.h"

namespace stereotlm::explore {

// What the workers of a sweep have in common.
struct SweepState {
  const Points& points;
  const Evaluate& evaluate;
  const SweepOptions& options;
  Claims claims;                // number i is point number shard + i * shards
  process::SharedLock writing;  // of the store, because SQLite's own wait polls every few milliseconds

  std::uint64_t number_of(std::uint64_t claim) const { return options.shard + claim * options.shards; }
};

// The row to store for a point that has failed.
StoredPoint failed_point(const Point& point, const std::string& reason);

// A process that begins points until none is left, simulates and stores them. It ends at the latest when this
// process ends.
class Worker {
 public:
  // Forks. Throws std::system_error.
  Worker(SweepState& state, std::size_t place);

  int descriptor() const { return error_.read_end(); }  // is readable once wait() would return soon
  // Waits for the end of the process. Returns the way in which it died, such as "ended with signal 9
  // (Killed)", or nullopt if it has ended because no point was left to begin. Throws std::runtime_error with
  // the reason if it had to stop, ConditionError (conditions.h) if a condition was the reason.
  std::optional<std::string> wait();

 private:
  process::Pipe error_;  // why the worker had to stop: an ErrorKind, and the text
  process::ChildProcess process_;
};

}  // namespace stereotlm::explore
