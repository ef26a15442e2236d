#pragma once

#include <functional>
#include <string>

namespace stereotlm::test {

// Receives each failure that a part of the test kit finds: a broken rule of the protocol, a word that is not
// the one written. At first it is an SC_REPORT_WARNING of the type /stereotlm/testing; gtest_main.cpp makes
// it a failure of the running test. The modules of a simulation share one handler.
using FailureHandler = std::function<void(const std::string& text)>;
void set_failure_handler(FailureHandler handler);

void fail(const std::string& text);  // gives a failure to the handler

}  // namespace stereotlm::test
