#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <string>
#include <systemc>
#include <tlm>

#include "models/access_text.h"

namespace stereotlm {

// The accesses whose processes wait in b_transport of a target. The target serves one at a time, in the order
// of their arrival. If a process is killed or reset while it waits, its access leaves the queue, and is
// reported by an SC_REPORT_WARNING of type /stereotlm/lost_access.
class AccessQueue {
 public:
  // `target`: the module or socket that serves the accesses; it outlives this object.
  explicit AccessQueue(const sc_core::sc_object& target) : target_(target) {}

  // Waits until the time of the access, sets `delay` to 0, waits until all accesses that arrived earlier have
  // left, and calls `serve`, which may wait. If the process is killed or reset in `serve`, calls `drop`. This
  // forgets the access, and returns the number of its bytes that have been transferred.
  template <typename Serve, typename Drop>
  void serve(const tlm::tlm_generic_payload& access, sc_core::sc_time& delay, const Serve& serve,
             const Drop& drop) {
    const std::uint64_t place = arrived_++;
    bool is_served = false;
    try {
      if (delay != sc_core::SC_ZERO_TIME) sc_core::wait(delay);
      delay = sc_core::SC_ZERO_TIME;
      places_.push_back(place);
      while (places_.front() != place) sc_core::wait(next_turn_);
      is_served = true;
      serve();
    } catch (...) {
      const unsigned done = is_served ? drop() : 0;
      leave(place);
      if (done < access.get_data_length()) report_lost(access, done);
      throw;
    }
    leave(place);
  }

 private:
  void leave(std::uint64_t place) {
    places_.erase(std::remove(places_.begin(), places_.end(), place), places_.end());
    if (!places_.empty()) next_turn_.notify(sc_core::SC_ZERO_TIME);
  }
  void report_lost(const tlm::tlm_generic_payload& access, unsigned done) const {
    const std::string text = std::string(target_.name()) + ": " + access_text(access) +
                             " is lost: kill(), reset() or an exception has taken its process " +
                             sc_core::sc_get_current_process_handle().name() + " out of b_transport; " +
                             std::to_string(done) + " of " + std::to_string(access.get_data_length()) +
                             " bytes had been transferred";
    try {
      SC_REPORT_WARNING("/stereotlm/lost_access", text.c_str());
    } catch (const sc_core::sc_report& report) {
      // Nothing may be thrown while SystemC ends a process. Where the warning is set to throw, it stops the
      // simulation instead.
      sc_core::sc_report_handler::default_handler(report, sc_core::SC_DISPLAY | sc_core::SC_STOP);
    }
  }

  const sc_core::sc_object& target_;
  std::uint64_t arrived_ = 0;
  std::deque<std::uint64_t> places_;  // in the order of arrival; the first one is served
  sc_core::sc_event next_turn_;
};

}  // namespace stereotlm
