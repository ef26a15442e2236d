#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "sw/explore/optimise/search.h"
#include "sw/explore/store/store.h"
#include "sw/sqlite/database.h"

namespace stereotlm::explore {

// The database of a search: its results while it runs, so that it can be continued, and in their place its
// answer and certificate at the end. The bytes of a finished database depend on the search alone.
//
// | table        | holds                                                                                  |
// |--------------|----------------------------------------------------------------------------------------|
// | search       | `name`, `value`: what was asked for, and how large the space is                        |
// | goals        | `goal`, `figure`, `aim` (maximise or minimise)                                         |
// | requirements | `condition`                                                                            |
// | front        | `point`, `boards`: how many boards have its values, `config`: the first of them        |
// | front_values | `point`, `goal`, `least`, `most`: equal, but for a rate with its uncertainty           |
// | front_boards | `point`, `combination`, `placement`, `sets`: the first kMostListed boards of a point,  |
// |              | and how they differ from the first, a line for each value of `--set`                   |
// | parts        | `first`, `last` combination, `verdict`, `reason`: each combination is in one part      |
// | spaces       | `space`, `number`, `placements`: groups of placements whose frames take the same time  |
// | examined     | of each combination of a part that is `examined`, the fate of its placements: `unmet`, |
// |              | ruled out by a `bound`, `dominated` or `front`. `of`: whether `numbers` are those of   |
// |              | groups in its `space`, or of placements. `least_cycles` is the least of their bounds,  |
// |              | `results` what the simulation of each gave                                             |
class SearchStore {
 public:
  // What was asked for; two searches are the same if all of it is equal.
  using Asked = std::map<std::string, std::string>;

  // Throws DatabaseError if the file is not one of this kind, is of another search, unless that one has no
  // results, or another process is at work on it. add() and finish() throw StoreGone if another file has
  // appeared in its place.
  SearchStore(const std::string& path, const Asked& asked);

  bool is_finished() const { return is_finished_; }
  // Of a search that is not finished.
  SearchResults results() const;
  void add(const SearchResults& results) const;
  // Replaces the file by the answer.
  void finish(Search& search) const;
  // Of a finished search.
  std::vector<FrontPoint> front(std::size_t goals) const;
  std::uint64_t boards() const;
  Search::Impossible impossible() const;

 private:
  void create(sqlite::Database& database) const;
  // Writes what is asked for.
  void ask(sqlite::Database& database) const;

  StoreLock lock_;
  std::string path_;
  Asked asked_;
  bool is_finished_ = false;
};

std::string verdict_text(Verdict verdict);

}  // namespace stereotlm::explore
