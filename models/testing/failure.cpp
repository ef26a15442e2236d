#include "models/testing/failure.h"

#include <systemc>
#include <utility>

namespace stereotlm::test {
namespace {

FailureHandler& handler() {
  static FailureHandler current = [](const std::string& text) {
    SC_REPORT_WARNING("/stereotlm/testing", text.c_str());
  };
  return current;
}

}  // namespace

void set_failure_handler(FailureHandler next) { handler() = std::move(next); }

void fail(const std::string& text) { handler()(text); }

}  // namespace stereotlm::test
