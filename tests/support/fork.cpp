#include "tests/support/fork.h"

#include <fcntl.h>
#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <system_error>

namespace stereotlm::test {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kFailed = 1;
constexpr int kThrew = 2;
constexpr int kTimedOut = 124;
constexpr int kSignalled = 128;

// A child sends it behind the text when its work has returned. A child that exits early does not.
constexpr char kEnd = '\0';

[[noreturn]] void throw_errno(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

void write_all(int fd, const std::string& text) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t count = write(fd, text.data() + done, text.size() - done);
    if (count > 0) {
      done += static_cast<std::size_t>(count);
    } else if (errno != EINTR) {
      return;  // the parent reports the missing end mark
    }
  }
}

[[noreturn]] void be_child(const ChildWork& work, int fd) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::string text;
  int status = 0;
  {
    // GoogleTest in the parent does not see failures of the child: they are sent with the text.
    testing::TestPartResultArray parts;
    const testing::ScopedFakeTestPartResultReporter reporter(
        testing::ScopedFakeTestPartResultReporter::INTERCEPT_ALL_THREADS, &parts);
    try {
      text = work();
      if (!text.empty()) status = kFailed;
    } catch (const std::exception& exception) {
      text = std::string("exception: ") + exception.what();
      status = kThrew;
    } catch (...) {
      text = "exception of an unknown type";
      status = kThrew;
    }
    for (int i = 0; i < parts.size(); ++i) {
      const auto& part = parts.GetTestPartResult(i);
      if (!part.failed()) continue;
      if (status == 0) status = kFailed;
      if (!text.empty()) text += '\n';
      if (part.file_name() != nullptr)
        text += std::string(part.file_name()) + ":" + std::to_string(part.line_number()) + ": ";
      text += part.message();
    }
  }
  write_all(fd, text + kEnd);
  std::fflush(nullptr);
  _exit(status);
}

struct Child {
  std::size_t job;
  pid_t pid;
  int fd;
  Clock::time_point deadline;
  std::string text;
};

Child start(std::size_t job, const ChildWork& work, std::chrono::milliseconds timeout) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw_errno("pipe2");
  std::fflush(nullptr);  // otherwise both processes write the contents of the buffers
  const pid_t pid = fork();
  if (pid < 0) {
    const int error = errno;
    close(ends[0]);
    close(ends[1]);
    errno = error;
    throw_errno("fork");
  }
  if (pid == 0) {
    close(ends[0]);
    be_child(work, ends[1]);
  }
  close(ends[1]);
  return {job, pid, ends[0], Clock::now() + timeout, {}};
}

// Returns false at the end of the child's text.
bool read_some(Child& child) {
  std::array<char, 4096> buffer{};
  const ssize_t count = read(child.fd, buffer.data(), buffer.size());
  if (count < 0) return errno == EINTR;
  child.text.append(buffer.data(), static_cast<std::size_t>(count));
  return count > 0;
}

int wait_for(pid_t pid) {
  int status = 0;
  while (waitpid(pid, &status, 0) < 0) {
    if (errno != EINTR) throw_errno("waitpid");
  }
  return status;
}

ChildResult finish(Child& child) {
  close(child.fd);
  const int status = wait_for(child.pid);
  const bool complete = !child.text.empty() && child.text.back() == kEnd;
  if (complete) child.text.pop_back();
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    return {kSignalled + signal,
            "killed by signal " + std::to_string(signal) + " (" + strsignal(signal) + ")"};
  }
  const int exit_status = WEXITSTATUS(status);
  if (complete) return {exit_status, child.text};
  return {exit_status == 0 ? kFailed : exit_status,
          "exited with status " + std::to_string(exit_status) + " before its work returned"};
}

ChildResult give_up(Child& child, std::chrono::milliseconds timeout) {
  kill(child.pid, SIGKILL);
  close(child.fd);
  wait_for(child.pid);
  return {kTimedOut, "still running after " + std::to_string(timeout.count()) + " ms"};
}

// Waits until a child has written something or the first deadline passes.
std::vector<pollfd> wait_for_any(const std::vector<Child>& children) {
  std::vector<pollfd> fds;
  auto deadline = Clock::time_point::max();
  for (const auto& child : children) {
    fds.push_back({child.fd, POLLIN, 0});
    deadline = std::min(deadline, child.deadline);
  }
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
  const int wait_ms = static_cast<int>(std::clamp<decltype(left)>(left, 0, 1000));
  if (poll(fds.data(), fds.size(), wait_ms) < 0 && errno != EINTR) throw_errno("poll");
  return fds;
}

}  // namespace

std::string run_for_text(const ChildWork& work) {
  const std::string end = "end of the work";  // failures of expectations come behind it
  std::string text = run_in_child([&] { return work() + end; }).text;
  const bool ended = text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
  EXPECT_TRUE(ended) << text;
  return ended ? text.substr(0, text.size() - end.size()) : text;
}

std::vector<ChildResult> run_in_children(const std::vector<ChildWork>& jobs, int parallel,
                                         std::chrono::milliseconds timeout) {
  if (parallel < 1) {
    throw std::invalid_argument("run_in_children: parallel = " + std::to_string(parallel) +
                                ": must be at least 1");
  }
  std::vector<ChildResult> results(jobs.size(), {kTimedOut, "not begun, because another ran out of time"});
  std::vector<Child> children;
  std::size_t next = 0;
  while (next < jobs.size() || !children.empty()) {
    while (next < jobs.size() && children.size() < static_cast<std::size_t>(parallel)) {
      children.push_back(start(next, jobs[next], timeout));
      ++next;
    }
    const auto fds = wait_for_any(children);
    std::vector<Child> running;
    for (std::size_t i = 0; i < children.size(); ++i) {
      Child& child = children[i];
      if (fds[i].revents != 0 && !read_some(child)) {
        results[child.job] = finish(child);
      } else if (Clock::now() >= child.deadline) {
        results[child.job] = give_up(child, timeout);
        next = jobs.size();
      } else {
        running.push_back(std::move(child));
      }
    }
    children = std::move(running);
  }
  return results;
}

ChildResult run_in_child(const ChildWork& work, std::chrono::milliseconds timeout) {
  return run_in_children({work}, 1, timeout).front();
}

}  // namespace stereotlm::test
