// The records of traces, on random boards and random computers, each in a process of its own. The records are
// the same at each fidelity, and agree with the figures of the run. Records of cycles agree with the
// transactions on the links, records of buses and queues with the plain loop over events.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "models/clock.h"
#include "models/kernel_time.h"
#include "models/testing/probing_binder.h"
#include "platform/config/board_yaml.h"
#include "platform/records/conflicts.h"
#include "sw/runs/simulation/simulation.h"
#include "sw/sqlite/database.h"
#include "sw/trace/trace.h"
#include "tests/support/board_of_random.h"
#include "tests/support/fork.h"
#include "tests/support/perfetto_file.h"
#include "tests/support/plain_computer.h"
#include "tests/support/plain_conflicts.h"
#include "tests/support/random_computer.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/vcd_file.h"

namespace stereotlm::simulation {
namespace {

using fpga::CycleWindow;
using fpga::Fidelity;
using platform::BusBurst;
using platform::QueueLevel;

constexpr std::array kEachFidelity = {Fidelity::kCycle, Fidelity::kFast, Fidelity::kTiming};

// A board alone, or a whole computer.
struct Case {
  platform::BoardConfig board;
  platform::Tables tables;
  test::RandomBoard pictures;
  std::uint64_t frames = 1;
  std::optional<test::PlainComputerInput> computer = std::nullopt;
};

class PicturesOfCase : public host::FrameSource {
 public:
  explicit PicturesOfCase(const Case& of) : of_(of) {}
  const host::StereoPair& pair(std::uint64_t number) override {
    pair_ = of_.computer
                ? test::stereo_pair(of_.pictures, test::camera_pictures(of_.pictures, number))
                : test::stereo_pair(of_.pictures, static_cast<int>(number % of_.pictures.pictures.size()));
    return pair_;
  }

 private:
  const Case& of_;
  host::StereoPair pair_;
};

Case case_of(std::uint64_t seed, bool with_knobs, bool camera) {
  test::RandomKnobs knobs = with_knobs ? test::RandomKnobs::with_section_8() : test::RandomKnobs{};
  knobs.large_images = false;
  if (camera) {
    const test::RandomComputer computer = test::make_random_computer(seed, knobs);
    return {test::board_config(computer), test::board_tables(computer.board), computer.board,
            static_cast<std::uint64_t>(computer.input.frames), computer.input};
  }
  const test::RandomBoard board = test::make_random_board(seed, knobs);
  return {test::board_config(board), test::board_tables(board), board,
          static_cast<std::uint64_t>(board.frames)};
}

class KeptCycles : public fpga::CycleObserver {
 public:
  KeptCycles(bool keeps, trace::Trace& writer) : keeps_(keeps), writer_(writer) {}
  void cycle(const fpga::CoreCycle& cycle) override {
    EXPECT_TRUE(last_ == UINT64_MAX || cycle.cycle > last_) << cycle.cycle << " after " << last_;
    last_ = cycle.cycle;
    writer_.cycle(cycle);
    if (keeps_) cycles.push_back(cycle);
    if (!cycle.frame) return;
    sums.resize(cycle.ports.size());
    for (std::size_t port = 0; port < sums.size(); ++port)
      sums[port].add(cycle.ports[port].intent, cycle.ports[port].granted);
  }

  std::vector<fpga::CoreCycle> cycles;
  std::vector<fpga::PortCycles> sums;  // [port], while frames run

 private:
  bool keeps_;
  trace::Trace& writer_;
  std::uint64_t last_ = UINT64_MAX;
};

// What the buses and queues around the core do.
class KeptBuses : public platform::BusObserver {
 public:
  explicit KeptBuses(trace::Trace& writer) : writer_(writer) {}
  void burst(const BusBurst& burst) override {
    writer_.burst(burst);
    (burst.bus == BusBurst::Bus::kPci ? pci : local).push_back(burst);
  }
  void level(const QueueLevel& level) override {
    writer_.level(level);
    levels[level.queue].push_back(level);
  }

  // With what the plain computer does not have: targets, and addresses of the PCI bus.
  std::string text() const {
    std::string text = plain_part();
    for (const auto* const bursts : {&pci, &local}) {
      for (const BusBurst& burst : *bursts) text += fmt::format("{} {:x}\n", burst.target, burst.address);
    }
    return text;
  }
  std::string plain_part() const {
    std::string text;
    for (const auto* const bursts : {&pci, &local}) {
      for (const BusBurst& burst : *bursts) {
        text += fmt::format("{} {} {:x} {} {} {} {} {}\n", burst.master, burst.write,
                            bursts == &pci ? 0 : burst.address, burst.words, burst.request_ps,
                            burst.address_ps, burst.data_ps, burst.end_ps);
      }
    }
    for (const auto& [queue, of_queue] : levels) {
      for (const QueueLevel& level : of_queue)
        text += fmt::format("{} {} {}\n", queue, level.time_ps, level.words);
    }
    return text;
  }

  std::vector<BusBurst> pci;
  std::vector<BusBurst> local;
  std::map<std::string, std::vector<QueueLevel>> levels;

 private:
  trace::Trace& writer_;
};

// The times of a window.
struct TimeRange {
  std::uint64_t begin_ps = 0;
  std::uint64_t end_ps = UINT64_MAX;
};

// What the plain computer does in a window, as KeptBuses::plain_part().
std::string plain_part_of(const test::PlainComputerResult& plain, const TimeRange& range) {
  constexpr std::array<const char*, 5> kMasters = {"host", "left_capture", "right_capture", "bridge", "load"};
  constexpr std::array<const char*, 4> kSources = {"posted", "read", "dma0", "dma1"};
  std::string text;
  const auto add = [&](const char* name, const test::PlainBusBurst& burst) {
    if (burst.end_ps <= range.begin_ps || burst.request_ps >= range.end_ps) return;
    text += fmt::format("{} {} {:x} {} {} {} {} {}\n", name, burst.write, 4 * burst.word, burst.words,
                        burst.request_ps, burst.address_ps, burst.data_ps, burst.end_ps);
  };
  for (const test::PlainBusBurst& burst : plain.pci_bursts) add(kMasters[burst.source], burst);
  for (const test::PlainBusBurst& burst : plain.local_bursts) add(kSources[burst.source], burst);
  const std::vector<std::pair<const char*, const std::vector<test::PlainLevel>&>> queues = {
      {"left_capture", plain.fifo_levels[0]},
      {"posted", plain.posted_levels},
      {"right_capture", plain.fifo_levels[1]}};
  for (const auto& [queue, levels] : queues) {
    for (const test::PlainLevel& level : levels) {
      if (level.time_ps > range.begin_ps && level.time_ps <= range.end_ps)
        text += fmt::format("{} {} {}\n", queue, level.time_ps, level.words);
    }
  }
  return text;
}

fpga::Requesters requesters_of(const platform::BoardConfig& board) {
  return fpga::Requesters(platform::core_ports(board));
}

// What a trace adds up to: cycles by port, "grants" or "waits", and, of waits, bank and culprit.
using Sums = std::map<std::string, std::uint64_t>;

std::string port_of(const std::string& requester) { return requester.substr(0, requester.find(' ')); }

std::string wait_key(const std::string& requester, const std::string& bank, const std::string& by) {
  return fmt::format("{} waits on {} for {}", port_of(requester), bank, port_of(by));
}

// The frames of the window.
Sums sums_of(const std::vector<platform::FrameRuns>& frames, const CycleWindow& window,
             const platform::BoardConfig& board) {
  const fpga::Requesters requesters = requesters_of(board);
  Sums sums;
  for (const platform::FrameRuns& frame : frames) {
    if (window.frame ? frame.frame != window.frame
                     : frame.end_cycle <= window.first || frame.first_cycle > window.last)
      continue;
    for (const platform::TraceRun& run : frame.runs) {
      const std::string name = requesters.name(run.requester);
      sums[run.by ? wait_key(name, board.banks[run.bank].name, requesters.name(*run.by))
                  : port_of(name) + " grants"] += run.count;
    }
  }
  return sums;
}

Sums sums_of_perfetto(const std::filesystem::path& path, const fpga::Requesters& requesters) {
  const std::string bytes = test::read_file(path);
  const test::PerfettoFile file(bytes);
  Sums sums;
  for (std::size_t requester = 0; requester < requesters.size(); ++requester) {
    const std::string name = requesters.name(requester);
    for (const test::PerfettoFile::Slice& slice : file.slices_of(name)) {
      const std::size_t waits = slice.name.find(" waits ");
      if (waits == std::string::npos) {
        sums[port_of(name) + " grants"] += std::stoull(slice.name.substr(slice.name.rfind('x') + 1));
        continue;
      }
      const std::size_t by = slice.name.find(" for ") + 5;
      const std::size_t bank = slice.name.rfind(" on ");
      sums[wait_key(name, slice.name.substr(bank + 4), slice.name.substr(by, bank - by))] +=
          std::stoull(slice.name.substr(waits + 7));
    }
  }
  return sums;
}

Sums sums_of_sqlite(const std::filesystem::path& path) {
  sqlite::Database database(path.string(), sqlite::Database::Access::kRead);
  EXPECT_EQ(database.number("SELECT count(*) FROM pragma_integrity_check WHERE integrity_check = 'ok'"), 1);
  Sums sums;
  sqlite::Statement runs(database, "SELECT port, bank, by, count FROM runs");
  while (runs.step()) {
    const std::string by = runs.text(2);
    const std::string key =
        by.empty() ? port_of(runs.text(0)) + " grants" : wait_key(runs.text(0), runs.text(1), by);
    sums[key] += static_cast<std::uint64_t>(runs.integer(3));
  }
  return sums;
}

// The cycles of the ports of the core, by their states. A waveform shows no difference between a cycle in
// which a port is idle and one in which no frame runs.
Sums states_of_vcd(const std::filesystem::path& path, const platform::BoardConfig& board) {
  const Clock clock(board.fpga.clock_mhz);
  const test::VcdFile file(test::read_file(path));
  Sums sums;
  const fpga::CorePorts ports = platform::core_ports(board);
  for (std::size_t port = 0; port < ports.core_size(); ++port) {
    const std::string name = ports.name(port);
    if (file.signals().count(name + ".state") == 0) continue;
    const std::map<std::uint64_t, std::string>& states = file.changes(name + ".state");
    for (auto state = states.begin(); state != states.end(); ++state) {
      if (state->second == "idle") continue;
      const auto next = std::next(state);
      if (next == states.end()) throw std::runtime_error(name + " is not idle in the end");
      const bool is_access = state->second == "reads" || state->second == "writes";
      sums[name + ' ' + (is_access ? "accesses" : state->second)] +=
          clock.edge_at_or_after(next->first) - clock.edge_at_or_after(state->first);
    }
  }
  return sums;
}

Sums states_of(const platform::Statistics& statistics) {
  Sums sums;
  for (std::size_t port = 0; port + 1 < statistics.ports.size(); ++port) {
    const platform::PortStatistics& its = statistics.ports[port];
    sums[its.name + " accesses"] = its.grants;
    sums[its.name + " waits"] = its.stall_cycles;
    sums[its.name + " passes"] = its.passed_cycles;
    sums[its.name + " blocked"] = its.blocked_cycles;
    sums[its.name + " starved"] = its.starved_cycles;
  }
  return sums;
}

std::string differences(const std::string& name, const Sums& found, const Sums& expected) {
  std::string text;
  for (const Sums* all : {&found, &expected}) {
    for (const auto& [key, unused] : *all) {
      const auto value = [key = key](const Sums& sums) {
        const auto place = sums.find(key);
        return place == sums.end() ? 0 : place->second;
      };
      if (value(found) != value(expected))
        text += fmt::format("{}: {} = {}, expected {}\n", name, key, value(found), value(expected));
    }
  }
  return text;
}

struct Traced {
  std::vector<platform::FrameRuns> runs;
  std::vector<fpga::CoreCycle> cycles;
  std::vector<fpga::PortCycles> sums;                                       // [port]
  std::vector<std::pair<std::string, std::vector<test::SeenAccess>>> seen;  // of each link
  platform::Statistics statistics;
  std::string buses;
  std::string waveform;  // the text of the vcd
  std::string wrong_files;
};

Traced trace(const Case& of, Fidelity fidelity, const CycleWindow& window, bool keeps_cycles,
             bool writes_files) {
  test::ProbingBinder binder("crossbar");
  PicturesOfCase pictures(of);
  const std::unique_ptr<runs::Simulation> simulation =
      runs::make_simulation(of.board, of.tables, pictures,
                            {of.computer.has_value(), fidelity, of.frames, runs::kAllFrames}, binder);
  const test::ScratchFolder scratch;
  std::vector<trace::TraceFile> files;
  std::map<std::string, std::string> paths;  // by format
  for (const trace::TraceFormat& format : trace::kTraceFormats) {
    if (!writes_files && !format.needs_window) continue;
    paths[format.name] = scratch.path() / format.name;
    files.push_back({&format, paths[format.name]});
  }
  trace::Trace writer(files, of.board, trace::TraceWindow{window});
  KeptCycles cycles(keeps_cycles, writer);
  KeptBuses buses(writer);
  simulation->trace(window, cycles, buses);
  TimeRange range;
  const Clock clock(of.board.fpga.clock_mhz);
  if (!keeps_cycles)
    range = {};  // of the whole run
  else if (!window.frame)
    range = {clock.edge_ps(window.first), clock.edge_ps(window.last + 1)};
  Traced traced;
  simulation->run([&] {
    for (const fpga::FrameConflicts& frame : simulation->take_conflicts()) {
      traced.runs.push_back(platform::frame_runs(frame));
      writer.frame(traced.runs.back());
    }
    const platform::TimelineRecords records = simulation->take_timeline();
    writer.events(records);
    for (const platform::TimelineEvent& event : records.events) {
      if (event.kind != platform::EventKind::kFrame || !window.frame || event.frame != window.frame) continue;
      if (event.what == std::string("strobe")) range.begin_ps = event.begin_ps;
      range.end_ps = event.end_ps;
    }
  });
  writer.complete();
  writer.commit();
  traced.cycles = std::move(cycles.cycles);
  traced.sums = cycles.sums;
  for (const auto& [link, probe] : binder.probes()) traced.seen.emplace_back(link, probe->accesses());
  traced.statistics = simulation->statistics();
  traced.buses = buses.text();
  if (of.computer && fidelity == Fidelity::kCycle)
    traced.wrong_files += test::differing_lines(plain_part_of(test::run_plain_computer(*of.computer), range),
                                                buses.plain_part());
  if (keeps_cycles) {
    traced.waveform = test::read_file(paths["vcd"]);
  } else {  // all cycles are in the window
    traced.wrong_files +=
        differences("vcd", states_of_vcd(paths["vcd"], of.board), states_of(traced.statistics));
  }
  if (!writes_files) return traced;
  const Sums expected = sums_of(traced.runs, window, of.board);
  traced.wrong_files +=
      differences("perfetto", sums_of_perfetto(paths["perfetto"], requesters_of(of.board)), expected) +
      differences("sqlite", sums_of_sqlite(paths["sqlite"]), expected);
  return traced;
}

std::string text_of(const platform::FrameRuns& frame, const fpga::Requesters& requesters) {
  std::string text = fmt::format("frame {}: {}..{}\n", frame.frame, frame.first_cycle, frame.end_cycle);
  for (const platform::TraceRun& run : frame.runs) {
    text += fmt::format("{} {}..{} {} {} {} {}\n", run.strip, run.first_cycle, run.end_cycle,
                        requesters.name(run.requester), run.bank,
                        run.by ? requesters.name(*run.by) : "granted", run.count);
  }
  return text;
}

std::string text_of(const fpga::CoreCycle& cycle) {
  std::string text = fmt::format("{} {}", cycle.cycle, cycle.frame ? std::to_string(*cycle.frame) : "-");
  for (const fpga::PortCycle& port : cycle.ports) {
    text += fmt::format(" | {} {} {} {} {} {}", static_cast<int>(port.intent), port.granted, port.bank,
                        port.address, port.by, port.item);
  }
  return text + fmt::format(" | {} {} {} {}\n", static_cast<int>(cycle.host_traffic),
                            fmt::join(cycle.lane_slots, " "), cycle.result_words, cycle.works);
}

std::string text_of(const Traced& traced, const fpga::Requesters& requesters) {
  std::string text;
  for (const platform::FrameRuns& frame : traced.runs) text += text_of(frame, requesters);
  for (const fpga::CoreCycle& cycle : traced.cycles) text += text_of(cycle);
  return text + traced.buses + traced.waveform;
}

// What a window, the whole run or a part of it, adds up to.
std::string wrong_sums(const Traced& traced, bool whole_run, const fpga::Requesters& requesters) {
  std::string text;
  const auto compare = [&text](const std::string& name, std::uint64_t found, std::uint64_t expected) {
    if (found != expected) text += fmt::format("{} = {}, expected {}\n", name, found, expected);
  };
  const auto count = [&traced](const auto& wanted) {
    std::uint64_t cycles = 0;
    for (const platform::FrameRuns& frame : traced.runs) {
      for (const platform::TraceRun& run : frame.runs) cycles += wanted(run) ? run.count : 0;
    }
    return cycles;
  };
  const auto& statistics = traced.statistics;
  for (std::size_t port = 0; port < statistics.ports.size(); ++port) {
    const platform::PortStatistics& of_port = statistics.ports[port];
    const auto is_of_port = [&](std::size_t requester) {
      return requesters.is_requester(requester) && requesters.port_of(requester) == port;
    };
    compare(of_port.name + " granted in the runs",
            count([&](const auto& run) { return is_of_port(run.requester) && !run.by; }), of_port.grants);
    compare(of_port.name + " stalled in the runs",
            count([&](const auto& run) { return is_of_port(run.requester) && run.by; }),
            of_port.stall_cycles);
    if (!whole_run) continue;
    const fpga::PortCycles& sums = traced.sums.at(port);
    compare(of_port.name + " granted", sums.granted(), of_port.grants);
    compare(of_port.name + " stalled", sums.stalled(), of_port.stall_cycles);
    compare(of_port.name + " passed", sums.passed(), of_port.passed_cycles);
    compare(of_port.name + " blocked", sums.blocked(), of_port.blocked_cycles);
    compare(of_port.name + " starved", sums.starved(), of_port.starved_cycles);
    compare(of_port.name + " idle", sums.idle(), of_port.idle_cycles);
  }
  for (std::size_t bank = 0; bank < statistics.banks.size(); ++bank) {
    compare(statistics.banks[bank].name + " accesses in the runs",
            count([&](const auto& run) { return run.bank == bank && !run.by; }),
            statistics.banks[bank].reads + statistics.banks[bank].writes);
  }
  for (const platform::BlameRow& row : statistics.blame) {
    const auto is_of_row = [&](const platform::TraceRun& run) {
      if (!run.by || statistics.banks[run.bank].name != row.bank) return false;
      const auto name = [&](std::size_t cause) {
        return requesters.is_requester(cause) ? requesters.ports().name(requesters.port_of(cause))
                                              : requesters.name(cause);
      };
      return name(run.requester) == row.port && name(*run.by) == row.by;
    };
    compare(row.port + " on " + row.bank + " for " + row.by, count(is_of_row), row.cycles);
  }
  for (const std::string& failed : statistics.failed) text += failed + '\n';
  return text;
}

// The accesses in the window, as the links saw them and as the trace has them.
std::string wrong_accesses(const Case& of, const Traced& traced) {
  if (traced.cycles.empty()) return {};
  const Clock clock(of.board.fpga.clock_mhz);
  const std::uint64_t first = traced.cycles.front().cycle;
  const std::uint64_t last = traced.cycles.back().cycle;
  constexpr std::uint64_t kInBank = (std::uint64_t{1} << 28U) - 1;
  const fpga::CorePorts ports = platform::core_ports(of.board);
  std::vector<std::string> seen;
  for (const auto& [link, accesses] : traced.seen) {
    for (const test::SeenAccess& each : accesses) {
      const std::uint64_t cycle = clock.edge_at_or_after(kernel_time::to_ps(each.begin) + 1) - 1;
      if (cycle < first || cycle > last) continue;
      seen.push_back(fmt::format("{} {} {} {:x}", cycle, link, each.write, each.address & kInBank));
    }
  }
  std::vector<std::string> expected;
  for (const fpga::CoreCycle& cycle : traced.cycles) {
    for (std::size_t port = 0; port < cycle.ports.size(); ++port) {
      const fpga::PortCycle& access = cycle.ports[port];
      if (!access.granted) continue;
      const bool write =
          port == ports.host() ? cycle.host_traffic != fpga::HostTraffic::kReadBack : ports.group(port).write;
      std::string name = ports.name(port);
      std::replace(name.begin(), name.end(), '.', '_');
      for (const std::string& link : {fmt::format("{}_to_crossbar", name),
                                      fmt::format("crossbar_to_{}", of.board.banks[access.bank].name)})
        expected.push_back(fmt::format("{} {} {} {:x}", cycle.cycle, link, write, access.address));
    }
  }
  std::sort(seen.begin(), seen.end());
  std::sort(expected.begin(), expected.end());
  std::vector<std::string> wrong;
  std::set_symmetric_difference(seen.begin(), seen.end(), expected.begin(), expected.end(),
                                std::back_inserter(wrong));
  if (wrong.empty()) return {};
  return fmt::format("{} accesses differ of {} seen and {} traced, such as {}\n", wrong.size(), seen.size(),
                     expected.size(), fmt::join(wrong.begin(), wrong.begin() + 8, "; "));
}

// Windows of all kinds, also some in which nothing happens.
CycleWindow random_window(std::uint64_t seed, const Case& of, std::uint64_t cycles_of_frame) {
  std::mt19937_64 random(seed);
  const auto draw = [&random](std::uint64_t end) { return random() % std::max<std::uint64_t>(end, 1); };
  CycleWindow window;
  const std::uint64_t kind = draw(3);
  if (kind != 0) window.frame = draw(of.frames);
  if (kind == 1) {
    window.unit = CycleWindow::Unit::kRows;
    window.first = draw(static_cast<std::uint64_t>(of.board.image.height));
    window.last = window.first + draw(4);
  } else {
    const double cycles_of_run = of.computer
                                     ? static_cast<double>(of.frames + 1) / of.board.cameras.frame_rate_hz *
                                           1e6 * of.board.fpga.clock_mhz
                                     : static_cast<double>(cycles_of_frame * of.frames);
    window.first = draw(kind == 0 ? static_cast<std::uint64_t>(cycles_of_run) : cycles_of_frame);
    window.last = window.first + draw(3000);
  }
  return window;
}

std::string problems_of(std::uint64_t seed, bool with_knobs, bool camera) {
  const Case of = case_of(seed, with_knobs, camera);
  const bool whole_run = seed % 4 == 0;
  CycleWindow window;
  if (!whole_run) {
    window = random_window(seed, of,
                           static_cast<std::uint64_t>(of.board.image.width * of.board.image.height) *
                               static_cast<std::uint64_t>(of.board.matcher.window));
  }
  std::string problems;
  const fpga::Requesters requesters = requesters_of(of.board);
  const auto run = [&](Fidelity fidelity) {
    const bool writes_files = fidelity == kEachFidelity[seed % kEachFidelity.size()];  // which takes long
    return [&, fidelity, writes_files]() -> std::string {
      const Traced traced = trace(of, fidelity, window, !whole_run, writes_files);
      std::string wrong = wrong_sums(traced, whole_run, requesters) + traced.wrong_files;
      if (fidelity == Fidelity::kCycle) wrong += wrong_accesses(of, traced);
      return wrong.empty() ? text_of(traced, requesters) : "WRONG\n" + wrong;
    };
  };
  std::vector<std::string> texts;
  for (const Fidelity fidelity : kEachFidelity) {
    const test::ChildResult result = test::run_in_child(run(fidelity), std::chrono::seconds(120));
    if (result.exit_status != 1 || result.text.rfind("WRONG", 0) == 0)
      problems += fmt::format("fidelity {}: {}\n", static_cast<int>(fidelity), result.text);
    texts.push_back(result.text);
  }
  for (std::size_t index = 1; problems.empty() && index < texts.size(); ++index) {
    if (texts[index] == texts[0]) continue;
    const auto a =
        std::mismatch(texts[0].begin(), texts[0].end(), texts[index].begin(), texts[index].end()).first;
    const auto begin = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, a - texts[0].begin() - 200));
    problems += fmt::format("fidelity {} differs from cycle:\n{}\n--- is\n{}\n",
                            static_cast<int>(kEachFidelity[index]), texts[0].substr(begin, 500),
                            texts[index].substr(begin, 500));
  }
  if (problems.empty()) return problems;
  return problems +
         fmt::format("window: frame {} unit {} {}..{}\n", window.frame ? int(*window.frame) : -1,
                     static_cast<int>(window.unit), window.first, window.last) +
         platform::to_yaml(of.board);
}

// [with knobs, whole computers]
class RandomTraces : public testing::TestWithParam<std::tuple<bool, bool>> {};

TEST_P(RandomTraces, EqualTheCountersAndTheTransactionsAtEachFidelity) {
  const auto [with_knobs, camera] = GetParam();
  std::vector<test::ChildWork> jobs;
  const std::uint64_t count = camera ? test::random_computers(24) : test::random_boards(24);
  for (std::uint64_t seed = 0; seed < count; ++seed) {
    jobs.push_back(
        [seed, with_knobs = with_knobs, camera = camera] { return problems_of(seed, with_knobs, camera); });
  }
  const int parallel = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  const std::vector<test::ChildResult> results =
      test::run_in_children(jobs, parallel, std::chrono::seconds(400));
  for (std::size_t seed = 0; seed < results.size(); ++seed)
    EXPECT_TRUE(results[seed].ok()) << "seed " << seed << ":\n" << results[seed].text;
}

INSTANTIATE_TEST_SUITE_P(Drawn, RandomTraces, testing::Combine(testing::Bool(), testing::Bool()),
                         [](const auto& suite) {
                           return std::string(std::get<1>(suite.param) ? "Computers" : "Boards") +
                                  (std::get<0>(suite.param) ? "WithKnobs" : "");
                         });

}  // namespace
}  // namespace stereotlm::simulation
