#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <utility>

#include "models/memory/arbitration_policy.h"

namespace stereotlm::memory {

// Memo of an arbitration policy for BankArbiter: one row for each state that was reached.
class DecisionTable {
 public:
  struct Row;
  struct Decision {
    Row* if_granted = nullptr;  // the next state if the winner is granted
    Row* if_refused = nullptr;  // the next state if the bank is turning round
    std::size_t winner = 0;     // index of the port

    bool is_known() const { return if_granted != nullptr; }
  };
  struct Row {
    ArbitrationPolicy::State state = 0;
    Row* after_idle = nullptr;  // the next state after a cycle without request
    std::array<Decision, std::size_t{1} << kMostPorts> decisions;  // [mask of requests]; see fill()

    // The row after some cycles without request.
    Row& after_idle_cycles(std::uint64_t cycles);
  };

  explicit DecisionTable(std::unique_ptr<const ArbitrationPolicy> policy) : policy_(std::move(policy)) {}

  // Returns the row of a state, which is added if there is none. Rows are never moved or removed.
  Row& row_of(ArbitrationPolicy::State state);
  // Computes row.decisions[requests] if it is not known. `requests` has at least one port.
  void fill(Row& row, PortMask requests);

 private:
  std::unique_ptr<const ArbitrationPolicy> policy_;
  std::unordered_map<ArbitrationPolicy::State, Row> rows_;
};

}  // namespace stereotlm::memory
