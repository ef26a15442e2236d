#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace stereotlm::platform {

// The activities that the program on the host starts. Number n of each is of pair n, and of its frame.
enum class Activity : std::uint8_t { kCapture, kCopy, kFrame, kReadBack };
inline constexpr std::size_t kActivities = 4;

// The end of an activity without which another one could not start.
struct Awaited {
  Activity activity;
  std::uint64_t number;
  const char* reason;  // why the other one waits for it, as in the time line
};

// Receives what the program on the host starts.
class DriverObserver {
 public:
  virtual ~DriverObserver() = default;
  // The program starts an activity with its next access. `awaited`: what it has waited for.
  virtual void starts(Activity activity, const std::vector<Awaited>& awaited) = 0;
};

}  // namespace stereotlm::platform
