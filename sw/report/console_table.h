#pragma once

#include <optional>
#include <string>

#include "platform/statistics.h"
#include "sw/report/accuracy.h"

namespace stereotlm::report {

struct ClocksMhz {
  double fpga = 40;
  double pci = 33.333;
  double local = 40;
};

// The short table that a run prints: frames per second beside their bounds, each bank's traffic against the
// peak of one word a cycle (`use %` is that share), the largest row of blame; of a computer each PCI master's
// traffic against the peak of one word a clock and its mean wait for the bus, how busy both buses were, what
// the cameras dropped for which reason, the latency; and the accuracy if given. ASCII but for names, lines of
// at most 100 columns (a name of more than 24 characters is shortened), a newline after each.
std::string console_table(const platform::Statistics& statistics, const ClocksMhz& clocks_mhz,
                          const std::optional<Accuracy>& accuracy);

}  // namespace stereotlm::report
