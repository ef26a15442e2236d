#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "platform/config/board_config.h"
#include "platform/config/board_draft.h"
#include "platform/yaml/yaml_tree.h"
#include "sw/explore/plan/points.h"

namespace stereotlm::explore {

// The values that a plan gives one key: a list, or a range of exact decimal numbers, made on demand.
struct PlanValues {
  std::vector<platform::YamlNode> list = {};  // empty: the range
  // The range: `from`, `from` + `step`, and so on. Both are digits without the decimal point.
  std::int64_t from = 0;
  std::int64_t step = 1;
  std::uint64_t count = 0;
  int places = 0;              // digits behind the decimal point
  platform::Place place = {};  // of the range in the plan

  std::uint64_t size() const { return list.empty() ? count : list.size(); }
  // A number of the range is written as a board file has it, such as "39.9".
  platform::YamlNode at(std::uint64_t number) const;
};

// A pair of pictures in the section `run`.
struct PlanPair {
  std::string left;
  std::string right;
  std::string truth;
  std::optional<double> scale;  // levels of the truth per disparity
  std::string place;            // "plan.yaml:3:9"
};

// What a search is to find among the points of a plan. The figures and conditions are texts, not checked yet.
struct SearchWishes {
  struct Goal {
    Condition figure;
    bool is_maximum = false;  // false: a minimum
  };
  int most_banks = 0;  // in which buffers are placed; 0: each point has the placement of its board
  int most_parts = 1;  // of a buffer that is placed
  std::vector<Goal> goals;
  std::vector<Condition> requirements;
};

// The plan of a sweep: a board, values for some of its keys, and the combinations of these values that are
// points. Each point is made from its number, so that memory does not grow with the number of points.
class Plan {
 public:
  // Reads a plan file. `board`: a board in place of the one that the plan names; empty: none. `text` and
  // `board_text`: what the files of plan and board hold, if they have been read already; else null. Throws
  // platform::BoardError with all that is wrong, and the number of points that the plan would have.
  static Plan load(const std::string& path, const std::string& board = "", const std::string* text = nullptr,
                   const std::string* board_text = nullptr);

  // The number of points before conditions leave out some.
  std::uint64_t size() const { return sample_ ? sample_->points : product_; }
  // number: 0..size()-1. Each call reads and checks a board.
  Point point(std::uint64_t number) const;
  // The board of a point as it is read, and its run. Rules that its placement breaks are among the problems.
  struct ReadPoint {
    platform::BoardDraft draft;
    platform::BoardDraft::Reading reading;
    PointRun run;
  };
  ReadPoint read(std::uint64_t number) const;
  // The board that the plan names, with what it sets, before its keys vary; and the run.
  const platform::BoardDraft& base() const { return *base_; }
  const PointRun& run() const { return run_; }
  const SearchWishes& wishes() const { return wishes_; }
  // Where the plan has something that only a search takes; empty: nowhere.
  const std::string& wishes_place() const { return wishes_place_; }
  const std::vector<Condition>& conditions() const { return conditions_; }
  // The keys whose values vary, in the order of the plan.
  std::vector<std::string> varied() const;
  // The values that the plan gives them in a point.
  std::vector<std::string> varied_values(std::uint64_t number) const;
  // The first key of `allocation` two of whose values differ in nothing but banks; empty: there is none.
  std::string varied_banks() const;
  // Why the board cannot have the tables of the calibration of the plan; nullopt if it can, or if the plan
  // has none.
  std::optional<std::string> tables_problem(const platform::BoardConfig& board) const {
    return table_problem(board, [](const char*) { return true; });
  }
  // The same of the pictures.
  std::optional<std::string> pairs_problem(const platform::BoardConfig& board) const;
  // The points as a sequence, which is valid as long as this plan.
  Points points() const {
    return {size(), [this](std::uint64_t number) { return point(number); }, conditions_};
  }
  // Names of all banks of all points, sorted.
  const std::vector<std::string>& banks() const { return banks_; }
  const std::string& path() const { return path_; }
  const std::string& text() const { return text_; }    // what the plan file holds
  const std::string& board() const { return board_; }  // name of a preset, or path of a board file
  // What the board file holds; empty for a preset.
  const std::string& board_text() const { return base_->file_text(); }

  // Path of the calibration that the section `run` names; empty: none. calibration_place() is the place of
  // that value in the plan.
  const std::string& calibration() const { return calibration_; }
  const std::string& calibration_place() const { return calibration_place_; }
  // Gives all points the tables of a calibration for images of width x height, in place of the identity. A
  // point whose board cannot have these tables becomes impossible. If all points become impossible, returns
  // the broken rule, else nullopt. `sha256`: hash of the tables. `joint_problem`: why the tables cannot be
  // joined; nullopt if they can be joined.
  std::optional<std::string> use_calibration(const std::string& sha256, int width, int height,
                                             const std::optional<std::string>& joint_problem);

  // The pictures from which the section `run` has the accuracy of each point computed: pairs, or seeds of
  // made scenes.
  const std::vector<PlanPair>& pairs() const { return pairs_; }
  const std::vector<std::uint64_t>& seeds() const { return seeds_; }
  // Says what the files of pairs() hold: `sha256` over all of them, and the size of the pictures. A point
  // with images of another size becomes impossible. Returns the broken rule if all become impossible.
  std::optional<std::string> use_pairs(const std::string& sha256, int width, int height);

 private:
  friend class PlanReader;

  // Keys whose values vary together: at index i each key takes its value i.
  struct Axis {
    std::vector<std::string> paths;
    std::vector<PlanValues> values;  // [path]; all have the same size

    std::uint64_t size() const { return values.front().size(); }
  };
  struct Sample {
    std::uint64_t points = 0;
    std::uint64_t seed = 0;
  };

  Plan(const std::string& path, const std::string& board) : path_(path), board_(board) {}
  // The values that the plan gives a point, before they are checked.
  struct Combination {
    platform::BoardDraft draft;
    PointRun run;
  };
  Combination combination(std::uint64_t number) const;
  // Calls `visit` with each key that varies, in their order, and its value in a point.
  void each_value(std::uint64_t number,
                  const std::function<void(const std::string&, const platform::YamlNode&)>& visit) const;
  // The reason for which a board cannot have the tables of the calibration: its image size, a side without a
  // buffer for a table, or tables that cannot be joined. Leaves out reasons that depend on keys for which
  // `is_checked` is false. Nullopt without a reason or without a calibration.
  std::optional<std::string> table_problem(const platform::BoardConfig& board,
                                           const std::function<bool(const char*)>& is_checked) const;
  // Whether neither the key nor one below it varies.
  bool is_fixed(const char* path) const;

  std::string path_;
  std::string text_;
  std::string board_;
  std::string calibration_;
  std::string calibration_place_;
  int tables_width_ = 0;                             // pixels
  int tables_height_ = 0;                            // pixels
  std::optional<std::string> tables_joint_problem_;  // why they cannot be joined
  std::vector<PlanPair> pairs_;
  int pairs_width_ = 0;   // pixels
  int pairs_height_ = 0;  // pixels
  std::vector<std::uint64_t> seeds_;
  std::optional<platform::BoardDraft> base_;
  std::optional<platform::BoardConfig> base_board_;
  std::vector<std::string> banks_;
  PointRun run_;
  std::vector<Axis> axes_;  // the last varies fastest
  std::uint64_t product_ = 1;
  std::vector<Condition> conditions_;
  std::optional<Sample> sample_;
  SearchWishes wishes_;
  std::string wishes_place_;
};

// Shuffles the numbers 0..size-1 by a seed, and returns the one at `place`, 0..size-1. A Feistel network
// permutes all numbers of b bits, where b is the least of 2, 4, 6, .. with 2^b >= size. It is applied again
// to its result until that is below `size`. size: 1..2^62.
std::uint64_t shuffled_number(std::uint64_t size, std::uint64_t seed, std::uint64_t place);

}  // namespace stereotlm::explore
