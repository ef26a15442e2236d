#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "sw/files/output_file.h"
#include "sw/trace/proto_message.h"

namespace stereotlm::trace {

// The first packet of every file, by which the file is known: a text that viewers ignore.
std::string perfetto_mark();

// The first packet of every file: a text that viewers ignore, by which the file is known.
std::string perfetto_mark();

// A track of a Perfetto trace. Each track is a packet sequence of its own, with its own table of names, and
// with times that are differences to the packet before. The times of a track therefore never decrease; those of
// different tracks are independent.
class PerfettoTrack {
 public:
  enum class Kind : std::uint8_t { kProcess, kGroup, kSlices, kCounter };
  // The place of a track in the tree, and its properties. `uuid` is unique in the trace; `rank` orders the
  // children of a parent.
  struct Description {
    Kind kind = Kind::kSlices;
    std::uint64_t uuid = 0;
    std::uint64_t parent = 0;
    std::uint64_t rank = 0;
    std::string name;
    std::string unit = {};  // of a counter
  };
  // An argument of a slice, which is left out if it has no value.
  struct Argument {
    const char* name;
    std::optional<std::uint64_t> value;
  };
  using Arguments = std::initializer_list<Argument>;

  // Describes the track in the file, which must outlive it.
  PerfettoTrack(files::OutputFile& file, const Description& description);

  // Times are in ns. An arrow leads from each slice to the next one with the same flow.
  void begin(std::uint64_t time_ns, std::string_view name, Arguments arguments,
             const std::vector<std::uint64_t>& flows = {});
  void end(std::uint64_t time_ns);
  void slice(std::uint64_t begin_ns, std::uint64_t end_ns, std::string_view name, Arguments arguments,
             const std::vector<std::uint64_t>& flows = {}) {
    begin(begin_ns, name, arguments, flows);
    end(end_ns);
  }
  void instant(std::uint64_t time_ns, std::string_view name, Arguments arguments);
  // Writes the value if it differs from the last one.
  void count(std::uint64_t time_ns, double value);

  std::uint64_t last_ns() const { return last_ns_; }

 private:
  using Names = std::unordered_map<std::string, std::uint64_t>;
  // A table that has become larger is begun anew, so that memory does not grow with the run.
  static constexpr std::size_t kMostNames = 4096;

  void start_sequence();
  std::uint64_t number_of(Names& names, std::uint32_t field, std::string_view name);
  void add_arguments(Arguments arguments);
  void write_event(std::uint64_t time_ns, std::uint64_t type);
  void write_packet();

  files::OutputFile& file_;
  std::uint64_t uuid_;
  std::uint64_t last_ns_ = 0;
  double last_value_ = -1;  // of a counter, whose values are not negative
  Names event_names_;
  Names argument_names_;
  // Parts of the packet that is made.
  ProtoMessage interned_;
  ProtoMessage event_;
  ProtoMessage packet_;
};

}  // namespace stereotlm::trace
