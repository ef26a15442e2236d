#include "tests/support/monitoring_binder.h"

#include <stdexcept>

namespace stereotlm::test {

void MonitoringBinder::bind(InitiatorSocket& from, TargetSocket& to, const std::string& link) {
  const std::string name = link + "_monitor";
  auto monitor = std::make_unique<ProtocolMonitor>(name.c_str(), options_);
  from.bind(monitor->from_initiator);
  monitor->to_target.bind(to);
  monitors_.push_back(std::move(monitor));
  links_.push_back(link);
}

ProtocolMonitor& MonitoringBinder::monitor(const std::string& link) const {
  for (std::size_t i = 0; i < links_.size(); ++i) {
    if (links_[i] == link) return *monitors_[i];
  }
  throw std::out_of_range("MonitoringBinder: no link is named " + link);
}

std::vector<std::string> MonitoringBinder::violations() const {
  std::vector<std::string> all;
  for (const auto& monitor : monitors_) {
    for (auto& violation : monitor->violations()) all.push_back(violation);
  }
  return all;
}

std::vector<std::string> MonitoringBinder::take_violations() {
  auto all = violations();
  for (const auto& monitor : monitors_) monitor->take_violations();
  return all;
}

}  // namespace stereotlm::test
