#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "sw/explore/figures.h"
#include "sw/explore/points.h"

namespace stereotlm::explore {

// Thrown by Evaluate where nobody wants to know how a point ends any more. Nothing of it is kept.
struct GivenUp {};

// Simulates a point that has a board. Called in worker processes, which are forked from this
// one; what it throws is the reason for which the point has failed.
using Evaluate = std::function<Figures(const Point& point)>;

struct SweepOptions {
  std::string store;        // file, continued if it is there
  std::string version;      // of the program
  unsigned jobs = 1;        // worker processes
  std::uint64_t shard = 0;  // does the points whose number modulo `shards` is this
  std::uint64_t shards = 1;
};

// Points of this shard.
struct SweepCounts {
  std::uint64_t total = 0;     // before conditions
  std::uint64_t excluded = 0;  // by conditions
  std::uint64_t known = 0;     // found in the store: of an earlier sweep, or equal to another point
  std::uint64_t ok = 0;        // these three: new
  std::uint64_t impossible = 0;
  std::uint64_t failed = 0;
  std::uint64_t given_up = 0;

  std::uint64_t done() const { return excluded + known + ok + impossible + failed + given_up; }
  std::uint64_t ran() const { return ok + failed; }
};

// All points that the store does not have. `go_on` is called several times a second with what is done; once
// it returns false no further point is begun. At the end the store is put into its final form, whose bytes
// depend on nothing but its points (merge_stores()). Throws DatabaseError, and std::runtime_error if workers
// keep dying; all points that were finished are kept.
SweepCounts sweep(const Points& points, const Evaluate& evaluate, const SweepOptions& options,
                  const std::function<bool(const SweepCounts& counts)>& go_on);

}  // namespace stereotlm::explore
