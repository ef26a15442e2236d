#pragma once

#include <string>
#include <systemc>
#include <tlm>

#include "models/access_rules.h"

namespace stereotlm {

// Says why a target refuses an access: once, by SC_REPORT_WARNING of type /stereotlm/refused_access, because
// an initiator that makes one wrong access mostly makes many. To leave these reports out:
//
//   sc_core::sc_report_handler::set_actions("/stereotlm/refused_access", sc_core::SC_DO_NOTHING);
class Refusals {
 public:
  // `target`: the module that refuses; it outlives this object.
  explicit Refusals(const sc_core::sc_object& target) : target_(target) {}

  // Reports the access, unless one has been reported before. `rule`: what the target takes. `socket`: its
  // name in the module, if there are several.
  void report(const tlm::tlm_generic_payload& access, const std::string& rule,
              const std::string& socket = "") {
    if (has_reported_) return;
    has_reported_ = true;
    const std::string target = std::string(target_.name()) + (socket.empty() ? "" : '.' + socket);
    const char* const command = access.is_read() ? "a read" : access.is_write() ? "a write" : "a command";
    const std::string text = target + ": " + access.get_response_string() + " for " + command + " of " +
                             std::to_string(access.get_data_length()) + " bytes at address " +
                             std::to_string(access.get_address()) + ": must be " + rule +
                             "; later refusals are not reported";
    SC_REPORT_WARNING("/stereotlm/refused_access", text.c_str());
  }
  // The same, for a target with these rules.
  void report(const tlm::tlm_generic_payload& access, const AccessRules& rules) {
    if (!has_reported_) report(access, text_of(rules));
  }

 private:
  const sc_core::sc_object& target_;
  bool has_reported_ = false;
};

}  // namespace stereotlm
