#include "models/testing/phase_tracker.h"

#include <sstream>
#include <utility>

#include "models/kernel_time.h"

namespace stereotlm::test {
namespace {

std::string text_of(const tlm::tlm_phase& phase) {
  std::ostringstream text;
  text << phase;
  return text.str();
}

void append(Problems& problems, Problems more) {
  for (auto& problem : more) problems.push_back(std::move(problem));
}

// A phase other than the four of the base protocol may be ignored (15.2.5).
bool is_extended(const tlm::tlm_phase& phase) { return static_cast<unsigned int>(phase) > tlm::END_RESP; }

// Rules for every return of `function`. False if the value is none.
bool check_return(const char* function, tlm::tlm_sync_enum status, const PhaseTracker::Call& call,
                  const PhaseTracker::Call& answer, Problems& problems) {
  if (status != tlm::TLM_ACCEPTED && status != tlm::TLM_UPDATED && status != tlm::TLM_COMPLETED) {
    problems.push_back(std::string(function) + " returned " + std::to_string(status) +
                       ": must be a tlm_sync_enum (11.1.2.7)");
    return false;
  }
  if (status != tlm::TLM_ACCEPTED) return true;
  if (answer.phase != call.phase) {
    problems.push_back("TLM_ACCEPTED with phase " + text_of(answer.phase) + ": must leave the phase, " +
                       text_of(call.phase) + " (11.1.2.7)");
  }
  if (answer.time != call.time) {
    problems.emplace_back("TLM_ACCEPTED with another delay: must leave the delay (11.1.2.7)");
  }
  return true;
}

}  // namespace

Problems PhaseTracker::forward_call(const Payload& payload, const Call& call) {
  Problems problems;
  if (call.phase == tlm::BEGIN_REQ) {
    begin_request(payload, call.time, problems);
    return problems;
  }
  if (is_extended(call.phase)) {
    extended_phase(payload, call, problems);
    return problems;
  }
  if (call.phase != tlm::END_RESP) {
    problems.push_back("phase " + text_of(call.phase) +
                       " on the forward path: only BEGIN_REQ and END_RESP (15.2.3 c)");
    return problems;
  }
  Transaction* transaction = find(payload);
  if (transaction == nullptr || transaction->state != State::kResponse) {
    problems.emplace_back("END_RESP without BEGIN_RESP before it (15.2.4)");
    return problems;
  }
  advance(*transaction, call.time, problems);
  check_unchanged(payload, *transaction, problems);
  finish(payload);
  return problems;
}

Problems PhaseTracker::forward_return(const Payload& payload, const Call& call, const Call& answer,
                                      tlm::tlm_sync_enum status) {
  Problems problems;
  if (!check_return("nb_transport_fw", status, call, answer, problems)) return problems;
  if (is_extended(call.phase)) {
    append(problems, extended_return(payload, answer, status, true));
    return problems;
  }
  if (call.phase == tlm::END_RESP) {
    if (status == tlm::TLM_UPDATED)
      problems.emplace_back("TLM_UPDATED for END_RESP: nothing may follow it (15.2.4)");
    return problems;
  }
  Transaction* transaction = find(payload);
  if (transaction == nullptr) {
    // Calls of nb_transport_bw within this one have ended it, or its phase was refused above.
    if (call.phase == tlm::BEGIN_REQ && status != tlm::TLM_ACCEPTED) {
      problems.emplace_back("a phase returned for a transaction that was complete (15.2.4)");
    }
    return problems;
  }
  if (call.phase != tlm::BEGIN_REQ) return problems;
  check_unchanged(payload, *transaction, problems);
  if (status == tlm::TLM_ACCEPTED) return problems;
  advance(*transaction, answer.time, problems);
  if (status == tlm::TLM_UPDATED) {
    answer_phase(payload, *transaction, answer.phase, problems);
  } else {
    if (response_ != nullptr && response_ != &payload) {
      problems.emplace_back(
          "TLM_COMPLETED before the last response ended: one response at a time (15.2.3 i)");
    }
    append(problems, response_problems(payload, options_));
    finish(payload);
  }
  return problems;
}

Problems PhaseTracker::backward_call(const Payload& payload, const Call& call) {
  Problems problems;
  if (is_extended(call.phase)) {
    extended_phase(payload, call, problems);
    return problems;
  }
  Transaction* transaction = find(payload);
  if (transaction == nullptr) {
    problems.push_back("phase " + text_of(call.phase) +
                       " for a transaction that is not in progress (15.2.4)");
    return problems;
  }
  advance(*transaction, call.time, problems);
  check_unchanged(payload, *transaction, problems);
  answer_phase(payload, *transaction, call.phase, problems);
  return problems;
}

Problems PhaseTracker::backward_return(const Payload& payload, const Call& call, const Call& answer,
                                       tlm::tlm_sync_enum status) {
  Problems problems;
  if (!check_return("nb_transport_bw", status, call, answer, problems)) return problems;
  if (is_extended(call.phase)) {
    append(problems, extended_return(payload, answer, status, false));
    return problems;
  }
  if (call.phase == tlm::END_REQ) {
    if (status != tlm::TLM_ACCEPTED)
      problems.emplace_back("END_REQ: only TLM_ACCEPTED may be returned (15.2.4)");
    return problems;
  }
  Transaction* transaction = find(payload);
  if (call.phase != tlm::BEGIN_RESP || status == tlm::TLM_ACCEPTED) return problems;
  if (transaction == nullptr) {
    problems.emplace_back("a phase returned for a transaction that was complete (15.2.4)");
    return problems;
  }
  if (status == tlm::TLM_UPDATED && is_extended(answer.phase)) {
    advance(*transaction, answer.time, problems);
    check_unchanged(payload, *transaction, problems);
    return problems;
  }
  if (status == tlm::TLM_UPDATED && answer.phase != tlm::END_RESP) {
    problems.push_back("TLM_UPDATED with phase " + text_of(answer.phase) +
                       " for BEGIN_RESP: only END_RESP (15.2.4)");
  }
  advance(*transaction, answer.time, problems);
  check_unchanged(payload, *transaction, problems);
  finish(payload);
  return problems;
}

Problems PhaseTracker::open_problems() const {
  Problems problems;
  for (const auto& [payload, transaction] : transactions_)
    problems.push_back(open_problem(transaction.sent.address(), transaction.begin));
  return problems;
}

PhaseTracker::Transaction* PhaseTracker::find(const Payload& payload) {
  const auto found = transactions_.find(&payload);
  return found == transactions_.end() ? nullptr : &found->second;
}

void PhaseTracker::begin_request(const Payload& payload, const sc_core::sc_time& time, Problems& problems) {
  append(problems, request_problems(payload, options_));
  if (find(payload) != nullptr) {
    problems.emplace_back("BEGIN_REQ for a transaction that is already in progress (15.2.4)");
    finish(payload);
  } else if (request_ != nullptr) {
    problems.emplace_back("BEGIN_REQ before the last request ended: one request at a time (15.2.6 e)");
  }
  transactions_.emplace(&payload, Transaction{State::kRequest, time, time, PayloadSnapshot(payload)});
  request_ = &payload;
}

void PhaseTracker::extended_phase(const Payload& payload, const Call& call, Problems& problems) {
  Transaction* transaction = find(payload);
  if (transaction == nullptr) {
    problems.push_back("phase " + text_of(call.phase) + " outside of BEGIN_REQ to END_RESP (15.2.5 e)");
    return;
  }
  if (transaction->extended == static_cast<unsigned int>(call.phase))
    problems.push_back("phase " + text_of(call.phase) + " twice in succession (15.2.3 e)");
  advance(*transaction, call.time, problems);
  check_unchanged(payload, *transaction, problems);
  transaction->extended = call.phase;
}

Problems PhaseTracker::extended_return(const Payload& payload, const Call& answer, tlm::tlm_sync_enum status,
                                       bool forward) {
  Problems problems;
  Transaction* transaction = find(payload);
  if (transaction == nullptr || status == tlm::TLM_ACCEPTED) return problems;
  if (status == tlm::TLM_COMPLETED) {
    problems.emplace_back("TLM_COMPLETED for an ignorable phase (15.2.3 f)");
    finish(payload);
    return problems;
  }
  advance(*transaction, answer.time, problems);
  check_unchanged(payload, *transaction, problems);
  if (is_extended(answer.phase)) return problems;
  if (forward) {
    answer_phase(payload, *transaction, answer.phase, problems);
  } else if (answer.phase == tlm::END_RESP && transaction->state == State::kResponse) {
    finish(payload);
  } else {
    problems.push_back("TLM_UPDATED with phase " + text_of(answer.phase) + " on the return path (15.2.4)");
  }
  return problems;
}

// END_REQ or BEGIN_RESP, as a call or as a return.
void PhaseTracker::answer_phase(const Payload& payload, Transaction& transaction, const tlm::tlm_phase& phase,
                                Problems& problems) {
  if (is_extended(phase)) return;  // returned with TLM_UPDATED
  transaction.extended = 0;
  if (phase == tlm::END_REQ) {
    if (transaction.state != State::kRequest)
      problems.emplace_back("END_REQ after the request has ended (15.2.4)");
  } else if (phase == tlm::BEGIN_RESP) {
    if (transaction.state == State::kResponse) {
      problems.emplace_back("a second BEGIN_RESP of the same transaction (15.2.4)");
    } else if (response_ != nullptr) {
      problems.emplace_back("BEGIN_RESP before the last response ended: one response at a time (15.2.6 f)");
    }
    append(problems, response_problems(payload, options_));
    transaction.answered.emplace(payload);
  } else {
    problems.push_back("phase " + text_of(phase) +
                       " from the target: only END_REQ and BEGIN_RESP (15.2.3 c)");
    return;
  }
  if (request_ == &payload) request_ = nullptr;
  if (phase == tlm::BEGIN_RESP) {
    transaction.state = State::kResponse;
    response_ = &payload;
  } else if (transaction.state == State::kRequest) {
    transaction.state = State::kRequestEnded;
  }
}

void PhaseTracker::advance(Transaction& transaction, const sc_core::sc_time& time, Problems& problems) const {
  if (time < transaction.time) {
    problems.push_back("time " + kernel_time::text_of(time) + " after " +
                       kernel_time::text_of(transaction.time) +
                       ": a transaction's time must not run backwards (15.2.7 c)");
  }
  transaction.time = time;
}

void PhaseTracker::finish(const Payload& payload) {
  transactions_.erase(&payload);
  if (request_ == &payload) request_ = nullptr;
  if (response_ == &payload) response_ = nullptr;
}

void PhaseTracker::check_unchanged(const Payload& payload, Transaction& transaction,
                                   Problems& problems) const {
  if (transaction.spoilt) return;
  Problems changes = transaction.sent.changes(payload, options_);
  if (changes.empty() && transaction.answered) changes = transaction.answered->changes(payload);
  transaction.spoilt = !changes.empty();
  append(problems, std::move(changes));
}

}  // namespace stereotlm::test
