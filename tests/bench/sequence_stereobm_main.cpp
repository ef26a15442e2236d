// stereotlm-sequence-stereobm DIR matches a sequence of pairs as a user of OpenCV does, to be timed beside
// `stereotlm run --sequence DIR`: it reads left_*.png and right_*.png as grey pictures, in one thread.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: stereotlm-sequence-stereobm DIR\n");
    return 2;
  }
  cv::setNumThreads(1);
  std::vector<std::string> stems;
  for (const auto& entry : std::filesystem::directory_iterator(argv[1])) {
    const std::string name = entry.path().filename().string();
    if (name.rfind("left_", 0) == 0) stems.push_back(name.substr(5));
  }
  std::sort(stems.begin(), stems.end());
  const auto matcher = cv::StereoBM::create(80, 7);
  cv::Mat disparity;
  for (const std::string& stem : stems) {
    const std::string folder = std::string(argv[1]) + '/';
    const cv::Mat left = cv::imread(folder + "left_" + stem, cv::IMREAD_GRAYSCALE);
    const cv::Mat right = cv::imread(folder + "right_" + stem, cv::IMREAD_GRAYSCALE);
    if (left.empty() || right.empty()) {
      std::fprintf(stderr, "%s: no pair\n", stem.c_str());
      return 1;
    }
    matcher->compute(left, right, disparity);
  }
  std::printf("%zu pairs\n", stems.size());
  return 0;
}
