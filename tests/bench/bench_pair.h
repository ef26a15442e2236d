#pragma once

#include <string>

#include "models/host/frame_source.h"

namespace stereotlm::bench {

struct BenchPair {
  host::StereoPair pair;  // 640x480
  std::string origin;     // "aloe" or "random texture"
};

// The pair of ./demo, made from the pictures in `folder`; if the folder has no such pictures, a random
// texture and its copy shifted by 20 columns.
BenchPair bench_pair(const std::string& folder);

}  // namespace stereotlm::bench
