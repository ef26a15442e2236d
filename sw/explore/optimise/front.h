#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "sw/explore/optimise/figure_range.h"
#include "sw/explore/plan/plan.h"

namespace stereotlm::explore {

// A board of the space.
struct BoardNumber {
  std::uint64_t combination = 0;  // of the values of the plan
  std::uint32_t placement = 0;

  friend bool operator<(const BoardNumber& a, const BoardNumber& b) {
    return a.combination != b.combination ? a.combination < b.combination : a.placement < b.placement;
  }
};

// Boards of a front with the same values.
struct FrontPoint {
  std::vector<Range> values;  // [goal]; a value that is not exact is a rate with its uncertainty
  std::uint64_t boards = 0;
  std::vector<BoardNumber> first;  // at most kMostListed, in their order
};
inline constexpr std::size_t kMostListed = 100;

// Boards of which none beats another: is at least as good in all goals, and better in one, whatever the
// uncertainties. Its points do not depend on the order in which boards are added.
class Front {
 public:
  explicit Front(const std::vector<SearchWishes::Goal>& goals);

  // Sorted by the values: the best of the first goal first, and so on.
  const std::vector<FrontPoint>& points() const { return points_; }
  // Takes over the points of another front of these goals.
  void set_points(std::vector<FrontPoint> points) { points_ = std::move(points); }

  // What the values can be at best: [goal], larger is better.
  std::vector<double> bests_of(const std::vector<Range>& values) const;
  // The first point that beats a board with these bests.
  std::optional<std::size_t> beaten_by(const double* bests) const;
  bool beats(const double* bests) const { return beaten_by(bests).has_value(); }
  // Adds placements of a combination with these values, unless a point beats them. Removes what they beat.
  void add(const std::vector<Range>& values, std::uint64_t combination,
           const std::vector<std::uint32_t>& placements);

 private:
  bool beats(const FrontPoint& point, const double* bests) const;
  FrontPoint& point_with(const std::vector<Range>& values);
  std::vector<double> worsts_of(const std::vector<Range>& values) const;
  bool is_before(const FrontPoint& a, const FrontPoint& b) const;

  std::vector<bool> maxima_;  // [goal]: whether it is maximised
  std::vector<FrontPoint> points_;
};

}  // namespace stereotlm::explore
