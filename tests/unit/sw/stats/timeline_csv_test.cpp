#include <gtest/gtest.h>

#include "sw/stats/record_csv.h"

namespace stereotlm::stats {
namespace {

using platform::EventKind;

TEST(TimelineCsv, HasALineForEachEvent) {
  EXPECT_EQ(timeline_csv_head(), "kind,class,frame,camera_frame,start_ps,end_ps,words,dropped_pixels,why\n");
  EXPECT_EQ(timeline_csv({{EventKind::kCapture, "left", 3, 5, 10, 20, 76'800, 7, ""},
                          {EventKind::kDrop, "right", std::nullopt, 6, 30, 30, 0, 0, "busy"},
                          {EventKind::kReadBack, "disparity", 0, 0, 0, 1, 2, 0, ""}}),
            "capture,left,3,5,10,20,76800,7,\n"
            "drop,right,,6,30,30,0,0,busy\n"
            "read_back,disparity,0,0,0,1,2,0,\n");
}

TEST(LatencyCsv, HasALineForEachFrameAndTheSumOfItsParts) {
  EXPECT_EQ(latency_csv_head(),
            "frame,camera_frame,captured_ps,capture_ps,wait_copy_ps,copy_ps,wait_core_ps,core_ps,"
            "wait_read_back_ps,read_back_ps,delivery_ps,latency_ps\n");
  EXPECT_EQ(latency_csv({{4, 9, 1000, {1, 2, 3, 4, 5, 6, 7, 8}}}), "4,9,1000,1,2,3,4,5,6,7,8,36\n");
}

}  // namespace
}  // namespace stereotlm::stats
