#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "models/binder.h"
#include "models/testing/access_probe.h"

namespace stereotlm::test {

// Puts an AccessProbe, named "<link>_probe", into every link whose name holds a text. It owns the probes and
// must outlive the simulation.
class ProbingBinder : public Binder {
 public:
  // A link with a probe.
  struct Probe {
    std::string link;                    // its name
    std::unique_ptr<AccessProbe> probe;  // in the link
  };

  // `of_links`: a text in the names of the links; empty: every link.
  explicit ProbingBinder(std::string of_links = "") : of_links_(std::move(of_links)) {}

  void bind(InitiatorSocket& from, TargetSocket& to, const std::string& link) override {
    if (link.find(of_links_) == std::string::npos) return Binder::bind(from, to, link);
    auto probe = std::make_unique<AccessProbe>((link + "_probe").c_str());
    from.bind(probe->from_initiator);
    probe->to_target.bind(to);
    probes_.push_back({link, std::move(probe)});
  }
  // In the order of bind().
  const std::vector<Probe>& probes() const { return probes_; }

 private:
  std::string of_links_;
  std::vector<Probe> probes_;
};

}  // namespace stereotlm::test
