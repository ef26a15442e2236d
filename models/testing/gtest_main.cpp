#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <systemc>
#include <utility>
#include <vector>

#include "models/testing/expected_report.h"
#include "models/testing/failure.h"
#include "models/testing/protocol_monitor.h"

namespace stereotlm::test {
namespace {

// SystemC's report handler is a plain function, so what it consults cannot belong to an object.
std::vector<ExpectedReport*>& announcements() {
  static std::vector<ExpectedReport*> list;
  return list;
}

void handle_report(const sc_core::sc_report& report, const sc_core::sc_actions& actions) {
  if (report.get_severity() == sc_core::SC_INFO) return;
  const std::string text = report.get_msg();
  const bool announced =
      std::any_of(announcements().begin(), announcements().end(),
                  [&](ExpectedReport* expected) { return expected->takes(report.get_msg_type(), text); });
  if (!announced && actions != sc_core::SC_DO_NOTHING) {
    ADD_FAILURE_AT(report.get_file_name(), report.get_line_number())
        << "SystemC report that the test did not announce: " << report.what();
  }
  sc_core::sc_report_handler::default_handler(
      report, actions & ~static_cast<sc_core::sc_actions>(sc_core::SC_DISPLAY));
}

// Says what to do where a second test of a process makes modules, and fails a test that a monitor outlives.
class TestListener : public testing::EmptyTestEventListener {
  void OnTestPartResult(const testing::TestPartResult& result) override {
    if (!result.failed() || std::strstr(result.message(), "(E529)") == nullptr) return;
    std::fputs(
        "note: SystemC elaborates once in a process: run each test in one of its own, by ctest with "
        "gtest_discover_tests(), or by --gtest_filter=TEST\n",
        stderr);
  }
  void OnTestEnd(const testing::TestInfo& /*test*/) override { ProtocolMonitor::fail_at_end(); }
};

}  // namespace

ExpectedReport::ExpectedReport(std::string message_type, int count)
    : message_type_(std::move(message_type)), missing_(count) {
  announcements().push_back(this);
}

ExpectedReport::~ExpectedReport() {
  auto& list = announcements();
  list.erase(std::remove(list.begin(), list.end(), this), list.end());
  if (missing_ > 0) {
    ADD_FAILURE() << "announced SystemC report " << message_type_ << " did not come: " << missing_
                  << " missing";
  }
}

bool ExpectedReport::takes(const std::string& message_type, const std::string& text) {
  if (missing_ == 0 || message_type != message_type_) return false;
  --missing_;
  text_ = text;
  return true;
}

}  // namespace stereotlm::test

int sc_main(int argc, char** argv) {
  sc_core::sc_report_handler::set_handler(stereotlm::test::handle_report);
  stereotlm::test::set_failure_handler([](const std::string& text) { ADD_FAILURE() << text; });
  testing::InitGoogleTest(&argc, argv);
  testing::UnitTest::GetInstance()->listeners().Append(new stereotlm::test::TestListener);
  return RUN_ALL_TESTS();
}

// Takes the place of libsystemc's own main, which prints the copyright banner before sc_main can turn it off.
int main(int argc, char** argv) {
  setenv("SYSTEMC_DISABLE_COPYRIGHT_MESSAGE", "1", 1);
  return sc_core::sc_elab_and_sim(argc, argv);
}
