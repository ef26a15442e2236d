#pragma once

#include <cstdint>
#include <systemc>

#include "models/capture/camera_beats.h"
#include "models/kernels/gray_image.h"
#include "models/stream.h"

namespace stereotlm::capture {

// What a camera sees.
class CameraSource {
 public:
  virtual ~CameraSource() = default;
  // The picture of camera frame `number`, which began at `begin_ps`, of the camera's size; valid until the
  // next call. Asked for taken frames only, in their order.
  virtual const kernels::GrayImage& frame(std::uint64_t number, std::uint64_t begin_ps) = 0;
};

// The camera of one side (contract section 3): its frames begin with the frame clock, or on demand when
// triggered, and go out line by line with blanking. One event per frame, and one per line of a frame that is
// taken. A trigger in the blanking behind the last pixel of a frame begins the next one at once; one that
// comes before, or while a frame is about to begin, or to a free-running camera, is ignored and counted.
//
// SC_REPORT_ERROR (type /stereotlm/camera): a picture of another size; TakeFrame for another frame than the
// running one, or a second time.
class Camera : public sc_core::sc_module {
 public:
  struct Stats {
    std::uint64_t frames = 0;  // begun
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

  // `source` outlives the camera. Throws std::invalid_argument if the configuration has problems, or the
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
  bool triggered_ = false;           // and not yet begun
  std::uint64_t next_begin_ps_ = 0;  // the earliest for a trigger
  std::uint64_t frame_begin_ps_ = 0;
  const kernels::GrayImage* image_ = nullptr;  // of the running frame, if it is taken
  int row_ = 0;                                // the next to send
  Stats stats_;
};

}  // namespace stereotlm::capture
