#pragma once

#include <algorithm>
#include <deque>
#include <string>
#include <systemc>
#include <tlm>

#include "models/access_text.h"

namespace stereotlm {

// The accesses whose processes wait in b_transport of a target. The target serves one at a time, in the order
// of their arrival. A process that is killed or reset while it waits leaves the queue, and an
// SC_REPORT_WARNING of type /stereotlm/lost_access names its access.
class AccessQueue {
 public:
  // `target`: the module or socket that serves the accesses; it outlives this object.
  explicit AccessQueue(const sc_core::sc_object& target) : target_(target) {}

  // The place of an access, on the stack of its process.
  class Place {
   public:
    Place(AccessQueue& queue, const tlm::tlm_generic_payload& access) : queue_(queue), access_(access) {}
    ~Place() {
      auto& places = queue_.places_;
      if (const auto place = std::find(places.begin(), places.end(), this); place != places.end()) {
        places.erase(place);
        queue_.next_turn_.notify(sc_core::SC_ZERO_TIME);
      }
      if (!has_ended_ && done_ < access_.get_data_length()) report();
    }
    Place(const Place&) = delete;
    Place& operator=(const Place&) = delete;

    // Waits until the time of the access, and sets `delay` to 0.
    void await_time(sc_core::sc_time& delay) const {
      if (delay != sc_core::SC_ZERO_TIME) sc_core::wait(delay);
      delay = sc_core::SC_ZERO_TIME;
    }
    // Arrives, and waits until all accesses that arrived earlier have left.
    void await_turn() {
      queue_.places_.push_back(this);
      while (queue_.places_.front() != this) sc_core::wait(queue_.next_turn_);
    }
    // The number of bytes that have been transferred. A process that ends after all of them loses nothing.
    void set_done(unsigned bytes) { done_ = bytes; }
    // The access has its response.
    void end() { has_ended_ = true; }

   private:
    void report() const {
      const std::string text = std::string(queue_.target_.name()) + ": " + access_text(access_) +
                               " is lost: kill(), reset() or an exception has taken its process " +
                               sc_core::sc_get_current_process_handle().name() + " out of b_transport; " +
                               std::to_string(done_) + " of " + std::to_string(access_.get_data_length()) +
                               " bytes had been transferred";
      try {
        SC_REPORT_WARNING("/stereotlm/lost_access", text.c_str());
      } catch (const sc_core::sc_report& report) {
        // Nothing may be thrown while SystemC ends a process. Where the warning is set to throw, it stops the
        // simulation instead.
        sc_core::sc_report_handler::default_handler(report, sc_core::SC_DISPLAY | sc_core::SC_STOP);
      }
    }

    AccessQueue& queue_;
    const tlm::tlm_generic_payload& access_;
    unsigned done_ = 0;  // bytes
    bool has_ended_ = false;
  };

 private:
  const sc_core::sc_object& target_;
  std::deque<Place*> places_;  // in the order of arrival; the first one is served
  sc_core::sc_event next_turn_;
};

}  // namespace stereotlm
