#pragma once

#include <string>
#include <vector>

namespace stereotlm::explore {

// Writes the points of all `inputs`, which are files of a Store, to the file `store`, in the order of their
// hashes. The bytes of the file depend on nothing but the points. `store` may be one of the inputs. The file,
// behind all symbolic links, is replaced once the new one is complete and on the disk; it keeps its mode and
// owner. No other process may write to it (see StoreLock). Throws DatabaseError (database.h), also if two
// inputs hold different results of one point, if the points have different versions, or if `store` exists and
// is neither empty nor a file of a Store.
void merge_stores(const std::vector<std::string>& inputs, const std::string& store);

}  // namespace stereotlm::explore
