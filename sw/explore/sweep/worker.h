#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "sw/explore/plan/points.h"
#include "sw/explore/store/store.h"
#include "sw/explore/sweep/sweep.h"
#include "sw/process/child_process.h"
#include "sw/process/shared_state.h"

namespace stereotlm::explore {

// The numbers of the points that a worker is to simulate: first, first + step, and so on, `count` numbers.
struct WorkOrder {
  std::uint64_t first = 0;
  std::uint64_t step = 1;
  std::uint64_t count = 0;
};

// The way in which a point has ended.
enum class PointEnd : std::uint8_t { kExcluded, kKnown, kOk, kImpossible, kFailed, kGivenUp, kNotBegun };

// The row to store for a point that has failed.
StoredPoint failed_point(const Point& point, const std::string& reason);

// A process that simulates points one after another, stores them, and reports how each has ended. It ends at
// the latest when this process ends.
class Worker {
 public:
  // Forks. Throws std::system_error.
  Worker(const Points& points, const Evaluate& evaluate, const SweepOptions& options,
         const process::SharedState& shared);

  void send(const WorkOrder& order);
  // The points that receive() has not returned yet; count 0: the worker is idle.
  const WorkOrder& order() const { return order_; }

  int descriptor() const { return reports_.read_end(); }  // is readable when receive() would not wait
  // Waits for the end of the next point of its order. Returns nothing if the process has died. Throws
  // std::runtime_error with the reason if the worker had to stop, ConditionError (conditions.h) if a
  // condition was the reason.
  std::optional<PointEnd> receive();
  std::string death() const { return death_; }  // "ended with signal 9 (Killed)"

 private:
  process::Pipe orders_;
  process::Pipe reports_;
  process::ChildProcess process_;
  WorkOrder order_;
  std::string death_;
};

}  // namespace stereotlm::explore
