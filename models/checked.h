#pragma once

#include <stdexcept>
#include <string>

namespace stereotlm {

// Returns `config`, the configuration of a block. Throws std::invalid_argument with the first problem if
// problems(config) finds any.
template <class Config>
const Config& checked(const Config& config) {
  if (const auto found = problems(config); !found.empty()) throw std::invalid_argument(found.front());
  return config;
}
// The same, with the name of the block before the problem.
template <class Config>
const Config& checked(const std::string& name, const Config& config) {
  if (const auto found = problems(config); !found.empty())
    throw std::invalid_argument(name + ": " + found.front());
  return config;
}

}  // namespace stereotlm
