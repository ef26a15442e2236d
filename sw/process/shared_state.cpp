#include "sw/process/shared_state.h"

#include <sys/mman.h>

#include <cerrno>
#include <new>
#include <system_error>

namespace stereotlm::process {

SharedState::SharedState() {
  void* const page = mmap(nullptr, sizeof(Page), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (page == MAP_FAILED) throw std::system_error(errno, std::generic_category(), "mmap");
  page_ = new (page) Page;
  pthread_mutexattr_t kind;
  pthread_mutexattr_init(&kind);
  pthread_mutexattr_setpshared(&kind, PTHREAD_PROCESS_SHARED);
  pthread_mutexattr_setrobust(&kind, PTHREAD_MUTEX_ROBUST);
  pthread_mutex_init(&page_->mutex, &kind);
  pthread_mutexattr_destroy(&kind);
}

SharedState::~SharedState() {
  pthread_mutex_destroy(&page_->mutex);
  munmap(page_, sizeof *page_);
}

SharedState::Turn::Turn(const SharedState& state) : mutex_(state.page_->mutex) {
  const int result = pthread_mutex_lock(&mutex_);
  if (result == EOWNERDEAD) {
    pthread_mutex_consistent(&mutex_);
  } else if (result != 0) {
    throw std::system_error(result, std::generic_category(), "pthread_mutex_lock");
  }
}

SharedState::Turn::~Turn() { pthread_mutex_unlock(&mutex_); }

}  // namespace stereotlm::process
