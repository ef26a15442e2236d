#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

#include "sw/explore/plan/figures.h"
#include "sw/explore/plan/points.h"
#include "sw/explore/store/database.h"
#include "sw/explore/sweep/sweep_counts.h"

namespace stereotlm::explore {

// Thrown by Evaluate where nobody wants to know how a point ends any more. Nothing of it is kept.
struct GivenUp {};

// Simulates a point that has a board. Called in worker processes, which are forked from this one; what it
// throws is the reason for which the point has failed. But std::system_error ends the sweep: it is the
// machine that lacks something; and EndedBySignal and std::bad_alloc count as the end of the worker.
using Evaluate = std::function<Figures(const Point& point)>;

struct SweepOptions {
  std::string store;        // file, continued if it is there
  std::string version;      // of the program
  std::string known;        // another store, which is only read: its points are not run either; empty: none
  unsigned jobs = 1;        // worker processes
  std::uint64_t shard = 0;  // does the points whose number modulo `shards` is this
  std::uint64_t shards = 1;
  std::chrono::milliseconds busy_timeout = Database::kBusyTimeout;  // with who keeps the store locked
};

// All points that the stores do not have. `keep_going` is called several times a second with what is done of
// this shard; once it returns false no further point is begun. At the end the store is put into its final
// form, whose bytes depend on nothing but its points (merge_stores()). A point whose worker dies is begun
// again, and is one that has failed when it has died kMostDeaths times, with a reason that says how to try
// again. Throws DatabaseError, also if another sweep is at work on the store, and std::runtime_error; all
// points that were finished are kept. Throws StoreGone (store_lock.h) once the file of the store has gone,
// ConditionError (conditions.h) if a condition cannot be computed for a point. Throws also if the limit on
// open files is too low for the workers, see workers_with_files().
inline constexpr int kMostDeaths = 3;
SweepCounts sweep(const Points& points, const Evaluate& evaluate, const SweepOptions& options,
                  const std::function<bool(const SweepCounts& counts)>& keep_going);

// How many workers the limit on open files leaves room for; `workers` at most.
std::uint64_t workers_with_files(std::uint64_t workers);

}  // namespace stereotlm::explore
