#include "sw/media/picture_header.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <string>
#include <string_view>

namespace stereotlm::media {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Size = std::optional<PictureSize>;

constexpr std::uint64_t kMostNumber = 1'000'000'000;  // largest number read from a text header

// Reads numbers from the bytes of a file. A byte after the end reads as 0; whole() is false from then on.
class View {
 public:
  enum class Order { kBig, kLittle };
  View(const Bytes& bytes, Order order) : bytes_(bytes), order_(order) {}

  std::uint64_t number(std::size_t at, std::size_t count) {
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < count; ++i)
      number = number << 8U | byte(order_ == Order::kBig ? at + i : at + count - 1 - i);
    return number;
  }
  std::size_t offset(std::size_t at) { return static_cast<std::size_t>(number(at, 4)); }

  Size size(std::uint64_t width, std::uint64_t height) const {
    return whole_ ? Size({width, height}) : std::nullopt;
  }
  bool whole() const { return whole_; }

 private:
  std::uint8_t byte(std::size_t at) {
    whole_ = whole_ && at < bytes_.size();
    return whole_ ? bytes_[at] : std::uint8_t{0};
  }

  const Bytes& bytes_;
  Order order_;
  bool whole_ = true;
};

bool holds(const Bytes& bytes, std::size_t at, std::string_view text) {
  return at + text.size() <= bytes.size() &&
         std::equal(text.begin(), text.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at),
                    [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
}

Size png_size(const Bytes& bytes) {
  View view(bytes, View::Order::kBig);
  return holds(bytes, 12, "IHDR") ? view.size(view.number(16, 4), view.number(20, 4)) : std::nullopt;
}

// The size is in the frame header. Its marker is one of SOF0 to SOF15, 0xFFC0 to 0xFFCF, three of which are
// markers of other segments.
Size jpeg_size(const Bytes& bytes) {
  View view(bytes, View::Order::kBig);
  for (std::size_t at = 2; view.whole();) {
    const std::uint64_t marker = view.number(at, 2);
    const bool is_marker = marker > 0xFF01 && marker < 0xFFFF;
    const bool is_alone = marker >= 0xFFD0 && marker <= 0xFFD8;
    if (!is_marker || is_alone) {
      at += is_alone ? 2 : 1;
    } else if (marker >= 0xFFC0 && marker <= 0xFFCF && marker != 0xFFC4 && marker != 0xFFC8 &&
               marker != 0xFFCC) {
      const std::uint64_t height = view.number(at + 5, 2);
      return view.size(view.number(at + 7, 2), height);
    } else {
      at += 2 + static_cast<std::size_t>(view.number(at + 2, 2));
    }
  }
  return std::nullopt;
}

Size bmp_size(const Bytes& bytes) {
  View view(bytes, View::Order::kLittle);
  if (view.number(14, 4) == 12) return view.size(view.number(18, 2), view.number(20, 2));
  const auto height = static_cast<std::int32_t>(view.number(22, 4));  // negative: the top row comes first
  return view.size(view.number(18, 4),
                   static_cast<std::uint64_t>(height < 0 ? -std::int64_t{height} : height));
}

Size sun_raster_size(const Bytes& bytes) {
  View view(bytes, View::Order::kBig);
  return view.size(view.number(4, 4), view.number(8, 4));
}

// The size of the first page, or of one of its tiles or strips if that is larger, because a decoder allocates
// whole tiles and strips.
Size tiff_size(const Bytes& bytes) {
  View view(bytes, bytes[0] == 'M' ? View::Order::kBig : View::Order::kLittle);
  PictureSize size;
  std::size_t entry = view.offset(4) + 2;
  for (std::uint64_t left = view.number(entry - 2, 2); left > 0 && view.whole(); --left, entry += 12) {
    constexpr std::uint64_t kShort = 3;
    constexpr std::uint64_t kOneStrip = 0x7FFFFFFF;  // as many rows per strip, or more: there is one strip
    const std::uint64_t value = view.number(entry + 8, view.number(entry + 2, 2) == kShort ? 2 : 4);
    switch (view.number(entry, 2)) {
      case 256:  // ImageWidth
      case 322:  // TileWidth
        size.width = std::max(size.width, value);
        break;
      case 278:  // RowsPerStrip
        if (value >= kOneStrip) break;
        [[fallthrough]];
      case 257:  // ImageLength
      case 323:  // TileLength
        size.height = std::max(size.height, value);
        break;
      default:
        break;
    }
  }
  return view.size(size.width, size.height);
}

Size webp_size(const Bytes& bytes) {
  View view(bytes, View::Order::kLittle);
  if (holds(bytes, 12, "VP8X")) return view.size(view.number(24, 3) + 1, view.number(27, 3) + 1);
  if (holds(bytes, 12, "VP8L")) {
    const std::uint64_t bits = view.number(21, 4);
    return view.size((bits & 0x3FFFU) + 1, (bits >> 14U & 0x3FFFU) + 1);
  }
  return view.size(view.number(26, 2) & 0x3FFFU, view.number(28, 2) & 0x3FFFU);
}

// The size is in the first segment of the code stream, SIZ, which has the end and the origin of the image in
// its grid.
Size jpeg_2000_size(const Bytes& bytes) {
  constexpr std::string_view kBegin = "\xFF\x4F\xFF\x51";
  const auto same = [](std::uint8_t a, char b) { return a == static_cast<std::uint8_t>(b); };
  const auto found = std::search(bytes.begin(), bytes.end(), kBegin.begin(), kBegin.end(), same);
  if (found == bytes.end()) return std::nullopt;
  const auto at = static_cast<std::size_t>(found - bytes.begin());
  View view(bytes, View::Order::kBig);
  const auto length = [&view](std::size_t end, std::size_t beginning) {
    const std::uint64_t last = view.number(end, 4);
    return last - std::min(last, view.number(beginning, 4));
  };
  const std::uint64_t width = length(at + 8, at + 16);
  return view.size(width, length(at + 12, at + 20));
}

Size pnm_size(const Bytes& bytes) {
  const auto width = bytes[1] == '7' ? pam_number(bytes, "WIDTH") : pnm_number(bytes, 0);
  const auto height = bytes[1] == '7' ? pam_number(bytes, "HEIGHT") : pnm_number(bytes, 1);
  return width && height ? Size({*width, *height}) : std::nullopt;
}

}  // namespace

std::optional<PictureHeader> read_header(const Bytes& bytes) {
  using std::literals::string_view_literals::operator""sv;
  const auto begins = [&bytes](std::string_view text) { return holds(bytes, 0, text); };
  if (begins("\x89PNG\r\n\x1A\n")) return PictureHeader{false, png_size(bytes)};
  if (begins("\xFF\xD8\xFF")) return PictureHeader{true, jpeg_size(bytes)};
  if (begins("BM")) return PictureHeader{false, bmp_size(bytes)};
  if (begins("\x59\xA6\x6A\x95")) return PictureHeader{false, sun_raster_size(bytes)};
  if (begins("II*\0"sv) || begins("MM\0*"sv)) return PictureHeader{false, tiff_size(bytes)};
  if (begins("RIFF") && holds(bytes, 8, "WEBPVP8")) return PictureHeader{false, webp_size(bytes)};
  if (begins("\0\0\0\x0CjP  \r\n\x87\n"sv) || begins("\xFF\x4F\xFF\x51"))
    return PictureHeader{false, jpeg_2000_size(bytes)};
  const bool is_pnm = bytes.size() > 2 && bytes[0] == 'P' && std::isspace(bytes[2]) != 0 &&
                      ((bytes[1] >= '1' && bytes[1] <= '7') || std::toupper(bytes[1]) == 'F');
  if (is_pnm) return PictureHeader{false, pnm_size(bytes)};
  return std::nullopt;
}

std::optional<std::uint64_t> pnm_number(const Bytes& bytes, int index) {
  std::optional<std::uint64_t> number;
  std::size_t at = 2;
  for (int field = 0; field <= index; ++field) {
    while (at < bytes.size() && std::isdigit(bytes[at]) == 0) {
      if (bytes[at] == '#') {
        while (at < bytes.size() && bytes[at] != '\n' && bytes[at] != '\r') ++at;
      } else {
        ++at;
      }
    }
    number.reset();
    for (; at < bytes.size() && std::isdigit(bytes[at]) != 0; ++at)
      number = std::min(kMostNumber, number.value_or(0) * 10 + (bytes[at] - std::uint64_t{'0'}));
  }
  return number;
}

std::optional<std::uint64_t> pam_number(const Bytes& bytes, const char* field) {
  constexpr std::size_t kMostHeader = 1024;
  const std::string header(bytes.begin(),
                           bytes.begin() + static_cast<std::ptrdiff_t>(std::min(kMostHeader, bytes.size())));
  const std::string name = std::string(field) + ' ';
  std::size_t at = header.find(name);
  if (at == std::string::npos) return std::nullopt;
  std::optional<std::uint64_t> number;
  for (at += name.size(); at < header.size() && std::isdigit(static_cast<unsigned char>(header[at])) != 0;
       ++at)
    number = std::min(kMostNumber, number.value_or(0) * 10 + static_cast<std::uint64_t>(header[at] - '0'));
  return number;
}

}  // namespace stereotlm::media
