#include "sw/explore/optimise/workers.h"

#include <poll.h>
#include <sys/mman.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <system_error>
#include <vector>

#include "sw/process/child.h"

namespace stereotlm::explore {
namespace {

constexpr int kWorkersPollMs = 20;

// A number that forked processes share.
class SharedCount {
 public:
  SharedCount()
      : memory_(mmap(nullptr, sizeof(std::atomic<std::uint64_t>), PROT_READ | PROT_WRITE,
                     MAP_SHARED | MAP_ANONYMOUS, -1, 0)) {
    if (memory_ == MAP_FAILED) throw std::system_error(errno, std::generic_category(), "mmap");
    count_ = new (memory_) std::atomic<std::uint64_t>(0);
  }
  ~SharedCount() { munmap(memory_, sizeof(std::atomic<std::uint64_t>)); }
  SharedCount(const SharedCount&) = delete;
  SharedCount& operator=(const SharedCount&) = delete;

  std::uint64_t next() { return (*count_)++; }

 private:
  void* memory_;
  std::atomic<std::uint64_t>* count_;
};

}  // namespace

bool do_in_processes(std::size_t count, unsigned processes,
                     const std::function<std::string(std::size_t)>& work,
                     const std::function<void(std::size_t, const std::string&)>& take,
                     const std::function<bool()>& keep_going) {
  SharedCount begun;
  std::vector<std::unique_ptr<process::Child>> workers;
  const auto run = [&](const process::Child::Tell& tell) {
    // Ctrl-C in a terminal, or a job scheduler, reaches all processes. Only the parent process handles it.
    std::signal(SIGINT, SIG_IGN);
    std::signal(SIGTERM, SIG_IGN);
    for (std::uint64_t piece = begun.next(); piece < count; piece = begun.next())
      tell(std::string(reinterpret_cast<const char*>(&piece), sizeof piece) + work(piece));
  };
  for (unsigned i = 0; i < std::min<std::size_t>(processes, count); ++i)
    workers.push_back(std::make_unique<process::Child>(run));
  while (!workers.empty()) {
    if (!keep_going()) return false;
    std::vector<pollfd> watched;
    for (const auto& worker : workers) watched.push_back({worker->descriptor(), POLLIN, 0});
    const int ready = poll(watched.data(), watched.size(), kWorkersPollMs);
    if (ready < 0 && errno != EINTR) throw std::system_error(errno, std::generic_category(), "poll");
    for (std::size_t i = 0; ready > 0 && i < watched.size(); ++i) {
      if (watched[i].revents == 0) continue;
      const auto message = workers[i]->next();
      if (!message) {
        workers[i].reset();
        continue;
      }
      std::uint64_t piece = 0;
      std::memcpy(&piece, message->data(), sizeof piece);
      take(piece, message->substr(sizeof piece));
    }
    workers.erase(std::remove(workers.begin(), workers.end(), nullptr), workers.end());
  }
  return true;
}

}  // namespace stereotlm::explore
