#pragma once

#include <cstdint>
#include <systemc>

#include "models/capture/camera_control.h"
#include "models/step_event.h"
#include "models/stream.h"

namespace stereotlm::capture {

// The camera as its capture boards see it: `board.camera.bind(camera.link)`.
class FrameCameraIf : public virtual sc_core::sc_interface, public FrameCamera {};

// The camera of one side (contract section 3). Its frames begin with the frame clock, or on demand when it is
// triggered. The capture board that takes a frame reads its pixels when they have arrived. Cost: one event
// per frame.
//
// A trigger has a time, now or later. The next frame begins at this time, if the last pixel of the frame
// before has arrived by then. The camera ignores and counts a trigger that is too early, one that comes
// before the frame of the last accepted trigger has begun, and every trigger if it runs freely.
//
// SC_REPORT_ERROR (type /stereotlm/camera) reports: a picture of another size; the taking of a frame that is
// not the running one or has been taken already.
class Camera : public sc_core::sc_module, private FrameReceiver, private FrameCameraIf {
 public:
  using Stats = CameraControl::Stats;  // frames begun, triggers ignored

  StreamOut<VideoFrame> frames_out{"frames_out"};  // each frame, at its beginning
  sc_core::sc_export<FrameCameraIf> link{"link"};  // for the capture board

  // `source` outlives the camera. Throws std::invalid_argument if the configuration has problems or the
  // kernel's time resolution is not 1 ps.
  Camera(const sc_core::sc_module_name& name, const CameraConfig& config, CameraSource& source);

  const CameraControl& control() const { return control_; }         // the rules behind the sockets
  const CameraTiming& timing() const { return control_.timing(); }  // when frames begin and pixels arrive
  const Stats& stats() const { return control_.stats(); }           // counts up to the present time

 private:
  void begin_frame(const VideoFrame& frame) override;
  bool take(std::uint64_t number) override;
  void copy_words(int first, int count, std::uint32_t* to) const override {
    control_.copy_words(first, count, to);
  }
  void trigger(std::uint64_t begin_ps) override;
  void step();

  CameraControl control_;
  StepEvent step_due_{"step_due"};
};

}  // namespace stereotlm::capture
