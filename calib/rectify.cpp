#include <opencv2/calib3d.hpp>

#include "calib/opencv_conversions.h"
#include "calib/rectification.h"

namespace stereotlm::calib {

Rectification rectify(const Rig& rig) {
  constexpr double kOnlySeenPixels = 0;
  cv::Mat r1, r2, p1, p2, q;
  cv::stereoRectify(to_mat(rig.left.matrix), to_mat(rig.left.distortion), to_mat(rig.right.matrix),
                    to_mat(rig.right.distortion), {rig.width, rig.height}, to_mat(rig.rotation),
                    to_mat(rig.translation), r1, r2, p1, p2, q, cv::CALIB_ZERO_DISPARITY, kOnlySeenPixels);
  return {to_eigen<Eigen::Matrix3d>(r1), to_eigen<Eigen::Matrix3d>(r2), to_eigen<Projection>(p1),
          to_eigen<Projection>(p2), to_eigen<Eigen::Matrix4d>(q)};
}

}  // namespace stereotlm::calib
