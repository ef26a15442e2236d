#pragma once

#include <systemc>

namespace stereotlm {

// A level-sensitive interrupt line (INTA#), as its receiver sees it. The level is that of the sender's
// registers at any moment: an access that changes it has changed it before anything can look at the line,
// where an sc_signal would still show the old level for a delta cycle. To drive a signal from it, use a method
// process that is sensitive to changed_event().
class InterruptIf : public virtual sc_core::sc_interface {
 public:
  virtual bool is_asserted() const = 0;
  // Notified in the delta cycle after the level may have changed.
  virtual const sc_core::sc_event& changed_event() const = 0;
};

// The sockets of a line: `cpu.interrupts[0].bind(device.interrupt)`.
using InterruptIn = sc_core::sc_port<InterruptIf>;
using InterruptOut = sc_core::sc_export<InterruptIf>;

}  // namespace stereotlm
