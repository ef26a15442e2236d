#include "models/decision_point.h"

#include <utility>

namespace stereotlm {
namespace {

// Returns the first DecisionPoint below these objects; null if there is none.
DecisionPoint* first_below(const std::vector<sc_core::sc_object*>& objects) {
  for (sc_core::sc_object* const object : objects) {
    if (auto* const point = dynamic_cast<DecisionPoint*>(object)) return point;
    if (DecisionPoint* const point = first_below(object->get_child_objects())) return point;
  }
  return nullptr;
}

}  // namespace

DecisionPoint::DecisionPoint(const sc_core::sc_module_name& name, std::function<void()> decide)
    : sc_module(name), decide_(std::move(decide)) {
  SC_HAS_PROCESS(DecisionPoint);
  SC_METHOD(decide_when_settled);
  sensitive << settle_;
  dont_initialize();
}

void DecisionPoint::start_of_simulation() { leader_ = first_below(sc_core::sc_get_top_level_objects()); }

void DecisionPoint::request() {
  leader_->requested_.push_back(this);
  leader_->decide_when_settled();
}

void DecisionPoint::decide_when_settled() {
  if (sc_core::sc_pending_activity_at_current_time()) return settle_.notify(sc_core::SC_ZERO_TIME);
  for (DecisionPoint* const point : requested_) point->decide_();
  requested_.clear();
}

}  // namespace stereotlm
