#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "platform/config/board_draft.h"
#include "platform/config/yaml_tree.h"
#include "sw/explore/plan/plan_values.h"
#include "sw/explore/plan/points.h"

namespace stereotlm::explore {

// One value that a plan gives a key.
struct PlanValue {
  std::string path;
  platform::YamlNode value;
};

// A plan of a sweep: a board, values for some of its keys, and which combinations of them are its points.
// Points are made one by one, from their numbers: a plan takes as much memory for a million as for ten.
class Plan : public Points {
 public:
  // Reads a plan file; `board`, if it is given, in place of the board that the plan names. Throws
  // platform::BoardError with everything that is wrong, and with the number of points that the plan would
  // have.
  static Plan load(const std::string& path, const std::string& board = "");

  // Points before conditions.
  std::uint64_t size() const override { return sample_ ? sample_->points : product_; }
  // number: 0..size()-1. What it costs is reading a board.
  Point point(std::uint64_t number) const override;
  const std::vector<Condition>& conditions() const override { return conditions_; }
  // Paths that vary, in the order of the file.
  std::vector<std::string> varied() const;
  // Of the banks of all points.
  const std::vector<std::string>& banks() const { return banks_; }
  const std::string& path() const { return path_; }
  const std::string& board() const { return board_; }  // a preset, or the path of a board file

  // The file of the calibration that `run` names, and where; empty: none.
  const std::string& calibration() const { return calibration_; }
  const std::string& calibration_place() const { return calibration_place_; }
  // Gives all points the tables of a calibration, of images of that size, in place of the identity. Points
  // that they do not fit are impossible; if no point can be another one this gives the rule, else nothing.
  std::optional<std::string> use_calibration(const std::string& sha256, int width, int height);

 private:
  friend class PlanReader;

  // Values that move together: at place i each path takes its value i.
  struct Axis {
    std::vector<std::string> paths;
    std::vector<PlanValues> values;  // of each path, equally many

    std::uint64_t size() const { return values.front().size(); }
  };
  struct Sample {
    std::uint64_t points = 0;
    std::uint64_t seed = 0;
  };

  Plan(const std::string& path, const std::string& board) : path_(path), board_(board) {}
  std::vector<PlanValue> values_at(std::uint64_t number) const;
  // What the plan asks for in a point.
  struct Combination {
    platform::BoardDraft draft;
    PointRun run;
  };
  Combination combination(std::uint64_t number) const;
  // Why a board cannot have the tables of the calibration.
  std::optional<std::string> wrong_size(const platform::BoardConfig& board) const;
  std::optional<std::string> missing_table(const platform::BoardConfig& board) const;
  bool varies(const std::string& path) const;  // the key, or one in it
  static void apply(const std::string& path, const platform::YamlNode& value, const std::string& file,
                    platform::BoardDraft& draft, PointRun& run);
  static void apply_to_run(const std::string& path, const platform::YamlNode& value, PointRun& run);

  std::string path_;
  std::string board_;
  std::string calibration_;
  std::string calibration_place_;
  int tables_width_ = 0;
  int tables_height_ = 0;
  std::optional<platform::BoardDraft> base_;
  std::optional<platform::BoardConfig> base_board_;
  std::vector<std::string> banks_;
  PointRun run_;
  std::vector<Axis> axes_;  // the last varies fastest
  std::uint64_t product_ = 1;
  std::vector<Condition> conditions_;
  std::optional<Sample> sample_;
};

}  // namespace stereotlm::explore
