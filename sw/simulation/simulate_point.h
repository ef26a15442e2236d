#pragma once

#include "platform/tables.h"
#include "sw/explore/figures.h"
#include "sw/explore/plan.h"

namespace stereotlm::simulation {

// Simulates points of a plan without pixels, each in a child of this process.
class PointSimulator {
 public:
  // Throws std::runtime_error with what the run has ended with.
  explore::Figures operator()(const explore::Point& point);

 private:
  // Of the last point; most have the same.
  platform::Tables tables_;
};

}  // namespace stereotlm::simulation
