#pragma once

#include <optional>
#include <string>

#include "platform/statistics.h"
#include "sw/report/accuracy.h"

namespace stereotlm::report {

// The short table that a run prints: frames per second beside their bound, each bank's traffic against the
// peak of one word a cycle at clock_mhz (`use %` is that share), the largest row of blame, and the accuracy
// if given. ASCII but for names, lines of at most 100 columns (a name of more than 24 characters is
// shortened), a newline after each.
std::string console_table(const platform::Statistics& statistics, double clock_mhz,
                          const std::optional<Accuracy>& accuracy);

}  // namespace stereotlm::report
