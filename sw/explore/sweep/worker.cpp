#include "sw/explore/sweep/worker.h"

#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstring>
#include <new>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "sw/explore/plan/conditions.h"
#include "sw/explore/plan/figures.h"
#include "sw/explore/store/store_reader.h"

namespace stereotlm::explore {
namespace {

// The kind of the error for which a worker had to stop: the first byte of its pipe.
enum class ErrorKind : char { kOther = 'e', kCondition = 'c' };

void report(int to, ErrorKind kind, const std::string& text) {
  const std::string message = static_cast<char>(kind) + text;
  process::write_all(to, message.data(), message.size());
}

// Renames a figure that has the same path as a key, because both have a column: bridge.posted_words is the
// number of words that the bridge can hold, bridge.posted_words.counted the number of words that it has
// taken.
void take_figures(Figures figures, StoredPoint& row) {
  for (platform::BoardValue& figure : figures.values) {
    const auto is_key = [&figure](const platform::BoardValue& key) { return key.path == figure.path; };
    if (std::any_of(row.keys.begin(), row.keys.end(), is_key)) figure.path += ".counted";
  }
  row.figures = std::move(figures.values);
  row.blame = std::move(figures.blame);
}

StoredPoint row_of(const Point& point) {
  StoredPoint row;
  row.hash = point.hash;
  row.config = point.yaml;
  row.keys = point.values;
  return row;
}

constexpr int kOutOfMemory = 75;  // the exit status of a worker

// Runs in the process of the worker: simulates and stores points.
class PointRunner {
 public:
  explicit PointRunner(const SweepState& state)
      : state_(state),
        conditions_(state.points.conditions()),
        store_(state.options.store, state.options.version, state.options.busy_timeout) {
    if (!state.options.known.empty()) known_.emplace(state.options.known, state.options.version);
  }

  PointEnd run(std::uint64_t number) {
    const Point point = state_.points.point(number);
    if (!conditions_.hold(point.values)) return PointEnd::kExcluded;
    if (store_.has(point.hash) || (known_ && known_->has(point.hash))) return PointEnd::kKnown;
    StoredPoint row = row_of(point);
    PointEnd end = PointEnd::kOk;
    if (!point.board) {
      end = PointEnd::kImpossible;
      row.status = "impossible";
      row.reason = point.reason;
    } else {
      try {
        take_figures(state_.evaluate(point), row);
        row.status = "ok";
      } catch (const GivenUp&) {
        return PointEnd::kGivenUp;
      } catch (const process::EndedBySignal&) {
        throw;
      } catch (const std::system_error&) {
        throw;
      } catch (const std::bad_alloc&) {
        throw;
      } catch (const std::exception& error) {
        end = PointEnd::kFailed;
        row = failed_point(point, error.what());
      }
    }
    const process::SharedLock::Turn turn(state_.writing);
    return store_.add(row) ? end : PointEnd::kKnown;
  }

 private:
  const SweepState& state_;
  Conditions conditions_;
  Store store_;
  std::optional<FinishedStore> known_;
};

// Runs in the process of the worker; returns its exit status.
int run_worker(SweepState& state, std::size_t place, int to) {
  // Ctrl-C in a terminal goes to all processes. Only the parent process, which stops the sweep, handles it.
  signal(SIGINT, SIG_IGN);
  signal(SIGTERM, SIG_DFL);
  try {
    auto claim = state.claims.begin(place);
    if (!claim) return 0;
    PointRunner runner(state);
    for (; claim; claim = state.claims.begin(place))
      state.claims.end(place, runner.run(state.number_of(*claim)));
    return 0;
  } catch (const process::EndedBySignal& error) {
    signal(error.signal(), SIG_DFL);
    raise(error.signal());
    return 1;  // the signal does not end a process by default
  } catch (const std::bad_alloc&) {
    return kOutOfMemory;
  } catch (const ConditionError& error) {
    report(to, ErrorKind::kCondition, error.what());
    return 1;
  } catch (const std::exception& error) {
    report(to, ErrorKind::kOther, error.what());
    return 1;
  }
}

}  // namespace

StoredPoint failed_point(const Point& point, const std::string& reason) {
  StoredPoint row = row_of(point);
  row.status = "failed";
  row.reason = reason;
  return row;
}

Worker::Worker(SweepState& state, std::size_t place)
    : process_([&] {
        error_.close_read_end();
        return run_worker(state, place, error_.write_end());
      }) {
  error_.close_write_end();
}

std::optional<std::string> Worker::wait() {
  std::string error;
  for (char c = 0; process::read_all(descriptor(), &c, 1);) error += c;
  const int status = process_.wait();
  if (WIFSIGNALED(status))
    return fmt::format("ended with signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)));
  if (WEXITSTATUS(status) == 0) return std::nullopt;
  if (WEXITSTATUS(status) == kOutOfMemory) return "run out of memory";
  if (error.empty()) return fmt::format("ended with exit status {}", WEXITSTATUS(status));
  const std::string text = error.substr(1);
  if (error.front() == static_cast<char>(ErrorKind::kCondition)) throw ConditionError(text, text);
  throw std::runtime_error(text);
}

}  // namespace stereotlm::explore
