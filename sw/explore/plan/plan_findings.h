#pragma once

#include <string>
#include <vector>

#include "platform/config/board_yaml.h"
#include "platform/yaml/yaml_tree.h"

namespace stereotlm::explore {

// Collects the errors of a plan file, each with its place; PlanReader uses it.
class PlanFindings {
 public:
  using Entries = std::vector<platform::YamlNode::Entry>;

  // `file`: the path of the plan.
  explicit PlanFindings(const std::string& file) : file_(file) {}

  std::string place_text(const platform::Place& place) const;  // "plan.yaml:3:9"

  void report(const platform::Place& place, const std::string& text);
  // Reports `path = value: rule`.
  void report(const std::string& path, const platform::YamlNode& node, const std::string& rule);
  // Adds errors that already have a place.
  void add(const std::vector<platform::Diagnostic>& found);

  // The entries of a map. Reports repeated entries, and entries whose keys are not among `known`; without
  // known keys all keys are allowed. If the value is not a map, reports it with `rule` and returns null.
  const Entries* read_map(const std::string& path, const platform::YamlNode& node,
                          const std::vector<std::string>& known, const std::string& rule);

  const std::vector<platform::Diagnostic>& all() const { return all_; }

 private:
  std::string file_;
  std::vector<platform::Diagnostic> all_;
};

}  // namespace stereotlm::explore
