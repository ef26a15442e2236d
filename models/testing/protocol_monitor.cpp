#include "models/testing/protocol_monitor.h"

#include <algorithm>
#include <utility>

#include "models/kernel_time.h"
#include "models/testing/failure.h"

namespace stereotlm::test {
namespace {

using Payload = tlm::tlm_generic_payload;

constexpr std::size_t kViolationsKept = 100;

// Keeps a counted payload alive while the monitor needs it. It leaves a count of 0 alone: its release would
// free a payload that the initiator never acquired.
class Hold {
 public:
  explicit Hold(Payload& payload)
      : payload_(payload.has_mm() && payload.get_ref_count() > 0 ? &payload : nullptr) {
    if (payload_ != nullptr) payload_->acquire();
  }
  ~Hold() {
    if (payload_ != nullptr) payload_->release();
  }
  Hold(const Hold&) = delete;
  Hold& operator=(const Hold&) = delete;
  // References apart from this one; 0 without a memory manager.
  int others() const { return payload_ == nullptr ? 0 : payload_->get_ref_count() - 1; }

 private:
  Payload* payload_;
};

// Lists a call while it is in progress, also if the callee throws. Calls of other processes may end first.
template <typename Item>
class Listed {
 public:
  Listed(std::vector<Item>& list, Item item) : list_(list), item_(item) { list_.push_back(item); }
  ~Listed() { list_.erase(std::find(list_.begin(), list_.end(), item_)); }
  Listed(const Listed&) = delete;
  Listed& operator=(const Listed&) = delete;

 private:
  std::vector<Item>& list_;
  Item item_;
};

using Process = const sc_core::sc_process_b*;
Process this_process() { return sc_core::sc_get_current_process_b(); }
bool contains(const std::vector<Process>& list) {
  return std::find(list.begin(), list.end(), this_process()) != list.end();
}

// The time and delta cycle of a call that must not wait.
struct Moment {
  sc_core::sc_time time = sc_core::sc_time_stamp();
  sc_dt::uint64 delta = sc_core::sc_delta_count();
  bool passed() const { return time != sc_core::sc_time_stamp() || delta != sc_core::sc_delta_count(); }
};

bool in_method_process() {
  const sc_core::sc_process_b* process = sc_core::sc_get_current_process_b();
  return process != nullptr && process->proc_kind() == sc_core::SC_METHOD_PROC_;
}

// The monitors that exist. It is never destroyed, because a monitor may be a static object.
std::vector<ProtocolMonitor*>& monitors() {
  static auto* const all = new std::vector<ProtocolMonitor*>;
  return *all;
}

}  // namespace

ProtocolMonitor::ProtocolMonitor(const sc_core::sc_module_name& name, const ProtocolOptions& options)
    : sc_module(name), options_(options), phases_(options) {
  from_initiator.bind(*this);
  to_target.bind(*this);
  monitors().push_back(this);
}

ProtocolMonitor::~ProtocolMonitor() {
  monitors().erase(std::find(monitors().begin(), monitors().end(), this));
  fail_all();
}

void ProtocolMonitor::fail_all() {
  if (std::exchange(options_.all_end, false)) {  // an open access fails once
    for (const auto& [payload, process, address, begin] : blocking_)
      report("b_transport", open_problem(address, begin));
    report("nb_transport", phases_.open_problems());
  }
  for (const std::string& violation : take_violations()) fail(violation);
}

void ProtocolMonitor::fail_at_end() {
  for (ProtocolMonitor* const monitor : monitors()) monitor->fail_all();
}

std::vector<std::string> ProtocolMonitor::take_violations() { return std::exchange(violations_, {}); }

void ProtocolMonitor::b_transport(Payload& payload, sc_core::sc_time& delay) {
  constexpr const char* kCall = "b_transport";
  if (in_method_process()) report(kCall, "called from a method process: the callee may wait (11.1.1.4 b)");
  if (payload.has_mm() && payload.get_ref_count() == 0) {
    report(kCall, "reference count = 0: the initiator must acquire a managed transaction (14.5 t)");
  }
  if (contains(forward_) || contains(backward_))
    report(kCall, "called within nb_transport: not permitted (11.1.2.4 f)");
  if (phases_.in_progress(payload) || in_b_transport(payload)) {
    report(kCall, "the transaction is already in progress on this link (15.2.10 c)");
  }
  report(kCall, request_problems(payload, options_));

  const PayloadSnapshot sent(payload);
  const sc_core::sc_time start = sc_core::sc_time_stamp() + delay;
  const Listed<Blocking> listed(blocking_, {&payload, this_process(), sent.address(), start});
  const bool managed = payload.has_mm();
  const Hold hold(payload);
  const int references = hold.others();
  to_target->b_transport(payload, delay);

  if (!managed && payload.has_mm()) {
    report(kCall, "memory manager set: what has set it must remove it before it returns (14.5 j)");
  }
  if (hold.others() < references) {
    report(kCall, "reference count fell: the target released more than it acquired (14.5)");
  }
  if (sc_core::sc_time_stamp() + delay < start) {
    report(kCall, "time fell from " + kernel_time::text_of(start) + " to " +
                      kernel_time::text_of(sc_core::sc_time_stamp() + delay) +
                      ": a callee must not take back time (15.2.7 d)");
  }
  report(kCall, sent.changes(payload, options_));
  report(kCall, response_problems(payload, options_));
}

tlm::tlm_sync_enum ProtocolMonitor::nb_transport_fw(Payload& payload, tlm::tlm_phase& phase,
                                                    sc_core::sc_time& delay) {
  constexpr const char* kCall = "nb_transport_fw";
  if (phase == tlm::BEGIN_REQ && in_b_transport(payload)) {
    report(kCall, "the transaction is already in progress on this link (15.2.10 c)");
  }
  check_non_blocking(kCall, payload);
  const Moment moment;
  const PhaseTracker::Call call{phase, sc_core::sc_time_stamp() + delay};
  if (contains(backward_)) report(kCall, "called within nb_transport_bw: not permitted (11.1.2.4 c)");
  report(kCall, phases_.forward_call(payload, call));
  const Listed<Process> listed(forward_, this_process());
  const Hold hold(payload);
  const auto status = to_target->nb_transport_fw(payload, phase, delay);
  if (moment.passed()) report(kCall, "time passed: a non-blocking callee must not wait (11.1.2.4)");
  report(kCall, phases_.forward_return(payload, call, {phase, sc_core::sc_time_stamp() + delay}, status));
  return status;
}

tlm::tlm_sync_enum ProtocolMonitor::nb_transport_bw(Payload& payload, tlm::tlm_phase& phase,
                                                    sc_core::sc_time& delay) {
  constexpr const char* kCall = "nb_transport_bw";
  check_non_blocking(kCall, payload);
  const Moment moment;
  const PhaseTracker::Call call{phase, sc_core::sc_time_stamp() + delay};
  if (contains(forward_)) report(kCall, "called within nb_transport_fw: not permitted (11.1.2.4 c)");
  if (std::any_of(blocking_.begin(), blocking_.end(),
                  [](const Blocking& other) { return std::get<Process>(other) == this_process(); }))
    report(kCall, "called within b_transport: not permitted (11.1.1.4 j)");
  report(kCall, phases_.backward_call(payload, call));
  const Listed<Process> listed(backward_, this_process());
  const Hold hold(payload);
  const auto status = from_initiator->nb_transport_bw(payload, phase, delay);
  if (moment.passed()) report(kCall, "time passed: a non-blocking callee must not wait (11.1.2.4)");
  report(kCall, phases_.backward_return(payload, call, {phase, sc_core::sc_time_stamp() + delay}, status));
  return status;
}

bool ProtocolMonitor::get_direct_mem_ptr(Payload& payload, tlm::tlm_dmi& dmi) {
  constexpr const char* kCall = "get_direct_mem_ptr";
  report(kCall, dmi_request_problems(payload, dmi));
  const PayloadSnapshot sent(payload, false, false);
  const Moment moment;
  const bool granted = to_target->get_direct_mem_ptr(payload, dmi);
  if (moment.passed()) report(kCall, "time passed: the callee must not wait (11.2.4)");
  report(kCall, sent.changes(payload, options_));
  report(kCall, dmi_answer_problems(payload, sent.address(), granted, dmi));
  return granted;
}

unsigned int ProtocolMonitor::transport_dbg(Payload& payload) {
  constexpr const char* kCall = "transport_dbg";
  report(kCall, debug_request_problems(payload));
  const PayloadSnapshot sent(payload, true, payload.get_gp_option() != tlm::TLM_MIN_PAYLOAD);
  const Moment moment;
  const unsigned int bytes = to_target->transport_dbg(payload);
  if (moment.passed()) report(kCall, "time passed: the callee must not wait (11.3.4)");
  report(kCall, sent.changes(payload, options_));
  report(kCall, debug_answer_problems(payload, bytes));
  return bytes;
}

void ProtocolMonitor::invalidate_direct_mem_ptr(sc_dt::uint64 start, sc_dt::uint64 end) {
  if (start > end) report("invalidate_direct_mem_ptr", "the range ends before it starts (11.2.7)");
  from_initiator->invalidate_direct_mem_ptr(start, end);
}

bool ProtocolMonitor::in_b_transport(const Payload& payload) const {
  return std::any_of(blocking_.begin(), blocking_.end(),
                     [&payload](const Blocking& call) { return std::get<const Payload*>(call) == &payload; });
}

void ProtocolMonitor::check_non_blocking(const char* call, const Payload& payload) {
  if (!payload.has_mm()) {
    report(call, "no memory manager: a non-blocking transaction must be reference counted (14.5 i)");
  } else if (payload.get_ref_count() == 0) {
    report(call, "reference count = 0: the initiator must acquire a managed transaction (14.5 t)");
  }
}

void ProtocolMonitor::report(const char* call, const Problems& problems) {
  for (const auto& problem : problems) report(call, problem);
}

void ProtocolMonitor::report(const char* call, const std::string& problem) {
  if (violations_.size() == kViolationsKept) return;
  violations_.push_back(std::string(name()) + " at " + kernel_time::text_of(sc_core::sc_time_stamp()) + ": " +
                        call + ": " + problem);
}

}  // namespace stereotlm::test
