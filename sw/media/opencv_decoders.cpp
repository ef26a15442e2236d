// The library of decoders.h: everything that needs the decoders of OpenCV.
#include <dlfcn.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "sw/media/decode.h"

namespace stereotlm::media {
namespace {

// Captures what the process writes to standard error, because the decoders of OpenCV report some problems
// nowhere else. No other thread may write to standard error while an object exists.
class CapturedStderr {
 public:
  CapturedStderr() : capture_(memfd_create("stderr", MFD_CLOEXEC)), saved_(dup(STDERR_FILENO)) {
    std::fflush(stderr);
    if (capture_ >= 0 && saved_ >= 0) dup2(capture_, STDERR_FILENO);
  }
  ~CapturedStderr() {
    restore();
    if (capture_ >= 0) close(capture_);
  }
  CapturedStderr(const CapturedStderr&) = delete;
  CapturedStderr& operator=(const CapturedStderr&) = delete;

  // Ends the capture and returns the captured text.
  std::string text() {
    restore();
    std::string result;
    char buffer[1024];
    ssize_t count = 0;
    while ((count = pread(capture_, buffer, sizeof buffer, static_cast<off_t>(result.size()))) > 0)
      result.append(buffer, static_cast<std::size_t>(count));
    return result;
  }

 private:
  void restore() {
    if (saved_ < 0) return;
    std::fflush(stderr);
    dup2(saved_, STDERR_FILENO);
    close(saved_);
    saved_ = -1;
  }

  int capture_;
  int saved_;
};

std::string description(const cv::Mat& picture) {
  static constexpr const char* kDepths[] = {"8-bit",  "signed 8-bit", "16-bit", "signed 16-bit",
                                            "32-bit", "float",        "double", "half float"};
  const int channels = picture.channels();
  return fmt::format("{} {}{}", kDepths[picture.depth()], channels < 3 ? "grey" : "colour",
                     channels % 2 == 0 ? " with alpha" : "");
}

// OpenCV 4.6 reads an 8-bit Sun raster without colour map as black.
bool is_read_as_black(std::string_view bytes) {
  constexpr std::size_t kDepth = 15;
  constexpr std::size_t kMapLength = 28;
  return bytes.size() > kMapLength + 4 && bytes.substr(0, 4) == "\x59\xA6\x6A\x95" && bytes[kDepth] == 8 &&
         bytes.substr(kMapLength, 4) == std::string_view("\0\0\0\0", 4);
}

// A bitmap with 32 bits a pixel may have alpha, which OpenCV takes from none or leaves out.
void check_alpha_of_bitmap(std::string_view bytes) {
  const auto number = [bytes](std::size_t at) {
    std::uint32_t value = 0;
    if (at + 4 <= bytes.size()) std::memcpy(&value, bytes.data() + at, 4);  // little endian, as in memory
    return value;
  };
  if (bytes.substr(0, 2) != "BM" || (number(28) & 0xFFFFU) != 32) return;
  const auto is = [&](unsigned char alpha) {
    for (std::size_t at = number(10) + 3; at < bytes.size(); at += 4) {
      if (static_cast<unsigned char>(bytes[at]) != alpha) return false;
    }
    return true;
  };
  if (!is(0) && !is(255))
    refuse_picture("a bitmap with alpha", std::string(kPixelRule) + " without transparency");
}

// Refuses what OpenCV would change: black and white is stretched, other inks are taken for alpha. Returns the
// file without an orientation, which OpenCV would apply.
std::string checked_tiff(std::string_view bytes) {
  std::string tiff(bytes);
  if (bytes.substr(0, 2) != "II" && bytes.substr(0, 2) != "MM") return tiff;
  constexpr unsigned kBits = 258;
  constexpr unsigned kSamples = 277;
  constexpr unsigned kPhotometric = 262;
  constexpr unsigned kInks = 5;
  constexpr unsigned kOrientation = 274;
  // Without the field, a sample has one bit. A colour picture has a list of three.
  const unsigned bits =
      tiff_field(bytes, kBits).value_or(tiff_field(bytes, kSamples).value_or(1) == 1 ? 1 : 8);
  if (bits == 1) refuse_picture("1-bit grey", kPixelRule);
  if (tiff_field(bytes, kPhotometric) == kInks) refuse_picture("CMYK", kPixelRule);
  std::size_t place = 0;
  if (tiff_field(bytes, kOrientation, &place)) {
    const char one[] = {0, 1, 0};
    tiff.replace(place, 2, bytes[0] == 'I' ? one + 1 : one, 2);
  }
  return tiff;
}

// The Exif data of a WebP; empty if it has none.
std::string_view exif_of_webp(std::string_view bytes) {
  std::uint32_t size = 0;
  for (std::size_t at = 12; bytes.substr(0, 4) == "RIFF" && at + 8 <= bytes.size();
       at += 8 + size + size % 2) {
    std::memcpy(&size, bytes.data() + at + 4, 4);  // little endian, as in memory
    if (bytes.substr(at, 4) == "EXIF") return bytes.substr(at + 8, size);
  }
  return {};
}

Picture decode_by_opencv(std::string_view original) {
  if (is_read_as_black(original))
    refuse_picture("a Sun raster without colour map", "OpenCV 4.6 reads it as black");
  check_alpha_of_bitmap(original);
  const std::string bytes = checked_tiff(original);
  cv::Mat decoded;
  try {
    const CapturedStderr captured;
    decoded =
        cv::imdecode(cv::Mat(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data())),
                     cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception& error) {
    // process::plugin_symbol() sets the limit.
    if (error.err.find("CV_IO_MAX_IMAGE") != std::string::npos)
      refuse_large(fmt::format("more than {}x{}", fpga::kWidthRule.max, fpga::kHeightRule.max));
  }
  if (decoded.empty()) refuse_damaged();
  if (decoded.depth() != CV_8U || decoded.channels() > 4) refuse_picture(description(decoded), kPixelRule);
  Picture picture = new_picture(static_cast<std::uint64_t>(decoded.cols),
                                static_cast<std::uint64_t>(decoded.rows), decoded.channels());
  decoded.copyTo(cv::Mat(decoded.rows, decoded.cols, decoded.type(), picture.samples.data()));
  if (picture.channels % 2 == 0) drop_alpha(picture);
  note_orientation(original.substr(0, 4) == "RIFF" ? exif_of_webp(original) : original, picture);
  return picture;
}

// Options for FFmpeg. It opens only containers that hold the video itself, because a playlist would open
// files that the user has not named. It drops packets that it knows to be truncated.
constexpr const char* kOptions =
    "format_whitelist;avi,matroska,webm,mov,mp4,mpeg,mpegts,ogg,asf,flv,yuv4mpegpipe|fflags;discardcorrupt";
constexpr const char* kRule =
    "a video must be an AVI, Matroska, WebM, MP4, MPEG, Ogg, ASF, FLV or Y4M file that FFmpeg decodes";

// A frame may hold both pictures of a pair, side by side or one above the other.
constexpr std::int64_t kMostWidth = 2 * fpga::kWidthRule.max;
constexpr std::int64_t kMostHeight = 2 * fpga::kHeightRule.max;

// Limits the memory of FFmpeg to the largest pair at four channels of 16 bits, because a frame may be larger
// than the file's header states. A frame that needs more memory cannot be decoded.
void limit_memory() {
  constexpr std::size_t kMostBytes = 8 * 2 * fpga::kWidthRule.max * fpga::kHeightRule.max;
  using Limit = void(std::size_t);
  // OpenCV's copy of FFmpeg, for which no header is installed.
  static auto* const limit = reinterpret_cast<Limit*>(dlsym(RTLD_DEFAULT, "av_max_alloc"));
  if (limit != nullptr) limit(kMostBytes);
}

// The first line of a message, without the address in "[h264 @ 0x5603dadfee80] ..".
std::string first_complaint(const std::string& text) {
  std::string line = text.substr(0, text.find('\n'));
  const std::size_t address = line.find(" @ 0x");
  if (address != std::string::npos) line.erase(address, line.find(']', address) - address);
  return line;
}

[[noreturn]] void refuse_video(const std::string& path, const std::string& found, const std::string& rule) {
  throw std::runtime_error(fmt::format("'{}': {}: {}", path, found, rule));
}

class FfmpegVideo : public Video {
 public:
  FfmpegVideo(const std::string& path, const VideoSizeCheck& check) : path_(path) {
    CapturedStderr captured;
    limit_memory();
    if (!open()) {
      const std::string complaint = captured.text();
      refuse_video(path_, complaint.empty() ? "no video" : "'" + first_complaint(complaint) + "'", kRule);
    }
    check_header(check);
    const double stated = capture_.get(cv::CAP_PROP_FRAME_COUNT);
    if (stated >= 1 && stated < 1e15) stated_frames_ = static_cast<std::uint64_t>(stated);
    count();
    const std::string complaint = captured.text();
    if (!complaint.empty()) {
      refuse_video(path_, fmt::format("'{}'", first_complaint(complaint)),
                   "a video must decode without errors");
    }
    if (frames_ == 0) refuse_video(path_, "no frame can be decoded", kRule);
    check(size_.width, size_.height);
  }

  std::uint64_t frames() const override { return frames_; }
  std::uint64_t stated_frames() const override { return stated_frames_; }

  const kernels::GrayImage& frame(std::uint64_t index) override {
    const CapturedStderr captured;
    bool is_there = (capture_.isOpened() && index >= next_) || open();
    while (is_there && next_ <= index) is_there = next_++ < index ? capture_.grab() : capture_.read(picture_);
    if (!is_there || picture_.size() != size_) {
      capture_.release();
      refuse_video(path_, fmt::format("frame {} cannot be decoded any more", index),
                   "a video must not change during a run");
    }
    convert();
    return image_;
  }

 private:
  // Opens the video at its first frame. An absolute path, as FFmpeg takes text before a colon for a protocol.
  bool open() {
    setenv("OPENCV_FFMPEG_CAPTURE_OPTIONS", kOptions, 1);
    next_ = 0;
    const bool is_open =
        capture_.open(std::filesystem::absolute(path_).string(), cv::CAP_FFMPEG,
                      {cv::CAP_PROP_HW_ACCELERATION, static_cast<int>(cv::VIDEO_ACCELERATION_NONE)});
    if (is_open) capture_.set(cv::CAP_PROP_ORIENTATION_AUTO, 0);
    return is_open;
  }

  void check_header(const VideoSizeCheck& check) const {
    const auto width = static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_WIDTH));
    const auto height = static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_HEIGHT));
    if (width > kMostWidth || height > kMostHeight) {
      refuse_video(path_, fmt::format("{}x{} pixels", width, height),
                   fmt::format("two of a board's images are {}x{} at most", kMostWidth, kMostHeight));
    }
    check(width, height);
  }

  // Counts the frames and leaves the video at its end. OpenCV gives all frames the size of the first.
  void count() {
    for (; capture_.read(picture_); ++frames_) size_ = picture_.size();
    next_ = frames_;
  }

  void convert() {
    image_ = kernels::GrayImage(size_.width, size_.height);
    cv::Mat gray(size_, CV_8UC1, image_.pixels.data());
    cv::cvtColor(picture_, gray, cv::COLOR_BGR2GRAY);
  }

  std::string path_;
  cv::VideoCapture capture_;
  std::uint64_t next_ = 0;  // index of the next frame to read
  std::uint64_t frames_ = 0;
  std::uint64_t stated_frames_ = 0;
  cv::Size size_;
  cv::Mat picture_;
  kernels::GrayImage image_;
};

std::unique_ptr<Video> open_by_ffmpeg(const std::string& path, const VideoSizeCheck& check) {
  return std::make_unique<FfmpegVideo>(path, check);
}

}  // namespace
}  // namespace stereotlm::media

// The only symbol that decoders() looks up.
extern "C" {
extern const stereotlm::media::Decoders stereotlm_decoders;
const stereotlm::media::Decoders stereotlm_decoders = {stereotlm::media::decode_by_opencv,
                                                       stereotlm::media::open_by_ffmpeg};
}
