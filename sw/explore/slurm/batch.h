#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>

#include "sw/explore/plan/points.h"
#include "sw/explore/store/stored_row.h"
#include "sw/explore/sweep/sweep.h"
#include "sw/files/temporary_folder.h"

namespace stereotlm::explore {

// The run of a point has failed: what() names its board and the reason.
class PointFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Simulates points on several processors, with a database of its own in a folder for temporary files, which
// goes when the batch does.
class Batch {
 public:
  // Throws std::runtime_error if there can be no folder.
  Batch() : path_((folder_.path() / "points.db").string()) {}

  // As sweep(). False if `keep_going` has ended it.
  bool run(const Points& points, const Evaluate& evaluate, const std::string& version, unsigned jobs,
           const std::function<bool(const SweepCounts& counts)>& keep_going);

  // The database, after run().
  const std::string& path() const { return path_; }
  // Of a point that was simulated; until the next call. Throws PointFailed, and std::runtime_error if it was
  // not simulated.
  const StoredRow& row_of(const Point& point);

 private:
  files::TemporaryFolder folder_;
  std::string path_;
  std::unique_ptr<StoredRow> row_;
};

}  // namespace stereotlm::explore
