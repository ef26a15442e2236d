#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

namespace stereotlm::test {

// A piece of work for a child process of its own (SystemC elaborates once per process). It returns what went
// wrong, or nothing.
using ChildWork = std::function<std::string()>;

struct ChildResult {
  // How a shell would tell it: 0 the work returned an empty text and no GoogleTest expectation failed in it,
  // 1 one did or a text came, 2 an exception left it, 124 it ran out of time, 128 + n killed by signal n;
  // otherwise what the child exited with by itself.
  int exit_status = 0;
  // What went wrong; empty exactly when exit_status is 0.
  std::string text;
  bool ok() const { return exit_status == 0; }
};

// Runs the work in a forked child and waits for it. The child inherits everything and hands nothing back but
// the text; it leaves without running destructors of static objects. Throws std::system_error if there can be
// no child.
ChildResult run_in_child(const ChildWork& work, std::chrono::milliseconds timeout = std::chrono::seconds(60));

// The same for many, at most `parallel` (at least 1) at a time; results in the order of the jobs. The timeout
// is that of each job.
std::vector<ChildResult> run_in_children(const std::vector<ChildWork>& jobs, int parallel,
                                         std::chrono::milliseconds timeout = std::chrono::seconds(60));

}  // namespace stereotlm::test
