#include "models/testing/grant_check.h"

#include <algorithm>

#include "models/kernel_time.h"

namespace stereotlm::test {

// The first word of an access requests from the first cycle on that begins at or after the access, each other
// word from the cycle after the grant of the word before.
GrantCheck::Times GrantCheck::times_of(std::size_t access, std::size_t word) const {
  if (access >= port_.accesses().size() || word >= port_.accesses()[access].words.size()) {
    return {0, 0,
            "access " + std::to_string(access) + ", word " + std::to_string(word) + ": " + port_.name() +
                " has seen none"};
  }
  const SeenAccess& asked = port_.accesses()[access];
  Times times;
  times.requested = clock_.edge_at_or_after(kernel_time::to_ps(asked.begin));
  for (std::size_t number = 0;; ++number) {
    const std::uint64_t address = asked.address + 4 * number - bank_base_;
    const auto granted =
        std::find_if(bank_.accesses().begin(), bank_.accesses().end(), [&](const SeenAccess& at_bank) {
          return at_bank.address == address && at_bank.write == asked.write &&
                 kernel_time::to_ps(at_bank.begin) >= clock_.edge_ps(times.requested) &&
                 at_bank.begin <= asked.end;
        });
    if (granted == bank_.accesses().end())
      return {0, 0, std::string(bank_.name()) + ": no access to address " + std::to_string(address)};
    times.granted = clock_.edge_at_or_after(kernel_time::to_ps(granted->begin));
    if (number == word) return times;
    times.requested = times.granted + 1;
  }
}

std::string GrantCheck::problem(std::size_t access, std::size_t word, std::uint64_t cycle) const {
  const Times times = times_of(access, word);
  if (!times.problem.empty()) return times.problem;
  if (times.granted != cycle) return times.text() + ": must be granted in cycle " + std::to_string(cycle);
  return times.requested == cycle ? times.text() + ": it was refused in no cycle" : "";
}

std::string GrantCheck::granted_at_once(std::size_t access, std::size_t word, std::uint64_t cycle) const {
  const Times times = times_of(access, word);
  if (!times.problem.empty()) return times.problem;
  if (times.granted == cycle && times.requested == cycle) return "";
  return times.text() + ": must be both in cycle " + std::to_string(cycle);
}

}  // namespace stereotlm::test
