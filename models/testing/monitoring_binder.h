#pragma once

#include <memory>
#include <string>
#include <vector>

#include "models/binder.h"
#include "models/testing/protocol_monitor.h"

namespace stereotlm::test {

// Puts a ProtocolMonitor, named "<link>_monitor", into every link. It owns the monitors and must outlive the
// simulation. Violations that nobody has taken out are failures (failure.h) when it is destroyed.
class MonitoringBinder : public Binder {
 public:
  explicit MonitoringBinder(const ProtocolOptions& options = {}) : options_(options) {}  // rules of all links

  void bind(InitiatorSocket& from, TargetSocket& to, const std::string& link) override;

  // In the order of bind().
  const std::vector<std::unique_ptr<ProtocolMonitor>>& monitors() const { return monitors_; }
  // Returns and removes the violations.
  std::vector<std::string> take_violations();

 private:
  ProtocolOptions options_;
  std::vector<std::unique_ptr<ProtocolMonitor>> monitors_;
};

}  // namespace stereotlm::test
