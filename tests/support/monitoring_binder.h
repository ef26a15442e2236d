#pragma once

#include <memory>
#include <string>
#include <vector>

#include "models/binder.h"
#include "tests/support/protocol_monitor.h"

namespace stereotlm::test {

// Puts a ProtocolMonitor, named "<link>_monitor", into every link, and owns the monitors: it must outlive the
// simulation, and the violations fail the test when it is destroyed.
class MonitoringBinder : public Binder {
 public:
  explicit MonitoringBinder(const ProtocolOptions& options = {}) : options_(options) {}

  void bind(InitiatorSocket& from, TargetSocket& to, const std::string& link) override;

  // In the order in which the links were bound.
  const std::vector<std::unique_ptr<ProtocolMonitor>>& monitors() const { return monitors_; }
  // The monitor of one link; std::out_of_range if no link has that name.
  ProtocolMonitor& monitor(const std::string& link) const;
  std::vector<std::string> violations() const;
  std::vector<std::string> take_violations();

 private:
  ProtocolOptions options_;
  std::vector<std::unique_ptr<ProtocolMonitor>> monitors_;
  std::vector<std::string> links_;
};

}  // namespace stereotlm::test
