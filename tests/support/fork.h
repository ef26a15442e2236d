#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

namespace stereotlm::test {

// Work for a child process, because SystemC elaborates once per process. It returns the text of a failure,
// empty for success.
using ChildWork = std::function<std::string()>;

struct ChildResult {
  // 0: success. 1: the work returned a text, or a GoogleTest expectation failed in it. 2: the work threw.
  // 124: it ran out of time. 128 + n: signal n killed the child. Otherwise the status with which the child
  // exited early.
  int exit_status = 0;
  std::string text;  // of the failure; empty exactly when exit_status is 0
  bool ok() const { return exit_status == 0; }
};

// Runs the work in a forked child and waits for it. The child inherits the memory, returns only the text, and
// exits without the destructors of static objects. Throws std::system_error if fork() fails. The timeout is
// below that of ctest, which would end the test without the text.
ChildResult run_in_child(const ChildWork& work, std::chrono::milliseconds timeout = std::chrono::seconds(40));

// Runs work whose text is a result. The running test fails if the work throws, or with an expectation in it.
std::string run_for_text(const ChildWork& work);

// Runs many jobs, at most `parallel` (1 or more) at a time, each with its own timeout. Returns the results in
// the order of the jobs. Once one has run out of time, no further ones begin.
std::vector<ChildResult> run_in_children(const std::vector<ChildWork>& jobs, int parallel,
                                         std::chrono::milliseconds timeout = std::chrono::seconds(40));

}  // namespace stereotlm::test
