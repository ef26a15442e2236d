#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "models/memory/memory_config.h"
#include "sw/process/command.h"
#include "sw/trace/change_stream.h"
#include "sw/trace/trace_board.h"
#include "sw/trace/trace_sink.h"

namespace stereotlm::trace {
namespace {

namespace fs = std::filesystem;
using fpga::CoreCycle;
using fpga::PortCycle;
using platform::BusBurst;

constexpr const char* kVcdMark = "$version stereotlm $end\n$timescale 1 ps $end\n";
constexpr const char* kLayoutMark = "[*] stereotlm";  // a comment for GTKWave
constexpr unsigned kBusAddressBits = 32;
constexpr unsigned kCountBits = 16;
static_assert(fpga::kLaneFifoRule.max < 1 << kCountBits && fpga::kResultFifoRule.max < 1 << kCountBits);

// Values of a signal while it has no number, and before its first change in the window.
constexpr std::uint32_t kNoNumber = UINT32_MAX;
constexpr std::uint32_t kUnknown = UINT32_MAX - 1;
constexpr std::size_t kNoSignal = SIZE_MAX;

enum class Group : std::uint8_t { kBanks, kPorts, kQueues, kBuses };
constexpr std::array<const char*, 4> kGroupNames = {"banks", "ports", "queues", "buses"};
constexpr std::array<const char*, 2> kBusNames = {"pci", "local_bus"};  // [BusBurst::Bus]
// The queues of the computer, as QueueLevel names them, and the names of their signals.
constexpr std::array<std::array<const char*, 2>, 3> kQueues = {
    {{"left_capture", "fifo"}, {"right_capture", "fifo"}, {"posted", "words"}}};

// Indices of the signals of a port, a bank, the queues of the core and a bus, from the first one on. A bank
// with separate ports has two owners.
enum PortSignal : std::uint8_t { kState, kBank, kAddress, kWaitsFor };
enum BankSignal : std::uint8_t { kRequests, kOwner, kWriteOwner };
enum QueueSignal : std::uint8_t { kLeftLane, kRightLane, kResults, kWorks };
enum BusSignal : std::uint8_t { kBusOwner, kPhase, kDirection, kTarget, kBusAddress };

// A signal of a waveform. Its value is a number, or the number of a word.
struct Signal {
  Group group = Group::kBanks;
  std::string scope;
  std::string name;
  unsigned bits = 0;       // 0: its values are words
  std::uint32_t idle = 0;  // its value outside of the window
  std::string code;        // its name in the file

  std::string range(const char* before) const {
    return bits > 1 ? fmt::format("{}[{}:0]", before, bits - 1) : "";
  }
};

struct Signals {
  explicit Signals(const TraceBoard& board) {
    unsigned request_bits = 1;
    while (board.ports().size() >> request_bits != 0) ++request_bits;
    for (std::size_t bank = 0; bank < board.banks.size(); ++bank) {
      std::string name = board.bank_texts[bank];
      std::replace(name.begin(), name.end(), ' ', '_');
      banks.push_back(add(Group::kBanks, name, "requests", request_bits, 0));
      const bool is_separate = board.has_separate_ports(bank);
      add_words(Group::kBanks, name, {{is_separate ? "read_owner" : "owner", "-"}});
      if (is_separate) add_words(Group::kBanks, name, {{"write_owner", "-"}});
    }
    unsigned address_bits = 1;  // of a byte address in the largest bank
    for (const platform::BankConfig& bank : board.banks) {
      while (std::uint64_t{1} << address_bits < 4 * static_cast<std::uint64_t>(bank.words)) ++address_bits;
    }
    ports.resize(board.ports().size(), kNoSignal);
    for (std::size_t port = 0; port < ports.size(); ++port) {
      if (!fpga::has_group(board.core, board.ports().group_of(port))) continue;
      const std::string name = board.ports().name(port);
      ports[port] = add_words(Group::kPorts, name, {{"state", "idle"}, {"bank", "-"}});
      add(Group::kPorts, name, "address", address_bits, kUnknown);
      add_words(Group::kPorts, name, {{"waits_for", "-"}});
    }
    host_traffic = add_words(Group::kPorts, "host", {{"traffic", "-"}});
    queues = add(Group::kQueues, "left_lane", "slots", kCountBits, 0);
    add(Group::kQueues, "right_lane", "slots", kCountBits, 0);
    add(Group::kQueues, "results", "words", kCountBits, 0);
    add(Group::kQueues, "matcher", "works", 1, 0);
    core_size = all.size();
    for (std::size_t bus = 0; bus < buses.size(); ++bus) {
      buses[bus] = add_words(Group::kBuses, kBusNames[bus],
                             {{"owner", "-"}, {"phase", "idle"}, {"direction", "-"}, {"target", "-"}});
      add(Group::kBuses, kBusNames[bus], "address", kBusAddressBits, kNoNumber);
    }
    levels = all.size();
    for (const auto& [scope, name] : kQueues) add(Group::kQueues, scope, name, kCountBits, kUnknown);
  }

  // The number of a word, which is added if it is new. A space becomes an underscore, because a word of a
  // waveform has none.
  std::uint32_t word(std::string_view text) {
    std::string word(text);
    std::replace(word.begin(), word.end(), ' ', '_');
    const auto [entry, is_new] = numbers.try_emplace(word, static_cast<std::uint32_t>(words.size()));
    if (is_new) words.push_back(word);
    return entry->second;
  }

  std::vector<Signal> all;  // in the order of the file: the signals of a scope follow each other
  std::vector<std::string> words;
  std::unordered_map<std::string, std::uint32_t> numbers;  // of words
  std::size_t core_size = 0;                               // the signals of the core come first
  // The first signals of each.
  std::vector<std::size_t> banks;
  std::vector<std::size_t> ports;  // kNoSignal: the port does not exist
  std::size_t host_traffic = 0;
  std::size_t queues = 0;
  std::array<std::size_t, kBusNames.size()> buses{};
  std::size_t levels = 0;

 private:
  std::size_t add(Group group, const std::string& scope, const std::string& name, unsigned bits,
                  std::uint32_t idle) {
    constexpr std::size_t kCodes = 94;  // printable characters without the space
    std::string code;
    for (std::size_t number = all.size();; number = number / kCodes - 1) {
      code += static_cast<char>('!' + number % kCodes);
      if (number < kCodes) break;
    }
    all.push_back({group, scope, name, bits, idle, code});
    return all.size() - 1;
  }
  // Signals of words: their names and idle values. Returns the first of them.
  std::size_t add_words(Group group, const std::string& scope,
                        std::initializer_list<std::array<const char*, 2>> signals) {
    const std::size_t first = all.size();
    for (const auto& [name, idle] : signals) add(group, scope, name, 0, word(idle));
    return first;
  }
};

struct Span {
  std::uint64_t first_ps = 0;
  std::uint64_t last_ps = 0;
  std::optional<std::uint64_t> wait_ps;  // as in TimeSpan
  std::set<std::string> active_scopes;   // scopes with a signal that has had another value than its idle one
};

// Writes the changes of all streams in the order of their times, as a value change dump of IEEE 1364. If a
// signal changes several times at one ps, only the last change is written.
//
// The file begins and ends with the window, or with the last change if the window has no end. The last change
// of a signal before the window sets its first value. Changes after the end of the window are left out.
class Waveform {
 public:
  Waveform(files::OutputFile& file, const Signals& signals)
      : file_(file), signals_(signals), is_touched_(signals.all.size()), is_active_(signals.all.size()) {
    for (const Signal& signal : signals.all) {
      next_values_.push_back(signal.idle);
      line_ends_.push_back((signal.bits == 1 ? "" : " ") + signal.code + '\n');
    }
    values_ = next_values_;
  }

  Span write(std::deque<ChangeStream>& streams, const TimeSpan& window) {
    write_header();
    for (ChangeStream& stream : streams) stream.rewind();
    take_up_to(window.begin_ps, streams);
    write_time(window.begin_ps);
    text_ += "$dumpvars\n";
    values_ = next_values_;
    for (std::size_t signal = 0; signal < values_.size(); ++signal) write_value(signal);
    text_ += "$end\n";
    while (true) {
      std::uint64_t time_ps = UINT64_MAX;
      for (const ChangeStream& stream : streams) {
        if (stream.change() != nullptr) time_ps = std::min(time_ps, stream.change()->time_ps);
      }
      if (time_ps == UINT64_MAX || time_ps > window.end_ps) break;
      take_up_to(time_ps, streams);
      write_changes(time_ps);
    }
    if (window.end_ps != UINT64_MAX && window.end_ps != last_ps_) write_time(window.end_ps);
    file_.write(text_);
    Span span = {window.begin_ps, last_ps_, window.wait_ps, {}};
    for (std::size_t signal = 0; signal < is_active_.size(); ++signal) {
      if (is_active_[signal] != 0) span.active_scopes.insert(signals_.all[signal].scope);
    }
    return span;
  }

 private:
  // The ports of the lanes are scopes in that of their port group: "left_lut.0" is scope 0 of left_lut.
  void write_header() {
    text_ = kVcdMark;
    std::vector<std::string> open;
    for (const Signal& signal : signals_.all) {
      std::vector<std::string> scopes = {signal.scope};
      if (const std::size_t point = signal.scope.find('.'); point != std::string::npos)
        scopes = {signal.scope.substr(0, point), signal.scope.substr(point + 1)};
      const auto [outer, begin] = std::mismatch(open.begin(), open.end(), scopes.begin(), scopes.end());
      for (auto scope = outer; scope != open.end(); ++scope) text_ += "$upscope $end\n";
      for (auto scope = begin; scope != scopes.end(); ++scope) text_ += "$scope module " + *scope + " $end\n";
      open = scopes;
      text_ += fmt::format("$var {} {} {} {}{} $end\n", signal.bits == 0 ? "string" : "wire",
                           std::max(signal.bits, 1U), signal.code, signal.name, signal.range(" "));
    }
    for (std::size_t scope = 0; scope < open.size(); ++scope) text_ += "$upscope $end\n";
    text_ += "$enddefinitions $end\n";
  }

  void take_up_to(std::uint64_t time_ps, std::deque<ChangeStream>& streams) {
    for (const std::uint32_t signal : touched_) is_touched_[signal] = 0;
    touched_.clear();
    for (ChangeStream& stream : streams) {
      for (; stream.change() != nullptr && stream.change()->time_ps <= time_ps; stream.advance()) {
        const ChangeStream::Change& change = *stream.change();
        next_values_[change.signal] = change.value;
        if (is_touched_[change.signal] == 0) touched_.push_back(change.signal);
        is_touched_[change.signal] = 1;
      }
    }
  }

  void write_changes(std::uint64_t time_ps) {
    bool has_time = false;
    for (const std::uint32_t signal : touched_) {
      if (values_[signal] == next_values_[signal]) continue;
      if (!has_time) write_time(time_ps);
      has_time = true;
      values_[signal] = next_values_[signal];
      write_value(signal);
    }
  }

  void write_time(std::uint64_t time_ps) {
    file_.write(text_);
    text_.clear();
    last_ps_ = time_ps;
    const fmt::format_int digits(time_ps);
    text_.append("#").append(digits.data(), digits.size()) += '\n';
  }

  void write_value(std::size_t signal) {
    const std::uint32_t value = values_[signal];
    const unsigned bits = signals_.all[signal].bits;
    if (value != signals_.all[signal].idle) is_active_[signal] = 1;
    if (bits == 0) {
      text_.append("s").append(signals_.words[value]);
    } else if (value >= kUnknown) {
      text_ += value == kNoNumber ? "bz" : "bx";
    } else {
      std::array<char, 33> digits{};  // and a letter before them
      char* first = digits.end();
      for (std::uint32_t rest = value; rest != 0 || first == digits.end(); rest >>= 1U)
        *--first = (rest & 1U) != 0 ? '1' : '0';
      if (bits > 1) *--first = 'b';
      text_.append(first, digits.end());
    }
    text_ += line_ends_[signal];
  }

  files::OutputFile& file_;
  const Signals& signals_;
  std::vector<std::string> line_ends_;  // [signal]
  std::vector<std::uint32_t> values_;   // [signal]
  std::vector<std::uint32_t> next_values_;
  std::vector<char> is_touched_;
  std::vector<char> is_active_;  // [signal]: has had another value than its idle one
  std::vector<std::uint32_t> touched_;
  std::string text_;  // of the last time
  std::uint64_t last_ps_ = 0;
};

// Flags of a line, from GTKWave's analyzer.h.
constexpr unsigned kHex = 0x2;
constexpr unsigned kDecimal = 0x4;
constexpr unsigned kRight = 0x20;
constexpr unsigned kBlank = 0x200;
constexpr unsigned kAscii = 0x800;
constexpr unsigned kGroupBegin = 0x800000;
constexpr unsigned kGroupEnd = 0x1000000;

// Numbers of GTKWave's colours.
enum Color : unsigned { kNormal = 0, kOrange = 2, kYellow = 3, kGreen = 4, kIndigo = 6 };

Color color_of(const Signal& signal) {
  if (signal.name == "state" || signal.name == "phase") return kYellow;
  if (signal.name == "waits_for") return kOrange;
  if (signal.bits == 0) return kGreen;
  return signal.name == "address" ? kIndigo : kNormal;
}

unsigned flags_of(const Signal& signal) {
  if (signal.bits == 0) return kAscii | kRight;
  return (signal.name == "address" ? kHex : kDecimal) | kRight;
}

std::string line_of(const Signal& signal) {
  // The name in braces is shown. Of a name with a point, GTKWave would show the part behind it.
  return fmt::format("[color] {0}\n@{1:x}\n+{{{2} {3}}} {2}.{3}{4}\n",
                     static_cast<unsigned>(color_of(signal)), flags_of(signal), signal.scope, signal.name,
                     signal.range(""));
}

// The exponent of the zoom with which the span fills some 990 pixels: 200 pixels show 2^-zoom units of time.
double zoom_of(const Span& span) {
  constexpr double kParts = 4.95;
  return -std::log2(static_cast<double>(std::max<std::uint64_t>(span.last_ps - span.first_ps, 1)) / kParts);
}

// A save file of GTKWave for the waveform file of this name in the same folder: the signals of all banks,
// ports, queues and buses that do something in the window, in groups, words as text, the span fitted to the
// window, and the marker where the longest wait begins.
std::string layout_of(const std::string& file_name, const Signals& signals, const Span& span) {
  std::string text = fmt::format(
      "{}\n[dumpfile] \"{}\"\n[timestart] {}\n[size] 1400 900\n[pos] -1 -1\n*{:.6f} {}", kLayoutMark,
      file_name, span.first_ps, zoom_of(span), span.wait_ps ? fmt::to_string(*span.wait_ps) : "-1");
  constexpr int kMarkers = 26;
  for (int marker = 0; marker < kMarkers; ++marker) text += " -1";
  text += "\n[sst_width] 60\n[signals_width] 290\n[sst_expanded] 0\n";
  for (std::size_t group = 0; group < kGroupNames.size(); ++group) {
    fmt::format_to(std::back_inserter(text), "@{:x}\n-{}\n", kGroupBegin | kBlank, kGroupNames[group]);
    for (const Signal& signal : signals.all) {
      if (static_cast<std::size_t>(signal.group) == group && span.active_scopes.count(signal.scope) != 0)
        text += line_of(signal);
    }
    fmt::format_to(std::back_inserter(text), "@{:x}\n-{}\n", kGroupEnd | kBlank, kGroupNames[group]);
  }
  return text;
}

// Returns the path, for which vcd2fst is needed if it ends in ".fst".
const fs::path& checked_path(const fs::path& path) {
  if (path.extension() == ".gtkw")
    throw std::runtime_error(fmt::format(
        "'{}': must not end in .gtkw: that is the file with the layout of the waveform", path.string()));
  if (path.extension() != ".fst") return path;
  try {
    process::run_command({"vcd2fst", "--help"});
  } catch (const process::CommandMissing&) {
    throw std::runtime_error(fmt::format(
        "{}: FST is written by the program vcd2fst, which is not installed: install the package gtkwave, or "
        "give a path that ends in .vcd",
        path.string()));
  }
  return path;
}

files::FileKind kind_of(bool is_fst) {
  using namespace std::string_literals;
  if (!is_fst) return files::marked_kind("waveform of stereotlm", {{0, kVcdMark}});
  // The kind and the length of the header, and in it the name of the writer, which fills its field.
  constexpr std::size_t kPlaceOfWriter = 74;
  constexpr std::size_t kBytesOfWriter = 128;
  std::string writer = "stereotlm";
  writer.resize(kBytesOfWriter);
  return files::marked_kind("waveform of stereotlm",
                            {{0, "\0\0\0\0\0\0\0\1\x49"s}, {kPlaceOfWriter, writer}});
}

files::FileKind layout_kind() {
  return files::marked_kind("layout of stereotlm", {{0, std::string(kLayoutMark) + "\n"}});
}

// Whether a file is there that GTKWave has saved, or somebody else.
bool is_of_user(const fs::path& layout) {
  std::error_code none;
  return fs::is_regular_file(layout, none) && fs::file_size(layout, none) > 0 &&
         !layout_kind().is_own(layout);
}

class VcdSink : public TraceSink {
 public:
  VcdSink(const fs::path& path, const platform::BoardConfig& board)
      : path_(checked_path(path)), is_fst_(path.extension() == ".fst"), board_(board), signals_(board_) {
    files_.emplace_back(path, kind_of(is_fst_));
    const fs::path layout = fs::path(path).replace_extension(".gtkw");
    if (!is_of_user(layout)) files_.emplace_back(layout, layout_kind());
    const fs::path beside = files::linked_file(path);
    for (std::size_t stream = 0; stream < 1 + kBusNames.size() + kQueues.size(); ++stream)
      streams_.emplace_back(beside);
    for (std::size_t signal = 0; signal < signals_.core_size; ++signal)
      idle_.push_back(signals_.all[signal].idle);
    shown_ = idle_;
    // In the order of fpga::Intent. A request that is not granted waits.
    for (const char* intent : {"waits", "passes", "idle", "blocked", "starved"})
      intents_.push_back(signals_.word(intent));
    for (const std::string& name : board_.requester_names) requesters_.push_back(signals_.word(name));
    for (const std::string& bank : board_.bank_texts) banks_.push_back(signals_.word(bank));
    for (const char* traffic : {"capture", "upload", "read-back"})
      traffics_.push_back(signals_.word(traffic));
  }

  void cycle(const CoreCycle& cycle) override {
    if (next_cycle_ && *next_cycle_ != cycle.cycle) end_cycles();
    next_cycle_ = cycle.cycle + 1;
    show_idle();
    for (std::size_t port = 0; port < signals_.ports.size(); ++port) {
      if (signals_.ports[port] != kNoSignal) show_port(cycle, port);
    }
    std::uint32_t* const queues = now_.data() + signals_.queues;
    const auto middle = cycle.lane_slots.begin() + static_cast<std::ptrdiff_t>(board_.ports().lanes());
    queues[kLeftLane] = std::accumulate(cycle.lane_slots.begin(), middle, 0U);
    queues[kRightLane] = std::accumulate(middle, cycle.lane_slots.end(), 0U);
    queues[kResults] = cycle.result_words;
    queues[kWorks] = cycle.works ? 1 : 0;
    add_changes(cycle.cycle);
  }

  void burst(const BusBurst& burst) override {
    const auto bus = static_cast<std::size_t>(burst.bus);
    ChangeStream& stream = streams_[1 + bus];
    const auto first = static_cast<std::uint32_t>(signals_.buses[bus]);
    const bool is_local = burst.bus == BusBurst::Bus::kLocal;
    const std::uint64_t address = is_local ? memory::address_in_bank(burst.address) : burst.address;
    stream.add(burst.address_ps, first + kBusOwner, signals_.word(burst.master));
    stream.add(burst.address_ps, first + kPhase, signals_.word("address"));
    stream.add(burst.address_ps, first + kDirection, access_word(burst.write));
    stream.add(burst.address_ps, first + kTarget, signals_.word(target_text(burst)));
    stream.add(burst.address_ps, first + kBusAddress, static_cast<std::uint32_t>(address));
    stream.add(burst.data_ps, first + kPhase, signals_.word("data"));
    for (std::uint32_t signal = first; signal <= first + kBusAddress; ++signal)
      stream.add(burst.end_ps, signal, signals_.all[signal].idle);
  }

  void level(const platform::QueueLevel& level) override {
    std::size_t queue = 0;
    while (queue < kQueues.size() && level.queue != std::string_view(kQueues[queue][0])) ++queue;
    if (queue == kQueues.size())
      throw std::invalid_argument(fmt::format("queue = {}: has no signal", level.queue));
    streams_[1 + kBusNames.size() + queue].add(level.time_ps,
                                               static_cast<std::uint32_t>(signals_.levels + queue),
                                               static_cast<std::uint32_t>(level.words));
  }

  void end(const TimeSpan& window) override {
    end_cycles();
    const Span span = Waveform(files_.front(), signals_).write(streams_, window);
    if (is_fst_) turn_into_fst();
    if (files_.size() > 1) files_.back().write(layout_of(path_.filename().string(), signals_, span));
  }

 private:
  std::uint32_t access_word(bool write) { return signals_.word(write ? "writes" : "reads"); }

  // A port keeps the bank and address of its last request, as on a bus: a waveform then has fewer changes.
  void show_idle() {
    now_ = idle_;
    for (const std::size_t first : signals_.ports) {
      if (first == kNoSignal) continue;
      for (const std::size_t held : {first + kBank, first + kAddress}) now_[held] = shown_[held];
    }
  }

  // The cycles that follow are left out, or behind the window.
  void end_cycles() {
    if (!next_cycle_) return;
    show_idle();
    add_changes(*next_cycle_);
    next_cycle_.reset();
  }

  void show_port(const CoreCycle& cycle, std::size_t port) {
    const PortCycle& its = cycle.ports[port];
    std::uint32_t* const shown = now_.data() + signals_.ports[port];
    shown[kState] = intents_[static_cast<std::size_t>(its.intent)];
    if (its.intent != fpga::Intent::kRequest) return;
    const std::size_t requester = board_.requesters.of_port(port, cycle.host_traffic);
    if (its.granted)
      shown[kState] = accesses_[board_.requesters.writes(requester) ? 1 : 0];
    else
      shown[kWaitsFor] = requesters_[its.by];
    shown[kBank] = banks_[its.bank];
    shown[kAddress] = static_cast<std::uint32_t>(its.address);
    if (port == board_.ports().host())
      now_[signals_.host_traffic] = traffics_[static_cast<std::size_t>(cycle.host_traffic)];
    show_bank(its, requester);
  }

  void show_bank(const PortCycle& port, std::size_t requester) {
    std::uint32_t* const bank = now_.data() + signals_.banks[port.bank];
    ++bank[kRequests];
    const bool is_second = board_.has_separate_ports(port.bank) && board_.requesters.writes(requester);
    std::uint32_t& owner = bank[is_second ? kWriteOwner : kOwner];
    if (port.granted)
      owner = requesters_[requester];
    else if (!board_.requesters.is_requester(port.by))
      owner = requesters_[port.by];
  }

  void add_changes(std::uint64_t cycle) {
    const std::uint64_t time_ps = board_.ps(cycle);
    for (std::uint32_t signal = 0; signal < now_.size(); ++signal) {
      if (now_[signal] != shown_[signal]) streams_.front().add(time_ps, signal, now_[signal]);
    }
    std::swap(shown_, now_);
  }

  // The unfinished file has the waveform as VCD before.
  void turn_into_fst() {
    files_.front().complete();
    const fs::path vcd = files_.front().unfinished();
    const fs::path fst = fs::path(vcd) += ".fst";
    const process::CommandEnd end = process::run_command({"vcd2fst", vcd.string(), fst.string()});
    std::error_code none;
    if (end.status != 0 || fs::file_size(fst, none) == 0 || none)
      throw std::runtime_error(
          fmt::format("{}: vcd2fst ends with status {}: {}", path_.string(), end.status, end.errors));
    fs::rename(fst, vcd);
  }

  fs::path path_;
  bool is_fst_;
  TraceBoard board_;
  Signals signals_;
  // Words that cycles show.
  std::array<std::uint32_t, 2> accesses_ = {access_word(false), access_word(true)};  // [write]
  std::vector<std::uint32_t> intents_;                                               // [fpga::Intent]
  std::vector<std::uint32_t> requesters_;
  std::vector<std::uint32_t> banks_;
  std::vector<std::uint32_t> traffics_;  // [fpga::HostTraffic]
  std::vector<std::uint32_t> idle_;      // [signal of the core]
  std::vector<std::uint32_t> now_;
  std::vector<std::uint32_t> shown_;
  std::optional<std::uint64_t> next_cycle_;  // the one behind the last cycle
  std::deque<ChangeStream> streams_;         // of the core, of each bus, of each queue
};

}  // namespace

std::unique_ptr<TraceSink> vcd_sink(const fs::path& path, const platform::BoardConfig& board) {
  return std::make_unique<VcdSink>(path, board);
}

}  // namespace stereotlm::trace
