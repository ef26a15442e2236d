#pragma once

#include <stdexcept>
#include <string>

namespace stereotlm::process {

// Thrown where a process that does a piece of work was ended by a signal.
class EndedBySignal : public std::runtime_error {
 public:
  EndedBySignal(const std::string& text, int signal) : std::runtime_error(text), signal_(signal) {}
  int signal() const { return signal_; }

 private:
  int signal_;
};

}  // namespace stereotlm::process
