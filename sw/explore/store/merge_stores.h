#pragma once

#include <string>
#include <vector>

namespace stereotlm::explore {

// Writes the points of all `inputs` to the file `store`, in the order of their hashes. The inputs are files
// that a Store or merge_stores() has written. The bytes of the new file depend only on the points.
// `store` may be one of the inputs. If `store` is a symbolic link, the file behind it is replaced. The old
// file is replaced only when the new one is complete and on the disk; its mode and owner are kept. No other
// process may write to `store` meanwhile (see StoreLock). Throws DatabaseError (database.h), also if two
// inputs hold different results of one point, if the points have different versions, or if `store` exists and
// is neither empty nor a file of a Store, or as soon as `is_interrupted`, unless null, returns true.
void merge_stores(const std::vector<std::string>& inputs, const std::string& store,
                  bool (*is_interrupted)() = nullptr);

}  // namespace stereotlm::explore
