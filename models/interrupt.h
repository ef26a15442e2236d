#pragma once

#include <systemc>

namespace stereotlm {

// A level-sensitive interrupt line (INTA#), as its receiver sees it. The level follows the sender's registers
// immediately: a register access that changes it takes effect before any receiver can poll the line. An
// sc_signal would show the old level for one more delta cycle. To drive a signal from the line, use a method
// process that is sensitive to changed_event().
class InterruptIf : public virtual sc_core::sc_interface {
 public:
  virtual bool is_asserted() const = 0;  // the level of the line, now
  // Notified in the delta cycle after the level may have changed.
  virtual const sc_core::sc_event& changed_event() const = 0;
};

// Sockets of the line: `cpu.interrupts[0].bind(device.interrupt)`.
using InterruptIn = sc_core::sc_port<InterruptIf>;
using InterruptOut = sc_core::sc_export<InterruptIf>;

}  // namespace stereotlm
