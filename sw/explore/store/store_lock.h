#pragma once

#include <chrono>
#include <string>

#include "sw/sqlite/database.h"

namespace stereotlm::explore {

// Follows the symbolic links in the path of a store, and returns the path of the file. Throws DatabaseError.
std::string behind_links(const std::string& store);

// The file of a store was removed or replaced while it was in use. The points that were added to it are lost.
class StoreGone : public sqlite::DatabaseError {
 public:
  explicit StoreGone(const std::string& store)
      : sqlite::DatabaseError(store + ": was removed or replaced while in use: its points are lost") {}
};

// Reserves a store for one writer. The merge at the end of a sweep replaces the file, and would lose points
// that another process added during the sweep. The operating system holds the lock: it is released when this
// object is destroyed, or when this process and all its forks have ended. It does not stop readers.
class StoreLock {
 public:
  // How long the constructor waits: the processes of a sweep that was killed take a moment to end.
  static constexpr std::chrono::milliseconds kBusyTimeout{3000};

  // Makes an empty file if there is none. The destructor removes this file if it is still empty. Throws
  // DatabaseError, also if another process holds the lock.
  explicit StoreLock(const std::string& store, std::chrono::milliseconds busy_timeout = kBusyTimeout);
  ~StoreLock();
  StoreLock(const StoreLock&) = delete;
  StoreLock& operator=(const StoreLock&) = delete;

  // Throws StoreGone unless the path still leads to the locked file.
  void check() const;

 private:
  void open_store();

  std::string store_;
  std::string path_;  // of the file behind all symbolic links
  int file_ = -1;
  bool is_made_ = false;  // this lock has made the file
};

}  // namespace stereotlm::explore
