#pragma once

#include <cstdint>
#include <systemc>

#include "models/kernel_time.h"
#include "models/time_ps.h"

namespace stereotlm {

// The event of a module whose control (plain C++) names the time of its next step.
class StepEvent : public sc_core::sc_event {
 public:
  explicit StepEvent(const char* name) : sc_event(name) {}  // of a module, for its process

  // Notifies the event at `next_ps`, which must not be in the past, and at no other time; kNever: not at all.
  // To be called after each call of the control.
  void set(std::uint64_t next_ps) {
    if (next_ps == next_ps_) return;
    next_ps_ = next_ps;
    cancel();
    if (next_ps != kNever) notify(kernel_time::to_time(next_ps - kernel_time::now_ps()));
  }
  // To be called when the event has started its process, before the control's step.
  void taken() { next_ps_ = kNever; }

 private:
  std::uint64_t next_ps_ = kNever;
};

}  // namespace stereotlm
