#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "platform/config/board_yaml.h"

namespace stereotlm::explore {

// Keys of a point that are not its board's.
inline constexpr const char* kSourcePath = "run.source";
inline constexpr const char* kFramesPath = "run.frames";
inline constexpr const char* kCalibrationPath = "run.calibration";

// How a point is simulated, beside its board.
struct PointRun {
  bool camera = false;       // the whole computer, else the board alone (preloaded)
  std::uint64_t frames = 0;  // 0: the default of the source, see frames_of()
  std::string calibration;   // SHA-256 of the tables; empty: the identity
};

// Frames of a run: those asked for, or of the board alone one turn of its allocation's lists, the first one
// (where frames leave nothing behind its frame rate is that of any number of turns), of the whole computer
// kCameraFrames: between the first and the last delivery every buffer of a list, of whatever length, is used
// as often as the others.
inline constexpr std::uint64_t kCameraFrames = 13;
std::uint64_t frames_of(const PointRun& run, const platform::BoardConfig& board);

// One point: a board and how it is run; or why there is no such board.
struct Point {
  std::uint64_t number = 0;  // among its points, from 0
  std::string hash;          // SHA-256 of the board in full and of the run, 64 hexadecimal digits
  std::optional<platform::BoardConfig> board;
  std::string yaml;    // the board in full, as config.yaml has it, also if it is impossible
  std::string reason;  // of an impossible combination: every rule that it breaks
  PointRun run;        // with its frames
  std::vector<platform::BoardValue> values;  // of every key, and of the run
};

// The point of a board.
Point make_point(std::uint64_t number, const platform::BoardConfig& board, const PointRun& run);

// The point of a combination that is no board. `yaml` and `asked_for` are what the combination asks for, and
// `reason` is why there is no such board.
Point impossible_point(std::uint64_t number, const std::string& yaml, const platform::BoardConfig& asked_for,
                       const PointRun& run, const std::string& reason);

// An SQL expression; a point for which it is not true is left out. See Conditions.
struct Condition {
  std::string text;
  std::string place;  // "plan.yaml:3:9"
  std::string name;   // for messages: "where = image.width > 4"
};

// Points that are made one by one, from their numbers.
class Points {
 public:
  virtual ~Points() = default;
  virtual std::uint64_t size() const = 0;
  virtual Point point(std::uint64_t number) const = 0;  // number: 0..size()-1
  virtual const std::vector<Condition>& conditions() const = 0;

 protected:
  Points() = default;
  Points(const Points&) = default;
  Points(Points&&) = default;
  Points& operator=(const Points&) = default;
  Points& operator=(Points&&) = default;
};

}  // namespace stereotlm::explore
