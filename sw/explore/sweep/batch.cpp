#include "sw/explore/sweep/batch.h"

#include <fmt/format.h>

#include <stdexcept>

namespace stereotlm::explore {

bool Batch::run(const Points& points, const Evaluate& evaluate, const std::string& version, unsigned jobs,
                const std::function<bool(const SweepCounts& counts)>& keep_going) {
  SweepOptions options;
  options.store = path_;
  options.version = version;
  options.jobs = jobs;
  row_.reset();
  const SweepCounts counts = sweep(points, evaluate, options, keep_going);
  return counts.done() == counts.total;
}

const StoredRow& Batch::row_of(const Point& point) {
  if (!row_) row_ = std::make_unique<StoredRow>(path_);
  StoredRow& row = *row_;
  if (!row.find(point.hash))
    throw std::runtime_error(fmt::format("point {} was not simulated", point.number));
  if (row.text("status") != "ok") {
    throw PointFailed(fmt::format("{}: {}", point.board->name, row.text("reason")));
  }
  return row;
}

}  // namespace stereotlm::explore
