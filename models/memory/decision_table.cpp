#include "models/memory/decision_table.h"

namespace stereotlm::memory {

DecisionTable::Row& DecisionTable::Row::after_idle_cycles(std::uint64_t cycles) {
  Row* row = this;
  for (; cycles > 0 && row->after_idle != row; --cycles) row = row->after_idle;
  return *row;
}

DecisionTable::Row& DecisionTable::row_of(ArbitrationPolicy::State state) {
  const auto [entry, is_new] = rows_.try_emplace(state);
  Row& row = entry->second;
  if (is_new) {
    row.state = state;
    row.after_idle = &row_of(policy_->next(state, 0, 0));
  }
  return row;
}

void DecisionTable::fill(Row& row, PortMask requests) {
  Decision& decision = row.decisions[requests];
  if (decision.is_known()) return;
  const Port winner = policy_->winner(row.state, requests);
  decision.if_granted = &row_of(policy_->next(row.state, requests, mask_of(winner)));
  decision.if_refused = &row_of(policy_->next(row.state, requests, 0));
  decision.winner = winner;
}

}  // namespace stereotlm::memory
