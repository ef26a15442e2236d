#pragma once

namespace stereotlm::cli {

// Exit status of the program (contract section 5).
inline constexpr int kDone = 0;
inline constexpr int kFailed = 1;   // the command failed while it worked
inline constexpr int kRefused = 2;  // the command was refused before it began
inline constexpr int kInterrupted = 130;

}  // namespace stereotlm::cli
