#include "sw/explore/optimise/front.h"

#include <algorithm>
#include <tuple>

namespace stereotlm::explore {

Front::Front(const std::vector<SearchWishes::Goal>& goals) {
  for (const SearchWishes::Goal& goal : goals) maxima_.push_back(goal.is_maximum);
}

std::vector<double> Front::bests_of(const std::vector<Range>& values) const {
  std::vector<double> bests;
  for (std::size_t goal = 0; goal < values.size(); ++goal)
    bests.push_back(maxima_[goal] ? values[goal].most : -values[goal].least);
  return bests;
}

std::vector<double> Front::worsts_of(const std::vector<Range>& values) const {
  std::vector<double> worsts;
  for (std::size_t goal = 0; goal < values.size(); ++goal)
    worsts.push_back(maxima_[goal] ? values[goal].least : -values[goal].most);
  return worsts;
}

bool Front::beats(const FrontPoint& point, const double* bests) const {
  bool is_better = false;
  for (std::size_t goal = 0; goal < maxima_.size(); ++goal) {
    const double its = maxima_[goal] ? point.values[goal].least : -point.values[goal].most;
    if (its < bests[goal]) return false;
    is_better = is_better || its > bests[goal];
  }
  return is_better;
}

std::optional<std::size_t> Front::beaten_by(const double* bests) const {
  const auto found = std::find_if(points_.begin(), points_.end(),
                                  [&](const FrontPoint& point) { return beats(point, bests); });
  if (found == points_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - points_.begin());
}

bool Front::is_before(const FrontPoint& a, const FrontPoint& b) const {
  const auto bests_of_a = bests_of(a.values);
  const auto bests_of_b = bests_of(b.values);
  const auto worsts_of_a = worsts_of(a.values);
  const auto worsts_of_b = worsts_of(b.values);
  for (std::size_t goal = 0; goal < maxima_.size(); ++goal) {
    const auto of_a = std::tie(bests_of_a[goal], worsts_of_a[goal]);
    const auto of_b = std::tie(bests_of_b[goal], worsts_of_b[goal]);
    if (of_a != of_b) return of_a > of_b;
  }
  return false;
}

// Makes the point if there is none, and removes those that it beats.
FrontPoint& Front::point_with(const std::vector<Range>& values) {
  const auto is_same = [&values](const FrontPoint& point) {
    return std::equal(values.begin(), values.end(), point.values.begin(),
                      [](const Range& a, const Range& b) { return a.least == b.least && a.most == b.most; });
  };
  const auto known = std::find_if(points_.begin(), points_.end(), is_same);
  if (known != points_.end()) return *known;
  const FrontPoint made = {values, 0, {}};
  points_.erase(
      std::remove_if(points_.begin(), points_.end(),
                     [&](const FrontPoint& other) { return beats(made, bests_of(other.values).data()); }),
      points_.end());
  const auto place = std::upper_bound(points_.begin(), points_.end(), made,
                                      [this](const auto& a, const auto& b) { return is_before(a, b); });
  return *points_.insert(place, made);
}

void Front::add(const std::vector<Range>& values, std::uint64_t combination,
                const std::vector<std::uint32_t>& placements) {
  if (beats(bests_of(values).data())) return;
  FrontPoint& point = point_with(values);
  point.boards += placements.size();
  for (const std::uint32_t placement : placements) {
    const BoardNumber number = {combination, placement};
    if (point.first.size() == kMostListed && !(number < point.first.back())) continue;
    point.first.insert(std::upper_bound(point.first.begin(), point.first.end(), number), number);
    if (point.first.size() > kMostListed) point.first.pop_back();
  }
}

}  // namespace stereotlm::explore
