#pragma once

#include <chrono>
#include <string>

#include "sw/explore/store/database.h"

namespace stereotlm::explore {

// The path of the file that a store's path leads to through symbolic links. Throws DatabaseError.
std::string behind_links(const std::string& store);

// The file of a store was removed or replaced while it was in use: all points that were added to it are lost.
class StoreGone : public DatabaseError {
 public:
  explicit StoreGone(const std::string& store)
      : DatabaseError(store + ": has been removed or replaced meanwhile: what was done is gone with it") {}
};

// Keeps a store for one writer: the merge at the end of a sweep replaces the file, and points that another
// process added meanwhile would be lost. The lock is of the system and ends with this object, or with this
// process and those that it has forked since. Readers are not kept out.
class StoreLock {
 public:
  // For how long it waits: processes of a sweep that was killed take a moment to end.
  static constexpr std::chrono::milliseconds kBusyTimeout{3000};

  // The file is made, empty, if it is not there; it goes with the lock if nothing has come of it. Throws
  // DatabaseError.
  explicit StoreLock(const std::string& store, std::chrono::milliseconds busy_timeout = kBusyTimeout);
  ~StoreLock();
  StoreLock(const StoreLock&) = delete;
  StoreLock& operator=(const StoreLock&) = delete;

  // Throws StoreGone unless the file that is locked still has its name.
  void check() const;

 private:
  void open_store();

  std::string store_;
  std::string path_;  // behind links
  int file_ = -1;
  bool is_made_ = false;  // by this lock
};

}  // namespace stereotlm::explore
