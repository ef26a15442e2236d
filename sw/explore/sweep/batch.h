#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>

#include "sw/explore/plan/points.h"
#include "sw/explore/store/store_reader.h"
#include "sw/explore/sweep/sweep.h"
#include "sw/files/temporary_folder.h"

namespace stereotlm::explore {

// The run of a point failed. what() names its board and the reason.
class PointFailed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Simulates a few points on several processors, for `explain` and `paper`. The results are in a database in a
// temporary folder, which is removed when the batch is destroyed.
class Batch {
 public:
  // Throws std::runtime_error if the folder cannot be made.
  Batch() : path_((folder_.path() / "points.db").string()) {}

  // Runs sweep(). Returns false if `keep_going` has ended the sweep. May be called again with further points.
  bool run(const Points& points, const Evaluate& evaluate, const std::string& version, unsigned jobs,
           const std::function<bool(const SweepCounts& counts)>& keep_going);

  // The path of the database, which exists after run().
  const std::string& path() const { return path_; }
  // The results of a point, valid until the next call. Throws PointFailed, and std::runtime_error if the
  // point was not simulated.
  const StoredRow& row_of(const Point& point);

 private:
  files::TemporaryFolder folder_;
  std::string path_;
  std::unique_ptr<StoredRow> row_;
};

}  // namespace stereotlm::explore
