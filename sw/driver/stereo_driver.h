#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

#include "models/fpga/core_ports.h"
#include "models/fpga/placement.h"
#include "models/host/program.h"
#include "models/kernels/joint_table.h"
#include "platform/config/board_config.h"
#include "platform/records/timeline_records.h"

// The program on the host (contract section 3). It uses only host::HostBus, so that it runs on the CPU of the
// model and could run on a real machine.

namespace stereotlm::driver {

// Bytes of host memory that the driver of a board uses, from address 0 of that memory.
std::uint64_t host_memory_bytes(const platform::BoardConfig& board);

// A result that has arrived in host memory.
struct DeliveredFrame {
  std::uint64_t frame = 0;                  // number of the core's frame
  std::uint64_t camera_frame = 0;           // number of the camera frame that it shows
  const std::uint8_t* disparity = nullptr;  // width * height pixels, valid during the call
};

// Receives the results of a StereoDriver.
using Deliver = std::function<void(const DeliveredFrame& frame)>;

// Uploads the tables, then schedules captures, frames and read-backs. It arms a capture when its buffer is
// free, starts the core when a pair and an output buffer are ready, and reads results back by DMA. Each of
// these activities counts the frames that it has begun and ended. A buffer is free when the activity that
// reads it has ended the frame in it. README.md lists every access.
//
// With capture.destination = host_memory, captures go to a ring in host memory, and a DMA channel copies the
// oldest pair to the board. run() returns after the last of `frames` deliveries. run() throws
// std::runtime_error if the hardware reports an error, and what HostBus throws.
class StereoDriver : public host::Program {
 public:
  // Entries of the tables, row by row (contract 1.1); null for a side without table. With joint tables the
  // driver joins both. The tables outlive the driver. `frames`: 1 or more. Throws std::invalid_argument if a
  // table does not have one entry per pixel, or if both cannot be joined.
  StereoDriver(const platform::BoardConfig& board, std::uint64_t frames,
               const std::vector<std::uint32_t>* left_table, const std::vector<std::uint32_t>* right_table,
               Deliver deliver);

  void run(host::HostBus& bus) override;
  // `observer` outlives the driver. To be called before run().
  void set_observer(platform::DriverObserver& observer) { observer_ = &observer; }

  // frames_started(), start_no_more() and under_way() may be called while run() waits.
  //
  // The number of times that the core was started.
  std::uint64_t frames_started() const { return of(Activity::kFrame).begun; }
  // The driver starts no more frames. run() returns when the frames that the core has begun are delivered.
  void start_no_more() { frames_ = frames_started(); }
  // The operations for which run() waits, as text: "capture 4, core with frame 2".
  std::string under_way() const;

 private:
  using Activity = platform::Activity;
  struct Progress {
    std::uint64_t begun = 0;
    std::uint64_t ended = 0;
    bool idle() const { return begun == ended; }
  };
  // An activity may begin when the one that is `back` before it in `activity` has ended.
  struct Condition {
    Activity activity;
    std::uint64_t back;
    const char* reason;  // as in platform::Awaited
  };
  struct Piece {
    std::uint64_t host = 0;   // address in host memory, bytes
    std::uint32_t board = 0;  // first word on the board
    std::uint64_t words = 0;
    bool to_host = false;
  };

  Progress& of(Activity activity) { return progress_[static_cast<std::size_t>(activity)]; }
  const Progress& of(Activity activity) const { return progress_[static_cast<std::size_t>(activity)]; }
  bool begin(Activity activity, std::initializer_list<Condition> conditions);
  void upload_tables();
  void handle_interrupts();
  void handle_captures();
  void start_what_can_be();
  void start_core();
  void arm_capture();
  void copy_pair();
  void read_back();
  void end_read_back();

  fpga::Placement picture_at(std::uint32_t base) const;  // a picture or a result
  // The rows of a table or a result in the order in which host memory holds them: part by part.
  std::vector<std::uint64_t> rows_by_part(const fpga::Placement& buffer) const;
  // Adds a piece for each part that has rows. `host`: of the first part; the others follow.
  void add_parts(const fpga::Placement& buffer, std::uint64_t host, bool to_host,
                 std::vector<Piece>& pieces) const;
  // Adds the pieces of the copy of a picture, which host memory holds row by row.
  void add_picture(std::uint32_t base, std::uint64_t host, std::vector<Piece>& pieces) const;
  // Lets an aperture of the bridge lead to a picture. `aperture`: 4 times its number.
  void write_pages(std::uint64_t aperture, std::uint32_t base);
  void start_dma(int channel, const std::vector<Piece>& pieces);
  std::uint64_t pair_in_host(std::uint64_t capture) const;
  std::uint64_t result_in_host(std::uint64_t frame) const;

  platform::BoardConfig board_;
  fpga::BufferBases buffers_;
  bool captures_to_host_;
  std::uint64_t frames_;
  const std::vector<std::uint32_t>* left_table_;
  const std::vector<std::uint32_t>* right_table_;
  std::vector<std::uint32_t> joint_table_;  // empty unless the tables are joint
  kernels::JointOffsets joint_offsets_{};
  Deliver deliver_;
  std::vector<std::uint8_t> result_;  // a striped one, row by row
  host::HostBus* bus_ = nullptr;

  platform::DriverObserver* observer_ = nullptr;
  std::array<Progress, platform::kActivities> progress_{};  // [Activity]; copies only if captures_to_host_
  bool uploading_ = false;
  std::array<bool, 2> side_done_{};           // [left, right]: the side of the running capture is complete
  std::vector<std::uint64_t> camera_frames_;  // camera frame of each finished capture
  bool core_to_acknowledge_ = false;
};

}  // namespace stereotlm::driver
