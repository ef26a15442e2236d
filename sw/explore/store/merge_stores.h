#pragma once

#include <string>
#include <vector>

namespace stereotlm::explore {

// Writes the points of all `inputs`, which are files of a Store, into one, `store`, in the order of their
// hashes: its bytes depend on nothing but the points. `store` may be one of the inputs; the file, behind all
// symbolic links, is replaced when the new one is whole and on the disk, and keeps its mode and owner; nobody
// else may write to it (see StoreLock). A `store` that is there and is neither empty nor a file of a Store is
// an error. Throws DatabaseError (database.h), also if two inputs
// hold different results of one point, or of different versions.
void merge_stores(const std::vector<std::string>& inputs, const std::string& store);

}  // namespace stereotlm::explore
