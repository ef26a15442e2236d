#pragma once

#include <cstdint>
#include <string>

#include "models/clock.h"
#include "models/testing/access_probe.h"

namespace stereotlm::test {

// Checks in which cycle a crossbar has granted a word: in this one, and not in the one before. It compares a
// probe in front of a port with one in front of a bank. Between request and response no other port may access
// the same words in the same direction.
class GrantCheck {
 public:
  // `bank_base`: what the crossbar adds to the addresses of the bank. All arguments outlive the check.
  GrantCheck(const Clock& clock, const AccessProbe& port, const AccessProbe& bank, std::uint64_t bank_base)
      : clock_(clock), port_(port), bank_(bank), bank_base_(bank_base) {}

  // Empty if word number `word` of access number `access` of the port was granted in cycle `cycle`, and was
  // refused in the cycle before. Else what is wrong. A word that was granted at its first request was never
  // refused: granted_at_once() checks it.
  std::string problem(std::size_t access, std::size_t word, std::uint64_t cycle) const;
  // Empty if the word was granted in cycle `cycle`, the first one in which it requested.
  std::string granted_at_once(std::size_t access, std::size_t word, std::uint64_t cycle) const;

 private:
  struct Times {
    std::uint64_t requested = 0;  // cycle
    std::uint64_t granted = 0;    // cycle
    std::string problem;          // not empty: there is no such word

    std::string text() const {
      return "requested in cycle " + std::to_string(requested) + ", granted in cycle " +
             std::to_string(granted);
    }
  };
  Times times_of(std::size_t access, std::size_t word) const;

  const Clock& clock_;
  const AccessProbe& port_;
  const AccessProbe& bank_;
  std::uint64_t bank_base_;
};

}  // namespace stereotlm::test
