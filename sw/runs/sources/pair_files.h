#pragma once

#include <string>
#include <vector>

#include "sw/process/problems.h"

namespace stereotlm::runs {

// The files of the left and of the right pictures. File i of one side belongs to file i of the other.
struct PairFiles {
  std::vector<std::string> left;
  std::vector<std::string> right;
  std::vector<std::string> notes;  // what looks wrong: for standard error
};

// Finds the files that the patterns of an option match, as find_pairs() does. Adds what looks wrong to
// `notes`.
std::vector<std::string> files_of(const std::string& option, const std::vector<std::string>& patterns,
                                  std::vector<std::string>& notes, process::Problems& problems);

// Finds the files that the patterns of --left and --right match. A file whose name equals a pattern is taken
// literally. Each side is in natural order: 2 comes before 10. Reports problems, and then returns no files: a
// pattern without files, different counts. The notes name files that differ from their pattern only in the
// case of the ending, the first gap in the numbers of a side, and the first pair whose numbers differ.
PairFiles find_pairs(const std::vector<std::string>& left, const std::vector<std::string>& right,
                     process::Problems& problems);

}  // namespace stereotlm::runs
