#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace stereotlm::test {

// A field of a message of Protocol Buffers.
struct ProtoField {
  std::uint32_t number = 0;
  std::uint64_t value = 0;  // of an integer, or the bits of a fixed64
  std::string_view bytes;   // of a length-delimited field
};

inline std::uint64_t take_varint(std::string_view& bytes) {
  std::uint64_t value = 0;
  for (unsigned shift = 0;; shift += 7) {
    if (bytes.empty() || shift > 63) throw std::runtime_error("varint");
    const auto byte = static_cast<unsigned char>(bytes.front());
    bytes.remove_prefix(1);
    value |= static_cast<std::uint64_t>(byte & 0x7FU) << shift;
    if ((byte & 0x80U) == 0) return value;
  }
}

inline std::string_view take_bytes(std::string_view& bytes, std::uint64_t count) {
  if (bytes.size() < count) throw std::runtime_error("the message ends early");
  const std::string_view taken = bytes.substr(0, count);
  bytes.remove_prefix(count);
  return taken;
}

inline std::vector<ProtoField> proto_fields(std::string_view bytes) {
  std::vector<ProtoField> fields;
  while (!bytes.empty()) {
    const std::uint64_t key = take_varint(bytes);
    ProtoField field{static_cast<std::uint32_t>(key >> 3U), 0, {}};
    switch (key & 7U) {
      case 0:
        field.value = take_varint(bytes);
        break;
      case 1:
        std::memcpy(&field.value, take_bytes(bytes, 8).data(), 8);
        break;
      case 2:
        field.bytes = take_bytes(bytes, take_varint(bytes));
        break;
      default:
        throw std::runtime_error("wire type");
    }
    fields.push_back(field);
  }
  return fields;
}

// What a viewer makes of a Perfetto trace. Written from its schema alone (google/perfetto, protos/perfetto).
struct PerfettoFile {
  struct Slice {
    std::uint64_t track = 0;
    std::uint64_t begin_ns = 0;
    std::uint64_t end_ns = 0;
    std::size_t depth = 0;
    bool is_instant = false;
    std::string name;
    std::map<std::string, std::uint64_t> arguments;
    std::vector<std::uint64_t> flows;
  };
  struct Count {
    std::uint64_t track = 0;
    std::uint64_t time_ns = 0;
    double value = 0;
  };
  std::map<std::uint64_t, std::string> tracks;     // [uuid]: name
  std::map<std::uint64_t, std::uint64_t> parents;  // [uuid]
  std::vector<Slice> slices;                       // by their begins
  std::vector<Count> counts;

  explicit PerfettoFile(std::string_view bytes) {
    for (const ProtoField& field : proto_fields(bytes)) {
      if (field.number != 1) throw std::runtime_error("a trace has packets only");
      packet(field.bytes);
    }
    for (const auto& [track, open] : open_) {
      if (!open.empty()) throw std::runtime_error("a slice does not end");
    }
  }

  std::vector<Slice> slices_of(const std::string& track) const {
    std::vector<Slice> found;
    for (const Slice& slice : slices) {
      if (tracks.at(slice.track) == track) found.push_back(slice);
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const Slice& a, const Slice& b) { return a.begin_ns < b.begin_ns; });
    return found;
  }
  std::vector<std::pair<std::uint64_t, double>> counts_of(const std::string& track) const {
    std::vector<std::pair<std::uint64_t, double>> found;
    for (const Count& count : counts) {
      if (tracks.at(count.track) == track) found.emplace_back(count.time_ns, count.value);
    }
    return found;
  }

 private:
  struct Sequence {
    std::uint64_t time_ns = 0;
    std::uint64_t track = 0;
    std::map<std::uint64_t, std::string> events;
    std::map<std::uint64_t, std::string> arguments;
  };

  void packet(std::string_view bytes) {
    std::map<std::uint32_t, ProtoField> packet;
    for (const ProtoField& field : proto_fields(bytes)) packet[field.number] = field;
    if (packet.count(900) != 0) return;  // a text that viewers ignore
    if (packet.count(60) != 0) return descriptor(packet[60].bytes);
    Sequence& sequence = sequences_[packet.at(10).value];
    if (packet.at(13).value == 1) return start(sequence, packet);
    if (packet.at(13).value != 2) throw std::runtime_error("sequence_flags");
    sequence.time_ns += packet.at(8).value;
    if (packet.count(12) != 0) intern(sequence, packet[12].bytes);
    event(sequence, packet.at(11).bytes);
  }

  void descriptor(std::string_view bytes) {
    std::map<std::uint32_t, ProtoField> track;
    for (const ProtoField& field : proto_fields(bytes)) track[field.number] = field;
    const std::uint64_t uuid = track.at(1).value;
    if (tracks.count(uuid) != 0) throw std::runtime_error("uuid of two tracks");
    if (track.count(3) != 0) {
      for (const ProtoField& field : proto_fields(track[3].bytes)) {
        if (field.number == 6) tracks[uuid] = field.bytes;
      }
      return;
    }
    tracks[uuid] = track.at(2).bytes;
    parents[uuid] = track.at(5).value;
    if (tracks.count(parents[uuid]) == 0) throw std::runtime_error("a track without parent");
  }

  static void start(Sequence& sequence, std::map<std::uint32_t, ProtoField>& packet) {
    sequence = {};
    bool is_incremental = false;
    for (const ProtoField& field : proto_fields(packet.at(6).bytes)) {
      if (field.number != 1) continue;
      std::map<std::uint32_t, std::uint64_t> clock;
      for (const ProtoField& part : proto_fields(field.bytes)) clock[part.number] = part.value;
      if (clock.at(1) == 64) is_incremental = clock.at(3) == 1 && clock.at(2) == 0;
    }
    if (!is_incremental) throw std::runtime_error("clock 64");
    for (const ProtoField& field : proto_fields(packet.at(59).bytes)) {
      if (field.number == 58 && field.value != 64) throw std::runtime_error("the default clock");
      if (field.number == 11) sequence.track = proto_fields(field.bytes).at(0).value;
    }
  }

  static void intern(Sequence& sequence, std::string_view bytes) {
    for (const ProtoField& field : proto_fields(bytes)) {
      const std::vector<ProtoField> entry = proto_fields(field.bytes);
      auto& names = field.number == 2 ? sequence.events : sequence.arguments;
      if (!names.emplace(entry.at(0).value, entry.at(1).bytes).second)
        throw std::runtime_error("a number of two names");
    }
  }

  void event(const Sequence& sequence, std::string_view bytes) {
    Slice slice;
    slice.track = sequence.track;
    slice.begin_ns = sequence.time_ns;
    std::uint64_t type = 0;
    double value = 0;
    for (const ProtoField& field : proto_fields(bytes)) {
      if (field.number == 9) type = field.value;
      if (field.number == 10) slice.name = sequence.events.at(field.value);
      if (field.number == 30) value = static_cast<double>(field.value);
      if (field.number == 44) std::memcpy(&value, &field.value, sizeof value);
      if (field.number == 47) slice.flows.push_back(field.value);
      if (field.number == 4) {
        const std::vector<ProtoField> argument = proto_fields(field.bytes);
        slice.arguments[sequence.arguments.at(argument.at(0).value)] = argument.at(1).value;
      }
    }
    std::vector<std::size_t>& open = open_[sequence.track];
    if (type == 4) {
      counts.push_back({sequence.track, sequence.time_ns, value});
    } else if (type == 2) {
      slices.at(open.at(open.size() - 1)).end_ns = sequence.time_ns;
      open.pop_back();
    } else {
      slice.depth = open.size();
      slice.end_ns = slice.begin_ns;
      slice.is_instant = type == 3;
      if (type == 1) open.push_back(slices.size());
      slices.push_back(slice);
    }
  }

  std::map<std::uint64_t, Sequence> sequences_;
  std::map<std::uint64_t, std::vector<std::size_t>> open_;  // [track]: indices of the open slices
};

}  // namespace stereotlm::test
