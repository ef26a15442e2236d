#pragma once

#include <pthread.h>

#include <atomic>

namespace stereotlm::process {

// State that the processes of a sweep share, in memory that stays common after fork().
class SharedState {
 public:
  SharedState();  // throws std::system_error
  ~SharedState();
  SharedState(const SharedState&) = delete;
  SharedState& operator=(const SharedState&) = delete;

  // Set to true to keep every process from beginning another point.
  std::atomic<bool>& stop() const { return page_->stop; }

  // Holds a lock from its construction to its destruction. The constructor waits while another process holds
  // the lock; if that process dies, the lock is free. Used for writes to the database, because SQLite's own
  // wait polls every few milliseconds.
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
