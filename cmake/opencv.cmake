# The modules of OpenCV that are used. Debian's CMake package of OpenCV is part of libopencv-dev, which needs
# all modules, and 60 MB more.
find_path(STEREOTLM_OPENCV_HEADERS opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
foreach(module core imgproc imgcodecs videoio features2d calib3d)
  find_library(STEREOTLM_OPENCV_${module} opencv_${module} REQUIRED)
  add_library(opencv_${module} UNKNOWN IMPORTED GLOBAL)
  set_target_properties(opencv_${module} PROPERTIES
    IMPORTED_LOCATION ${STEREOTLM_OPENCV_${module}}
    INTERFACE_INCLUDE_DIRECTORIES ${STEREOTLM_OPENCV_HEADERS})
endforeach()
