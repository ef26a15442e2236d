#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

#include "sw/explore/plan/points.h"
#include "sw/explore/store/store.h"
#include "sw/files/aside.h"
#include "sw/process/command.h"
#include "sw/sqlite/database.h"

namespace stereotlm::explore {

// Numbers of points: the progress of a sweep, or of one shard.
struct SweepCounts {
  std::uint64_t total = 0;     // before conditions
  std::uint64_t excluded = 0;  // left out by conditions
  std::uint64_t known = 0;     // not simulated: a store has the point, or an equal point came before
  std::uint64_t ok = 0;
  std::uint64_t impossible = 0;
  std::uint64_t failed = 0;
  std::uint64_t given_up = 0;  // see GivenUp; not stored

  std::uint64_t done() const { return excluded + known + ok + impossible + failed + given_up; }
  void add(const SweepCounts& other);
};

// One line for each number, such as "ok 12".
std::string counts_text(const SweepCounts& counts);
// Reads the lines of counts_text(). A number without a line is 0.
SweepCounts read_counts(const std::string& text);

// An Evaluate function throws GivenUp if the result of the point is no longer needed. The sweep then stores
// nothing about the point.
struct GivenUp {};

// A function that simulates a point that has a board. It is called in worker processes, which are forked from
// this one. If it throws an exception, the point has failed, and the text of the exception is the reason.
// Some exceptions have another meaning: GivenUp; std::system_error, which ends the sweep, because the machine
// lacks something; process::ChildDied of a signal and std::bad_alloc, which count as the death of the worker.
using Evaluate = std::function<Figures(const Point& point)>;

struct SweepOptions {
  std::string store;  // path; an existing store is continued
  std::string version = process::kVersion;
  std::string known;  // path of a store that is only read; its points are not simulated; empty: none
  unsigned jobs = std::max(1U, std::thread::hardware_concurrency());  // worker processes
  std::uint64_t shard = 0;  // 0..shards-1: only the points whose number modulo `shards` is this
  std::uint64_t shards = 1;
  std::chrono::milliseconds busy_timeout =
      sqlite::Database::kBusyTimeout;  // wait for processes that lock the store
};

// The number of deaths of its worker after which a point counts as failed.
inline constexpr int kMostDeaths = 3;

// Simulates all points that the stores do not have. `keep_going` is called several times a second with the
// progress. After it has returned false, no further point is begun, and those that do not end within a second
// are given up. At the end merge_stores() gives the store its final form, whose bytes depend only on its
// points. A point whose worker dies is begun again. After kMostDeaths deaths it counts as failed, and the
// reason in its row says how to try it again. Throws DatabaseError, also if another sweep uses the store;
// StoreGone once the file of the store is gone; ConditionError if a condition cannot be computed for a point;
// std::runtime_error, also if the limit on open files is too low for the workers. Except after StoreGone, all
// finished points are in the store.
SweepCounts sweep(const Points& points, const Evaluate& evaluate, const SweepOptions& options,
                  const std::function<bool(const SweepCounts& counts)>& keep_going);

// The number of workers that the limit on open files allows, at most `workers`.
std::uint64_t workers_with_files(std::uint64_t workers);

}  // namespace stereotlm::explore
