#include "sw/process/shared_memory.h"

#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <new>
#include <system_error>

namespace stereotlm::process {
namespace {

// For how long a process polls a lock before it sleeps, in calls of sched_yield(): some 50 us. Most turns are
// shorter than the time in which a process falls asleep and is woken up.
constexpr int kYields = 100;

}  // namespace

SharedMemory::SharedMemory(std::size_t bytes)
    : bytes_(bytes), data_(mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
  if (data_ == MAP_FAILED) throw std::system_error(errno, std::generic_category(), "mmap");
}

SharedMemory::~SharedMemory() { munmap(data_, bytes_); }

SharedLock::SharedLock() : memory_(sizeof(pthread_mutex_t)), mutex_(new (memory_.data()) pthread_mutex_t) {
  pthread_mutexattr_t kind;
  pthread_mutexattr_init(&kind);
  pthread_mutexattr_setpshared(&kind, PTHREAD_PROCESS_SHARED);
  pthread_mutexattr_setrobust(&kind, PTHREAD_MUTEX_ROBUST);
  pthread_mutex_init(mutex_, &kind);
  pthread_mutexattr_destroy(&kind);
}

SharedLock::~SharedLock() { pthread_mutex_destroy(mutex_); }

SharedLock::Turn::Turn(const SharedLock& lock) : mutex_(lock.mutex_) {
  int result = pthread_mutex_trylock(mutex_);
  for (int i = 0; i < kYields && result == EBUSY; ++i) {
    sched_yield();
    result = pthread_mutex_trylock(mutex_);
  }
  if (result == EBUSY) result = pthread_mutex_lock(mutex_);
  if (result == EOWNERDEAD) {
    pthread_mutex_consistent(mutex_);
  } else if (result != 0) {
    throw std::system_error(result, std::generic_category(), "pthread_mutex_lock");
  }
}

SharedLock::Turn::~Turn() { pthread_mutex_unlock(mutex_); }

}  // namespace stereotlm::process
