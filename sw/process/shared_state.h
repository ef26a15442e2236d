#pragma once

#include <pthread.h>

#include <atomic>

namespace stereotlm::process {

// Memory that the processes of a sweep share: it is the same on both sides of fork().
class SharedState {
 public:
  SharedState();  // throws std::system_error
  ~SharedState();
  SharedState(const SharedState&) = delete;
  SharedState& operator=(const SharedState&) = delete;

  // Once it is true, no process begins another point.
  std::atomic<bool>& stop() const { return page_->stop; }

  // A lock that one process holds at a time. The others wait; if the holder dies, the next process gets the
  // lock. (SQLite's own wait polls every few milliseconds.)
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
