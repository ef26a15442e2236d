#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/rig.h"

namespace stereotlm::calib {

// A file that holds the calibration of a rig, or a part of it.
struct ForeignFile {
  std::string path;
  std::string text;
};

// What the files may leave open.
struct ImportOptions {
  std::optional<std::pair<int, int>> size;                     // of the pictures, width and height in pixels
  std::optional<double> unit_mm;                               // of T; default: the format's, else 1
  std::optional<bool> is_fisheye;                              // the lens model of the coefficients
  std::optional<std::pair<std::string, std::string>> cameras;  // names of the left and of the right one
};

struct ImportedRig {
  std::string format;  // such as "ROS camera_info"
  Rig rig;
  // That of pictures that are rectified already; nullopt: rectify() makes it.
  std::optional<Rectification> rectification;
};

// Reads a rig from OpenCV FileStorage (YAML, XML or JSON; matrices by the names of stereo_calib and by other
// usual names), from a pair of ROS camera_info, a Kalibr camchain, a calib.txt of Middlebury or of KITTI.
// calib/README.md lists the fields. Lengths become mm. Throws std::runtime_error, which names the file, the
// field, the value and the rule, if a field is missing, contradicts another, or is none that a rig can have.
ImportedRig import_rig(const std::vector<ForeignFile>& files, const ImportOptions& options);

// The name of the format that import_rig() would read; nullopt if it knows none. Does not throw.
std::optional<std::string> foreign_format(const ForeignFile& file);

// A comment at the beginning of files of export_rig().
inline constexpr const char* kExportMark = "# stereotlm calibrate --export";

// The rig as files of a format, with the endings of their names: "opencv", one file with the names of
// stereo_calib, or "ros", the camera_info of the left and of the right camera, in metres.
std::vector<ForeignFile> export_rig(const Rig& rig, const Rectification& rectification,
                                    const std::string& format);

}  // namespace stereotlm::calib
