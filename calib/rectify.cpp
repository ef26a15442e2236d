#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

#include "calib/opencv_types.h"
#include "calib/rectification.h"

namespace stereotlm::calib {

Rectification rectify(const Rig& rig) {
  constexpr double kOnlySeenPixels = 0;
  cv::Mat r1, r2, p1, p2, q;
  cv::stereoRectify(to_mat(rig.left.matrix), to_mat(rig.left.distortion), to_mat(rig.right.matrix),
                    to_mat(rig.right.distortion), {rig.width, rig.height}, to_mat(rig.rotation),
                    to_mat(rig.translation), r1, r2, p1, p2, q, cv::CALIB_ZERO_DISPARITY, kOnlySeenPixels);
  Rectification result;
  cv::cv2eigen(r1, result.r1);
  cv::cv2eigen(r2, result.r2);
  cv::cv2eigen(p1, result.p1);
  cv::cv2eigen(p2, result.p2);
  cv::cv2eigen(q, result.q);
  return result;
}

}  // namespace stereotlm::calib
