#pragma once

#include <string>

#include "models/host/frame_source.h"

namespace stereotlm::bench {

struct BenchPair {
  host::StereoPair pair;  // 640x480
  std::string origin;     // "aloe" or "random texture"
};

// The pair of ./demo, made from the pictures in `folder`. Without these pictures it is a random texture and a
// copy that is shifted by 20 columns.
BenchPair bench_pair(const std::string& folder);

}  // namespace stereotlm::bench
