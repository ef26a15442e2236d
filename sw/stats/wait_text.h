#pragma once

#include <string>

#include "platform/bounds.h"

namespace stereotlm::stats {

// Whom a port waits for: "left_pixel", "the turnaround". `by`: as in stats.json.
inline std::string cause_text(const std::string& by) { return by == "turnaround" ? "the turnaround" : by; }

// "left_lut on bank0 for left_pixel"
inline std::string wait_text(const std::string& port, const std::string& bank, const std::string& by) {
  return port + " on " + bank + " for " + cause_text(by);
}

// The name of a resource of the bounds, such as "bank bank0", for people: "bank0".
inline std::string resource_text(const std::string& resource) {
  return platform::bank_of_resource(resource).value_or(resource);
}

// The same in a sentence: "the matcher", "the cameras", "bank0".
inline std::string resource_words(const std::string& resource) {
  if (resource == "matcher") return "the matcher";
  if (resource == "camera") return "the cameras";
  if (resource == "pci") return "the PCI bus";
  if (resource == "bridge") return "the PCI bridge";
  return resource_text(resource);
}

}  // namespace stereotlm::stats
