#include "sw/report/chart/chart_drawing.h"

#include <array>

#include "sw/report/chart/chart_text.h"

namespace stereotlm::report {
namespace {

constexpr std::array<double, kLoadSteps - 1> kStepPercents = {1, 25, 50, 90};  // where steps 1.. begin

}  // namespace

int load_step(double load, double peak) {
  int step = 0;
  for (const double percent : kStepPercents) {
    if (100 * load >= percent * peak) ++step;
  }
  return step;
}

std::string load_text(int step) {
  if (step == 0) return "below " + short_number(kStepPercents[0]);
  return "from " + short_number(kStepPercents[static_cast<std::size_t>(step) - 1]);
}

}  // namespace stereotlm::report
