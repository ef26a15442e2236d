#pragma once

#include <functional>
#include <systemc>
#include <vector>

namespace stereotlm {

// Makes a decision, such as the arbitration of the bus, when nothing else is pending at the current time. The
// decision thus sees everything that happens at that time, in whatever delta cycle.
//
// Two processes that both wait until nothing else is pending would wait for each other. The process of one
// DecisionPoint, the first in the module hierarchy, therefore serves all DecisionPoints of a simulation.
class DecisionPoint : public sc_core::sc_module {
 public:
  // `decide` makes the decision.
  DecisionPoint(const sc_core::sc_module_name& name, std::function<void()> decide);

  // Requests the decision at the current time. To be called from a method process.
  void request();

 private:
  void start_of_simulation() override;
  void decide_when_settled();

  std::function<void()> decide_;
  DecisionPoint* leader_ = this;           // the DecisionPoint whose process serves this one
  std::vector<DecisionPoint*> requested_;  // of the leader: the points that have requested a decision
  sc_core::sc_event settle_{"settle"};
};

}  // namespace stereotlm
