#include "models/testing/monitoring_binder.h"

#include <utility>

namespace stereotlm::test {

void MonitoringBinder::bind(InitiatorSocket& from, TargetSocket& to, const std::string& link) {
  const std::string name = link + "_monitor";
  auto monitor = std::make_unique<ProtocolMonitor>(name.c_str(), options_);
  from.bind(monitor->from_initiator);
  monitor->to_target.bind(to);
  monitors_.push_back(std::move(monitor));
}

std::vector<std::string> MonitoringBinder::take_violations() {
  std::vector<std::string> all;
  for (const auto& monitor : monitors_) {
    for (std::string& violation : monitor->take_violations()) all.push_back(std::move(violation));
  }
  return all;
}

}  // namespace stereotlm::test
