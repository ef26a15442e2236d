#pragma once

#include <pthread.h>

#include <atomic>

namespace stereotlm::process {

// What the processes of a sweep share: memory that is the same on both sides of fork().
class SharedState {
 public:
  SharedState();  // throws std::system_error
  ~SharedState();
  SharedState(const SharedState&) = delete;
  SharedState& operator=(const SharedState&) = delete;

  // No further point is to be begun.
  std::atomic<bool>& stop() const { return page_->stop; }

  // While it lives no other process has one: they wait, and if this one dies the next has its turn. SQLite
  // would let them wait too, but for milliseconds at a time.
  class Turn {
   public:
    explicit Turn(const SharedState& state);
    ~Turn();
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

   private:
    pthread_mutex_t& mutex_;
  };

 private:
  struct Page {
    std::atomic<bool> stop{false};
    pthread_mutex_t mutex;
  };
  Page* page_;
};

}  // namespace stereotlm::process
