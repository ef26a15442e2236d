#include "sw/explore/store_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <thread>

#include "sw/explore/database.h"

namespace stereotlm::explore {
namespace {

// Far behind all that SQLite locks itself.
constexpr off_t kPlace = off_t{1} << 61;
constexpr std::chrono::milliseconds kBetweenTries{20};

enum class Outcome { kLocked, kBusy, kReplaced };

// Of an open file description: closing another descriptor of the file does not end it, as it would a lock of
// the process.
Outcome try_lock(int file, const std::string& store) {
  struct flock range = {};
  range.l_type = F_WRLCK;
  range.l_whence = SEEK_SET;
  range.l_start = kPlace;
  range.l_len = 1;
  if (fcntl(file, F_OFD_SETLK, &range) != 0) {
    if (errno == EAGAIN || errno == EACCES) return Outcome::kBusy;
    throw DatabaseError(fmt::format("{}: cannot be locked: {}", store, std::strerror(errno)));
  }
  struct stat locked = {};
  struct stat there = {};
  const bool is_there = fstat(file, &locked) == 0 && stat(store.c_str(), &there) == 0;
  return is_there && locked.st_dev == there.st_dev && locked.st_ino == there.st_ino ? Outcome::kLocked
                                                                                    : Outcome::kReplaced;
}

}  // namespace

StoreLock::StoreLock(const std::string& store, std::chrono::milliseconds patience) {
  const auto end = std::chrono::steady_clock::now() + patience;
  for (;;) {
    file_ = open(store.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (file_ < 0)
      throw DatabaseError(fmt::format("{}: cannot be opened to write: {}", store, std::strerror(errno)));
    const Outcome outcome = try_lock(file_, store);
    if (outcome == Outcome::kLocked) return;
    close(file_);
    if (std::chrono::steady_clock::now() >= end)
      throw DatabaseError(store +
                          ": another process is at work on it: wait for its end, or give another file");
    std::this_thread::sleep_for(kBetweenTries);
  }
}

StoreLock::~StoreLock() { close(file_); }

}  // namespace stereotlm::explore
