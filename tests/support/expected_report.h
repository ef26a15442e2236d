#pragma once

#include <string>

namespace stereotlm::test {

// In a test that runs inside sc_main (stereotlm_add_test with SYSTEMC) every SystemC warning, error or fatal
// report fails the running test, unless it was announced:
//
//   ExpectedReport expected("/stereotlm/fpga/sequencer");
//   EXPECT_THROW(sequencer.start(), sc_core::sc_report);
//
// An announcement stands for `count` reports with this message type, of any of the three severities; further
// ones fail the test, and so does one that has not come when the announcement goes out of scope. An announced
// report keeps the effect it has in SystemC: an error is thrown, a fatal one aborts. Info reports are
// ignored.
class ExpectedReport {
 public:
  explicit ExpectedReport(std::string message_type, int count = 1);
  ~ExpectedReport();
  ExpectedReport(const ExpectedReport&) = delete;
  ExpectedReport& operator=(const ExpectedReport&) = delete;

  // The text of the last report that came; empty before the first.
  const std::string& text() const { return text_; }

  // Called by the report handler: true if this announcement stands for the report.
  bool takes(const std::string& message_type, const std::string& text);

 private:
  std::string message_type_;
  int missing_;
  std::string text_;
};

}  // namespace stereotlm::test
