#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "platform/board_config.h"
#include "platform/board_draft.h"
#include "platform/board_yaml.h"

namespace stereotlm::explore {

// How the points of a plan are simulated, beside their boards.
struct PointRun {
  bool camera = false;       // the whole computer, else the board alone (preloaded)
  std::uint64_t frames = 0;  // 0: the default of the source, see frames_of()
};

// Frames of a run: those asked for, or of the board alone one turn of its allocation's lists (its frame rate
// is then that of any number of turns), of the whole computer kCameraFrames.
inline constexpr std::uint64_t kCameraFrames = 12;
std::uint64_t frames_of(const PointRun& run, const platform::BoardConfig& board);

// Keys of a plan that are not the board's.
inline constexpr const char* kSourcePath = "run.source";
inline constexpr const char* kFramesPath = "run.frames";

// One value that a plan gives a key.
struct PlanValue {
  std::string path;
  platform::YamlNode value;
};

// One point: a board and how it is run; or why there is no such board.
struct Point {
  std::uint64_t number = 0;  // in the plan, from 0
  std::string hash;          // SHA-256 of the board in full and of the run, 64 hexadecimal digits
  std::optional<platform::BoardConfig> board;
  std::string yaml;    // the board in full, as config.yaml has it; of an impossible one the base board
  std::string reason;  // of an impossible combination: every rule that it breaks
  PointRun run;        // with its frames
  // Of every key, and of the run; of an impossible board the base board's, and what the plan gives.
  std::vector<platform::BoardValue> values;
};

// A plan of a sweep: a board, values for some of its keys, and which combinations of them are its points.
// Points are made one by one, from their numbers: a plan takes as much memory for a million as for ten.
class Plan {
 public:
  // Reads a plan file. Throws platform::BoardError with everything that is wrong, and with the number of
  // points that the plan would have.
  static Plan load(const std::string& path);

  // Points before conditions.
  std::uint64_t size() const { return sample_ ? sample_->points : product_; }
  // number: 0..size()-1. What it costs is reading a board.
  Point point(std::uint64_t number) const;
  const std::vector<std::string>& conditions() const { return conditions_; }
  // Paths that vary, in the order of the file.
  std::vector<std::string> varied() const;
  const std::string& path() const { return path_; }

 private:
  friend class PlanReader;

  // Values that move together: at place i each path takes its value i.
  struct Axis {
    std::vector<std::string> paths;
    std::vector<std::vector<platform::YamlNode>> values;  // [place][path]
  };
  struct Sample {
    std::uint64_t points = 0;
    std::uint64_t seed = 0;
  };

  explicit Plan(const std::string& path) : path_(path) {}
  // A value that has been checked, into a board or a run.
  static void apply(const std::string& path, const platform::YamlNode& value, const std::string& file,
                    platform::BoardDraft& draft, PointRun& run);
  static void apply_to_run(const std::string& path, const platform::YamlNode& value, PointRun& run);

  std::string path_;
  std::optional<platform::BoardDraft> base_;
  std::optional<platform::BoardConfig> base_board_;
  std::string base_yaml_;
  PointRun run_;
  std::vector<Axis> axes_;  // the last varies fastest
  std::uint64_t product_ = 1;
  std::vector<std::string> conditions_;
  std::optional<Sample> sample_;
};

}  // namespace stereotlm::explore
