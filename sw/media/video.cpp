#include "sw/media/video.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <stdexcept>

#include "models/fpga/core_config.h"
#include "sw/media/captured_stderr.h"
#include "sw/media/media_errors.h"

namespace stereotlm::media {
namespace {

using kernels::GrayImage;

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

class FfmpegVideo : public Video {
 public:
  FfmpegVideo(const std::string& path, const VideoSizeCheck& check) : path_(path) {
    check_regular_file(path, "a video must be a readable regular file");
    CapturedStderr captured;
    limit_memory();
    if (!open()) {
      const std::string complaint = captured.text();
      throw_media_error(path_, complaint.empty() ? "no video" : "'" + first_complaint(complaint) + "'",
                        kRule);
    }
    check_header(check);
    const double stated = capture_.get(cv::CAP_PROP_FRAME_COUNT);
    if (stated >= 1 && stated < 1e15) stated_frames_ = static_cast<std::uint64_t>(stated);
    count();
    const std::string complaint = captured.text();
    if (!complaint.empty()) {
      throw_media_error(path_, fmt::format("'{}'", first_complaint(complaint)),
                        "a video must decode without errors");
    }
    if (frames_ == 0) throw_media_error(path_, "no frame can be decoded", kRule);
    check(size_.width, size_.height);
  }

  int width() const override { return size_.width; }
  int height() const override { return size_.height; }
  std::uint64_t frames() const override { return frames_; }
  std::uint64_t stated_frames() const override { return stated_frames_; }

  const GrayImage& frame(std::uint64_t index) override {
    const CapturedStderr captured;
    bool is_there = (capture_.isOpened() && index >= next_) || open();
    while (is_there && next_ <= index) is_there = next_++ < index ? capture_.grab() : capture_.read(picture_);
    if (!is_there || picture_.size() != size_) {
      capture_.release();
      throw_media_error(path_, fmt::format("frame {} cannot be decoded any more", index),
                        "a video must not change during a run");
    }
    convert();
    return image_;
  }

 private:
  // Opens the video at its first frame. The path is absolute, because FFmpeg reads text before a colon as a
  // protocol.
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
      throw_media_error(path_, fmt::format("{}x{} pixels", width, height),
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
    image_ = GrayImage(size_.width, size_.height);
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
  GrayImage image_;
};

}  // namespace

std::unique_ptr<Video> open_video(const std::string& path, const VideoSizeCheck& check) {
  return std::make_unique<FfmpegVideo>(path, check);
}

}  // namespace stereotlm::media
