#pragma once

#include <string>
#include <vector>

namespace stereotlm::explore {

// Writes the points of all `inputs`, which are files of a Store, into one file `out`, in the order of their
// hashes: its bytes depend on nothing but the points. `out` may be one of the inputs; it is replaced when the
// new file is whole and on the disk; nobody else may write to it (see StoreLock). An `out` that is there and
// is neither empty nor a file of a Store is an error. Throws DatabaseError (database.h), also if two inputs
// hold different results of one point, or of different versions.
void merge_stores(const std::vector<std::string>& inputs, const std::string& out);

}  // namespace stereotlm::explore
