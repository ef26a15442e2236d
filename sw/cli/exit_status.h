#pragma once

namespace stereotlm::cli {

// Exit status of the program (contract section 5).
inline constexpr int kDone = 0;
inline constexpr int kFailed = 1;   // after the first cycle
inline constexpr int kRefused = 2;  // by what can be known before the first cycle
inline constexpr int kInterrupted = 130;

}  // namespace stereotlm::cli
