#pragma once

#include <string>

namespace stereotlm::media {

// What is written to the process's standard error goes aside while one of these lives: decoders write there
// and offer OpenCV's callers no other way. No other thread may write there meanwhile.
class CapturedStderr {
 public:
  CapturedStderr();
  ~CapturedStderr();
  CapturedStderr(const CapturedStderr&) = delete;
  CapturedStderr& operator=(const CapturedStderr&) = delete;

  // Ends the capture and returns what was written.
  std::string text();

 private:
  void restore();

  int capture_;
  int saved_;
};

}  // namespace stereotlm::media
