#pragma once

#include <string>
#include <systemc>
#include <tlm>

#include "models/access_rules.h"
#include "models/access_text.h"

namespace stereotlm {

// Says why a target refuses an access: once, by SC_REPORT_WARNING of type /stereotlm/refused_access, because
// an initiator that makes one wrong access mostly makes many. To leave these reports out:
//
//   sc_core::sc_report_handler::set_actions("/stereotlm/refused_access", sc_core::SC_DO_NOTHING);
class Refusals {
 public:
  // `target`: the module or socket that refuses; it outlives this object.
  explicit Refusals(const sc_core::sc_object& target) : target_(target) {}

  // Reports the access, unless one has been reported before. `rule`: the one that it breaks.
  void report(const tlm::tlm_generic_payload& access, const char* rule) {
    if (has_reported_) return;
    has_reported_ = true;
    const std::string text = std::string(target_.name()) + ": " + access.get_response_string() + " for " +
                             access_text(access) + ": " + rule + "; later refusals are not reported";
    SC_REPORT_WARNING("/stereotlm/refused_access", text.c_str());
  }
  // Gives the access its response. Returns whether that is TLM_OK_RESPONSE, and reports the access if not.
  // `rules`: those of the target; `other`: what the access breaks if it keeps them.
  bool respond(tlm::tlm_generic_payload& access, tlm::tlm_response_status status, const AccessRules& rules,
               const char* other = "") {
    access.set_response_status(status);
    if (status == tlm::TLM_OK_RESPONSE) return true;
    const BrokenRule broken = broken_rule(access, rules);
    report(access, broken.response == tlm::TLM_OK_RESPONSE ? other : broken.text);
    return false;
  }

 private:
  const sc_core::sc_object& target_;
  bool has_reported_ = false;
};

}  // namespace stereotlm
