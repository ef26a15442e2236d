#pragma once

#include <string>

namespace stereotlm::test {

// Announces a SystemC report. In a test program with gtest_main.cpp every
// warning, error or fatal report that is not announced fails the running test:
//
//   ExpectedReport expected("/stereotlm/fpga/sequencer");
//   EXPECT_THROW(sequencer.start(), sc_core::sc_report);
//
// An announcement covers `count` reports of this message type, of any of the three severities. The test fails
// if more reports come, or if fewer have come when the announcement goes out of scope. An announced report
// keeps its effect: SystemC throws an error and aborts at a fatal one. Info reports are ignored, and those
// of a type whose actions the test has set to SC_DO_NOTHING.
class ExpectedReport {
 public:
  // `count`: the number of reports, at least 1.
  explicit ExpectedReport(std::string message_type, int count = 1);
  ~ExpectedReport();
  ExpectedReport(const ExpectedReport&) = delete;
  ExpectedReport& operator=(const ExpectedReport&) = delete;

  // The text of the last report; empty before the first.
  const std::string& text() const { return text_; }

  // For the report handler: true if this announcement covers the report.
  bool takes(const std::string& message_type, const std::string& text);

 private:
  std::string message_type_;
  int missing_;
  std::string text_;
};

}  // namespace stereotlm::test
