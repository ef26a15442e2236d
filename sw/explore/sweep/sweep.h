#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

#include "sw/explore/plan/figures.h"
#include "sw/explore/plan/points.h"
#include "sw/explore/store/database.h"

namespace stereotlm::explore {

// Numbers of points: the progress of a sweep, or of one shard.
struct SweepCounts {
  std::uint64_t total = 0;     // before conditions
  std::uint64_t excluded = 0;  // left out by conditions
  std::uint64_t known = 0;     // not simulated: a store has the point, or an equal point came before
  std::uint64_t ok = 0;
  std::uint64_t impossible = 0;
  std::uint64_t failed = 0;
  std::uint64_t given_up = 0;  // nothing of them is stored

  std::uint64_t done() const { return excluded + known + ok + impossible + failed + given_up; }
  void add(const SweepCounts& other);
};

// One line for each number, such as "ok 12".
std::string counts_text(const SweepCounts& counts);
// Reads the lines of counts_text(). A number without a line is 0.
SweepCounts read_counts(const std::string& text);

// Evaluate throws it where the result of a point is no longer needed. The sweep stores nothing of the point.
struct GivenUp {};

// Simulates a point that has a board. It is called in worker processes, which are forked from this one. The
// text of an exception that it throws is the reason for which the point has failed. But std::system_error
// ends the sweep, because the machine lacks something, and EndedBySignal and std::bad_alloc count as the
// death of the worker.
using Evaluate = std::function<Figures(const Point& point)>;

struct SweepOptions {
  std::string store;        // path; an existing store is continued
  std::string version;      // of the program
  std::string known;        // path of a store, only read, whose points are not simulated; empty: none
  unsigned jobs = 1;        // worker processes
  std::uint64_t shard = 0;  // 0..shards-1: only the points whose number modulo `shards` is this
  std::uint64_t shards = 1;
  std::chrono::milliseconds busy_timeout = Database::kBusyTimeout;  // wait for processes that lock the store
};

// A point whose worker has died so many times has failed.
inline constexpr int kMostDeaths = 3;

// Simulates all points that the stores do not have. `keep_going` is called several times a second with the
// progress; after it has returned false no further point is begun. At the end merge_stores() gives the store
// its final form, whose bytes depend on nothing but its points. A point whose worker dies is begun again; the
// row of one that has failed with kMostDeaths deaths says how to try it again. All finished points stay in
// the store, whatever is thrown: DatabaseError, also if another sweep uses the store; StoreGone
// (store_lock.h) once the file of the store is gone; ConditionError (conditions.h) if a condition cannot be
// computed for a point; std::runtime_error, also if the limit on open files is too low for the workers (see
// workers_with_files()).
SweepCounts sweep(const Points& points, const Evaluate& evaluate, const SweepOptions& options,
                  const std::function<bool(const SweepCounts& counts)>& keep_going);

// The number of workers that the limit on open files allows, at most `workers`.
std::uint64_t workers_with_files(std::uint64_t workers);

}  // namespace stereotlm::explore
