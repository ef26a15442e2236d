#pragma once

#include <cstdint>
#include <systemc>

#include "models/capture/camera_beats.h"
#include "models/kernels/gray_image.h"
#include "models/stream.h"

namespace stereotlm::capture {

// Supplies the pictures of a camera.
class CameraSource {
 public:
  virtual ~CameraSource() = default;
  // Returns the picture of camera frame `number`, which began at `begin_ps`. It has the camera's size and
  // stays valid until the next call. Called only for taken frames, in their order.
  virtual const kernels::GrayImage& frame(std::uint64_t number, std::uint64_t begin_ps) = 0;
};

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
class Camera : public sc_core::sc_module {
 public:
  struct Stats {
    std::uint64_t frames = 0;  // frames that have begun
    std::uint64_t ignored_triggers = 0;
  };

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

  const CameraTiming& timing() const { return timing_; }
  const Stats& stats() const { return stats_; }

 private:
  void begin_frame();
  void send_line();

  CameraTiming timing_;
  CameraTrigger trigger_mode_;
  CameraSource& source_;
  sc_core::sc_event frame_begins_{"frame_begins"};
  sc_core::sc_event line_begins_{"line_begins"};
  bool triggered_ = false;           // a triggered frame is about to begin
  std::uint64_t next_begin_ps_ = 0;  // earliest beginning of a triggered frame
  std::uint64_t frame_begin_ps_ = 0;
  const kernels::GrayImage* image_ = nullptr;  // picture of the running frame; null: not taken
  int row_ = 0;                                // next row to send
  Stats stats_;
};

}  // namespace stereotlm::capture
