#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "sw/media/load.h"
#include "tests/support/scratch_folder.h"

namespace stereotlm::media {
namespace {

using kernels::GrayImage;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const cv::Size kSize(64, 48);

cv::Mat noise(int frame, int type, cv::Size size = kSize) {
  cv::Mat picture(size, type);
  cv::RNG(static_cast<std::uint64_t>(frame) + 1).fill(picture, cv::RNG::UNIFORM, 0, 256);
  return picture;
}

std::vector<std::uint8_t> pixels_of(const cv::Mat& grey) { return {grey.datastart, grey.dataend}; }

std::vector<std::uint8_t> grey_pixels_of(const cv::Mat& colour) {
  cv::Mat grey;
  cv::cvtColor(colour, grey, cv::COLOR_BGR2GRAY);
  return pixels_of(grey);
}

std::unique_ptr<Video> open_video(const std::string& path) {
  return media::open_video(path, [](int /*width*/, int /*height*/) {});
}

class VideoTest : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return scratch_.path() / name; }

  // A video of noise, frame by frame.
  std::string written(const std::string& name, const char* codec, int frames, int type = CV_8UC3,
                      cv::Size size = kSize) {
    const int tag = cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]);
    cv::VideoWriter writer(path(name), cv::CAP_FFMPEG, tag, 30, size, type == CV_8UC3);
    if (!writer.isOpened()) throw std::runtime_error(name + ": cannot be written");
    for (int frame = 0; frame < frames; ++frame) writer.write(noise(frame, type, size));
    writer.release();
    return path(name);
  }

  // The message about a file, without the path, which must come first.
  static std::string refusal(const std::string& path) {
    ::testing::internal::CaptureStderr();
    const std::string message = test::message_of([&] { open_video(path); });
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "") << "decoders keep quiet";
    EXPECT_THAT(message, StartsWith("'" + path + "': "));
    return message.substr(std::min(message.size(), path.size() + 4));
  }

  std::string refusal_of_bytes(const std::string& name, const std::string& bytes) const {
    return refusal(test::write_file(path(name), bytes));
  }

  test::ScratchFolder scratch_;
};

TEST_F(VideoTest, GivesTheGreysOfALosslessVideoAsTheyAre) {
  for (const char* name : {"grey.avi", "grey.mkv"}) {
    const auto video = open_video(written(name, "FFV1", 5, CV_8UC1));
    ASSERT_EQ(video->frames(), 5U);
    EXPECT_EQ(video->stated_frames(), 5U);
    EXPECT_EQ(cv::Size(video->frame(0).width, video->frame(0).height), kSize);
    for (int frame = 0; frame < 5; ++frame) {
      EXPECT_EQ(video->frame(static_cast<std::uint64_t>(frame)).pixels, pixels_of(noise(frame, CV_8UC1)));
    }
  }
}

TEST_F(VideoTest, ConvertsColourWithBgr2Gray) {
  for (const char* codec : {"FFV1", "MPNG"}) {
    const auto video = open_video(written("colour.avi", codec, 3));
    for (int frame = 0; frame < 3; ++frame) {
      EXPECT_EQ(video->frame(static_cast<std::uint64_t>(frame)).pixels, grey_pixels_of(noise(frame, CV_8UC3)))
          << codec;
    }
  }
}

TEST_F(VideoTest, DecodesTheUsualCodecsAsOpenCVDoes) {
  struct Case {
    const char* name;
    const char* codec;
  };
  for (const Case& usual : {Case{"m.avi", "MJPG"}, {"x.avi", "XVID"}, {"p.mp4", "mp4v"}, {"h.mp4", "avc1"}}) {
    const std::string file = written(usual.name, usual.codec, 12);
    cv::VideoCapture expected(file, cv::CAP_FFMPEG);
    const auto video = open_video(file);
    ASSERT_EQ(video->frames(), 12U) << usual.name;
    cv::Mat picture;
    for (std::uint64_t frame = 0; frame < 12; ++frame) {
      ASSERT_TRUE(expected.read(picture));
      EXPECT_EQ(video->frame(frame).pixels, grey_pixels_of(picture)) << usual.name << ' ' << frame;
    }
  }
}

TEST_F(VideoTest, GivesItsFramesInAnyOrder) {
  const std::string file = written("h.mp4", "avc1", 10);
  std::vector<GrayImage> expected;
  const auto in_order = open_video(file);
  for (std::uint64_t frame = 0; frame < 10; ++frame) expected.push_back(in_order->frame(frame));
  const auto video = open_video(file);
  for (const std::uint64_t frame : {3U, 3U, 4U, 9U, 0U, 9U, 8U, 1U, 0U, 0U}) {
    EXPECT_EQ(video->frame(frame), expected[frame]) << frame;
  }
  EXPECT_NE(expected[3], expected[4]);
}

TEST_F(VideoTest, DoesNotTurnFramesByMetadata) {
  const std::string file = written("turned.mp4", "mp4v", 2);
  std::string bytes = test::read_file(file);
  // The matrix of the track header: identity, then a turn by 90 degrees.
  const std::string identity("\0\1\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\1\0\0", 20);
  const std::string turn("\0\0\0\0\0\1\0\0\0\0\0\0\xFF\xFF\0\0\0\0\0\0", 20);
  const std::size_t at = bytes.find(identity, bytes.find("tkhd"));
  ASSERT_NE(at, std::string::npos);
  test::write_file(file, bytes.replace(at, identity.size(), turn));
  cv::VideoCapture usual(file, cv::CAP_FFMPEG);
  cv::Mat picture;
  ASSERT_TRUE(usual.read(picture));
  ASSERT_EQ(picture.size(), cv::Size(kSize.height, kSize.width)) << "OpenCV's default turns";
  EXPECT_EQ(open_video(file)->frame(1).width, kSize.width);
}

TEST_F(VideoTest, TakesAPathWithAColonForAPath) {
  const std::string file = written("x.avi", "MJPG", 1);
  const auto earlier = std::filesystem::current_path();
  std::filesystem::rename(file, path("http:x.avi"));
  std::filesystem::current_path(scratch_.path());
  EXPECT_EQ(open_video("http:x.avi")->frames(), 1U);
  std::filesystem::current_path(earlier);
}

TEST_F(VideoTest, RefusesAFileThatIsNoVideo) {
  EXPECT_THAT(refusal(path("none.avi")), StartsWith("no such file"));
  EXPECT_THAT(refusal(scratch_.path()), StartsWith("must be a regular file"));
  EXPECT_THAT(test::message_of([] { open_video("http://localhost/x.avi"); }), HasSubstr("no such file"));
  const std::string rule =
      ": a video must be an AVI, Matroska, WebM, MP4, MPEG, Ogg, ASF, FLV or Y4M file that FFmpeg decodes";
  EXPECT_EQ(refusal_of_bytes("text.avi", std::string(5000, 't')), "no video" + rule);
  EXPECT_EQ(refusal_of_bytes("empty.avi", ""), "no video" + rule);
  cv::imwrite(path("picture.png"), noise(1, CV_8UC3));
  EXPECT_THAT(refusal(path("picture.png")), HasSubstr(rule));
  const std::string avi = test::read_file(written("m.avi", "MJPG", 1));
  EXPECT_THAT(refusal_of_bytes("none.avi", avi.substr(0, avi.find("movi") + 4)),
              StartsWith("no frame can be decoded: "));
}

TEST_F(VideoTest, RefusesAPlaylistBecauseItNamesOtherFiles) {
  written("a.mp4", "mp4v", 2);
  EXPECT_THAT(refusal_of_bytes("list.txt", "ffconcat version 1.0\nfile a.mp4\n"),
              StartsWith("'[concat] Format not on whitelist"));
  EXPECT_THAT(
      refusal_of_bytes("list.m3u8", "#EXTM3U\n#EXT-X-TARGETDURATION:10\n#EXTINF:1,\na.mp4\n#EXT-X-ENDLIST\n"),
      StartsWith("'[hls] Format not on whitelist"));
}

TEST_F(VideoTest, ChecksTheSizeBeforeItDecodesAFrame) {
  const std::string large = written("large.avi", "FFV1", 1, CV_8UC1, {16386, 32});
  EXPECT_EQ(refusal(large), "16386x32 pixels: two of a board's images are 16384x16384 at most");
  EXPECT_EQ(open_video(written("wide.avi", "FFV1", 1, CV_8UC1, {16384, 32}))->frame(0).width, 16384);
  std::string bytes = test::read_file(written("m.avi", "MJPG", 3));
  bytes.replace(bytes.size() / 2, 200, std::string(200, 'x'));
  const std::string damaged = test::write_file(path("damaged.avi"), bytes);
  EXPECT_THAT(refusal(damaged), HasSubstr("a video must decode without errors"));
  const auto check = [](int width, int height) {
    throw std::runtime_error(std::to_string(width) + "x" + std::to_string(height));
  };
  EXPECT_EQ(test::message_of([&] { media::open_video(damaged, check); }), "64x48");
}

TEST_F(VideoTest, ReservesNoMemoryForAFrameThatIsLargerThanTheHeaderSays) {
  std::string bytes = test::read_file(written("png.avi", "MPNG", 2));
  const std::size_t at = bytes.rfind("IHDR");
  ASSERT_NE(at, std::string::npos);
  bytes.replace(at + 4, 10,
                std::string("\0\0\x3E\x80\0\0\x3E\x80\x10\x06", 10));  // 16000x16000, RGBA of 16 bits
  EXPECT_THAT(refusal_of_bytes("png.avi", bytes), StartsWith("'[png] get_buffer() failed'"));
}

TEST_F(VideoTest, RefusesADamagedOrTruncatedVideoWhereFFmpegReportsIt) {
  std::string damaged = test::read_file(written("h.mp4", "avc1", 10));
  for (std::size_t i = damaged.size() / 2; i < damaged.size() / 2 + 500; ++i)
    damaged[i] = static_cast<char>(damaged[i] ^ 0x55);
  EXPECT_THAT(refusal_of_bytes("h.mp4", damaged),
              AllOf(StartsWith("'[h264] "), HasSubstr("': a video must decode without errors")));
  const std::string mp4 = test::read_file(written("p.mp4", "mp4v", 10));
  EXPECT_THAT(refusal_of_bytes("p.mp4", mp4.substr(0, mp4.size() / 2)), HasSubstr("moov atom not found"));
  const std::string mkv = test::read_file(written("f.mkv", "FFV1", 10));
  EXPECT_THAT(refusal_of_bytes("f.mkv", mkv.substr(0, mkv.size() / 2)),
              StartsWith("'[matroska,webm] File ended prematurely': a video must decode without errors"));
}

TEST_F(VideoTest, ReportsAFrameThatHasDisappeared) {
  const std::string file = written("m.avi", "MJPG", 10);
  const auto video = open_video(file);
  EXPECT_EQ(video->frame(0).width, kSize.width);
  std::filesystem::remove(file);
  const auto refusal_of_frame = [&](std::uint64_t frame) {
    return test::message_of([&] { video->frame(frame); });
  };
  video->frame(9);  // an earlier frame needs the file again
  EXPECT_EQ(refusal_of_frame(5),
            "'" + file + "': frame 5 cannot be decoded any more: a video must not change during a run");
  test::write_file(file, "");
  EXPECT_THAT(refusal_of_frame(0), HasSubstr("frame 0 cannot be decoded any more"));
  written("m.avi", "MJPG", 3);
  EXPECT_EQ(video->frame(2).width, kSize.width);
  EXPECT_THAT(refusal_of_frame(3), HasSubstr("frame 3 cannot be decoded any more"));
  written("m.avi", "MJPG", 3, CV_8UC3, {32, 24});
  EXPECT_THAT(refusal_of_frame(0), HasSubstr("frame 0 cannot be decoded any more"));
}

}  // namespace
}  // namespace stereotlm::media
