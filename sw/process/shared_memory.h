#pragma once

#include <pthread.h>

#include <cstddef>

namespace stereotlm::process {

// Zeroed memory that stays common to this process and its children after fork().
class SharedMemory {
 public:
  explicit SharedMemory(std::size_t bytes);  // throws std::system_error
  ~SharedMemory();
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;

  void* data() const { return data_; }

 private:
  std::size_t bytes_;
  void* data_;
};

// A lock for the processes that share it after fork(). If the process that holds it dies, the lock is free.
class SharedLock {
 public:
  SharedLock();  // throws std::system_error
  ~SharedLock();
  SharedLock(const SharedLock&) = delete;
  SharedLock& operator=(const SharedLock&) = delete;

  // Holds the lock from its construction to its destruction. The constructor waits while another process
  // holds the lock.
  class Turn {
   public:
    explicit Turn(const SharedLock& lock);
    ~Turn();
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

   private:
    pthread_mutex_t* mutex_;
  };

 private:
  SharedMemory memory_;
  pthread_mutex_t* mutex_;
};

}  // namespace stereotlm::process
