#include "sw/media/captured_stderr.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdio>

namespace stereotlm::media {

CapturedStderr::CapturedStderr() : capture_(memfd_create("stderr", MFD_CLOEXEC)), saved_(dup(STDERR_FILENO)) {
  std::fflush(stderr);
  if (capture_ >= 0 && saved_ >= 0) dup2(capture_, STDERR_FILENO);
}

CapturedStderr::~CapturedStderr() {
  restore();
  if (capture_ >= 0) close(capture_);
}

std::string CapturedStderr::text() {
  restore();
  std::string result;
  char buffer[1024];
  if (capture_ < 0) return result;
  ssize_t count = 0;
  while ((count = pread(capture_, buffer, sizeof buffer, static_cast<off_t>(result.size()))) > 0) {
    result.append(buffer, static_cast<std::size_t>(count));
  }
  return result;
}

void CapturedStderr::restore() {
  if (saved_ < 0) return;
  std::fflush(stderr);
  dup2(saved_, STDERR_FILENO);
  close(saved_);
  saved_ = -1;
}

}  // namespace stereotlm::media
