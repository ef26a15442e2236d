#pragma once

#include <algorithm>

namespace stereotlm::fpga {

// Whether FastForward should look for the groups of a burst in its memo. A known burst saves more time than is
// lost by looking for one that is not known and by recording it. With irregular accesses hardly a burst meets
// the core in a state that comes again.
class BurstTrust {
 public:
  // Whether the next burst is probably known, because others were lately; or has to be looked for, because
  // none was for long. To be called once for each burst.
  bool expects_known() {
    if (trust_ == 0 && ++bursts_without_ == kMostBurstsWithout) {
      trust_ = kNew;
      bursts_without_ = 0;
    }
    return trust_ != 0;
  }
  // To be called for each burst that was looked for.
  void note(bool is_known) {
    trust_ = is_known ? std::min(trust_ + kWonByKnown, kMost) : trust_ - std::min(trust_, 1U);
  }

 private:
  static constexpr unsigned kMost = 256;
  static constexpr unsigned kWonByKnown = 2;
  static constexpr unsigned kNew = 8;
  static constexpr unsigned kMostBurstsWithout = 2048;

  unsigned trust_ = kMost;
  unsigned bursts_without_ = 0;  // bursts without trust
};

}  // namespace stereotlm::fpga
