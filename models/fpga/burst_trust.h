#pragma once

#include <algorithm>

namespace stereotlm::fpga {

// Decides whether FastForward looks up a burst in its cache. Looking up a burst that is not known, and recording
// it, costs time. With irregular accesses few bursts are ever known. So FastForward stops looking up bursts after
// many misses, and tries again every 2048 bursts.
class BurstTrust {
 public:
  // Whether the next burst is to be looked up: it is probably known, because others were lately; or none was
  // looked up for long. To be called once for each burst.
  bool expects_known() {
    if (trust_ == 0 && ++bursts_without_ == kMostBurstsWithout) {
      trust_ = kRetry;
      bursts_without_ = 0;
    }
    return trust_ != 0;
  }
  // To be called for each burst that was looked up.
  void note(bool is_known) {
    trust_ = is_known ? std::min(trust_ + kWonByKnown, kMost) : trust_ - std::min(trust_, 1U);
  }

 private:
  static constexpr unsigned kMost = 256;
  static constexpr unsigned kWonByKnown = 2;
  static constexpr unsigned kRetry = 8;
  static constexpr unsigned kMostBurstsWithout = 2048;

  unsigned trust_ = kMost;
  unsigned bursts_without_ = 0;  // bursts without trust
};

}  // namespace stereotlm::fpga
