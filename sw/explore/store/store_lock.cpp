#include "sw/explore/store/store_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>
#include <thread>

#include "sw/files/output_file.h"
#include "sw/files/whole_file.h"

namespace stereotlm::explore {
namespace {

// The offset of the byte that is locked, far behind the bytes that SQLite itself locks.
constexpr off_t kPlace = off_t{1} << 61;
constexpr std::chrono::milliseconds kBetweenTries{20};

enum class Outcome { kLocked, kBusy, kReplaced, kFailed };

bool is_empty(int file) {
  struct stat opened = {};
  return fstat(file, &opened) == 0 && opened.st_size == 0;
}

// Uses a lock of the open file description. A lock of the process would end as soon as the process closed any
// descriptor of the file.
Outcome try_lock(int file, const std::string& store) {
  struct flock range = {};
  range.l_type = F_WRLCK;
  range.l_whence = SEEK_SET;
  range.l_start = kPlace;
  range.l_len = 1;
  if (fcntl(file, F_OFD_SETLK, &range) != 0) {
    return errno == EAGAIN || errno == EACCES ? Outcome::kBusy : Outcome::kFailed;
  }
  return files::is_open_at(file, store) ? Outcome::kLocked : Outcome::kReplaced;
}

}  // namespace

std::string behind_links(const std::string& store) {
  try {
    return files::linked_file(store).string();
  } catch (const std::system_error& error) {
    throw sqlite::DatabaseError(fmt::format("{}: cannot be opened: {}", store, error.code().message()));
  }
}

StoreLock::StoreLock(const std::string& store, std::chrono::milliseconds busy_timeout)
    : store_(store), path_(behind_links(store)) {
  const auto end = std::chrono::steady_clock::now() + busy_timeout;
  for (;;) {
    open_store();
    const Outcome outcome = try_lock(file_, path_);
    if (outcome == Outcome::kLocked) return;
    const int error = errno;
    close(file_);
    if (outcome == Outcome::kFailed)
      throw sqlite::DatabaseError(fmt::format("{}: cannot be locked: {}", store, std::strerror(error)));
    if (std::chrono::steady_clock::now() >= end)
      throw sqlite::DatabaseError(
          store + ": another process is at work on it: wait for its end, or give another file");
    std::this_thread::sleep_for(kBetweenTries);
  }
}

void StoreLock::open_store() {
  constexpr mode_t kMode = 0644;
  file_ = open(path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, kMode);
  is_made_ = file_ >= 0;
  if (file_ < 0 && errno == EEXIST) file_ = open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, kMode);
  if (file_ < 0)
    throw sqlite::DatabaseError(
        fmt::format("{}: cannot be opened to write: {}", store_, std::strerror(errno)));
}

void StoreLock::check() const {
  if (!files::is_open_at(file_, path_)) throw StoreGone(store_);
}

StoreLock::~StoreLock() {
  if (is_made_ && is_empty(file_) && files::is_open_at(file_, path_)) unlink(path_.c_str());
  close(file_);
}

}  // namespace stereotlm::explore
