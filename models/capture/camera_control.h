#pragma once

#include <cstdint>

#include "models/capture/camera_link.h"
#include "models/capture/camera_timing.h"
#include "models/capture/capture_config.h"
#include "models/kernels/gray_image.h"
#include "models/time_ps.h"

namespace stereotlm::capture {

// Supplies the pictures of a camera.
class CameraSource {
 public:
  virtual ~CameraSource() = default;
  // Returns the picture of camera frame `number`, which began at `begin_ps`. It has the camera's size and
  // stays valid until the next call. Called only for taken frames, in their order.
  virtual const kernels::GrayImage& frame(std::uint64_t number, std::uint64_t begin_ps) = 0;
};

// The frames of a Camera: when they begin, which of them are taken, and which triggers are ignored. Its only
// steps are the beginnings of frames. Plain C++.
class CameraControl : public FrameCamera {
 public:
  struct Stats {
    std::uint64_t frames = 0;  // frames that have begun
    std::uint64_t ignored_triggers = 0;
  };

  // `source` and `board` outlive the camera. Throws std::invalid_argument if the configuration has problems.
  CameraControl(const CameraConfig& config, CameraSource& source, FrameReceiver& board);

  // The time at which step() is to be called next; kNever: a trigger may change it.
  std::uint64_t next_ps() const { return next_ps_; }
  // Begins a frame.
  void step(std::uint64_t now_ps);

  // Throws std::logic_error if frame `number` is not the running one, has been taken already, or if its
  // picture has another size.
  bool take(std::uint64_t number) override;
  void copy_words(int first, int count, std::uint32_t* to) const override;
  void trigger(std::uint64_t begin_ps) override;

  const CameraTiming& timing() const { return timing_; }
  const Stats& stats() const { return stats_; }

 private:
  CameraTiming timing_;
  CameraTrigger trigger_mode_;
  CameraSource& source_;
  FrameReceiver& board_;
  std::uint64_t next_ps_;
  std::uint64_t earliest_trigger_ps_ = 0;
  std::uint64_t frame_begin_ps_ = 0;
  bool taken_ = false;                           // the running frame
  const kernels::GrayImage* picture_ = nullptr;  // of the last frame taken
  Stats stats_;
};

}  // namespace stereotlm::capture
