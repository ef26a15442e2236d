#pragma once

#include <cstdint>
#include <systemc>

#include "models/capture/camera_beats.h"
#include "models/capture/camera_control.h"
#include "models/step_event.h"
#include "models/stream.h"

namespace stereotlm::capture {

// The camera of one side (contract section 3). Its frames begin with the frame clock, or on demand when it is
// triggered. A frame that the capture board takes is sent line by line, with blanking. Cost: one event per
// frame, and one per line of a taken frame.
//
// A trigger is accepted from the last pixel of a frame on, and begins the next frame immediately. The camera
// ignores and counts a trigger that comes earlier, one that comes while another trigger is pending, and every
// trigger if it runs freely.
//
// SC_REPORT_ERROR (type /stereotlm/camera) reports: a picture of another size; TakeFrame for a frame that is
// not the running one or has been taken already.
class Camera : public sc_core::sc_module, private FrameReceiver {
 public:
  using Stats = CameraControl::Stats;

  StreamOut<VideoFrame> frames_out{"frames_out"};
  StreamOut<VideoLine> lines_out{"lines_out"};

 private:
  void take(const TakeFrame& taken);
  void trigger(const Trigger& trigger);

 public:
  StreamIn<TakeFrame, Camera, &Camera::take> takes_in{"takes_in", this};
  StreamIn<Trigger, Camera, &Camera::trigger> triggers_in{"triggers_in", this};

  // `source` outlives the camera. Throws std::invalid_argument if the configuration has problems or the
  // kernel's time resolution is not 1 ps.
  Camera(const sc_core::sc_module_name& name, const CameraConfig& config, CameraSource& source);

  const CameraControl& control() const { return control_; }
  const CameraTiming& timing() const { return control_.timing(); }
  const Stats& stats() const { return control_.stats(); }

 private:
  void begin_frame(const VideoFrame& frame) override { frames_out->push(frame); }
  void step();
  void send_line();

  CameraControl control_;
  StepEvent step_due_{"step_due"};
  sc_core::sc_event line_begins_{"line_begins"};
  int row_ = 0;  // next row to send
};

}  // namespace stereotlm::capture
