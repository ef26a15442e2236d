#pragma once

#include <string>

namespace stereotlm::media {

// Captures what the process writes to standard error, because the decoders of OpenCV report some problems
// nowhere else. No other thread may write to standard error while an object exists.
class CapturedStderr {
 public:
  CapturedStderr();
  ~CapturedStderr();
  CapturedStderr(const CapturedStderr&) = delete;
  CapturedStderr& operator=(const CapturedStderr&) = delete;

  // Ends the capture and returns the captured text.
  std::string text();

 private:
  void restore();

  int capture_;
  int saved_;
};

}  // namespace stereotlm::media
