// A whole board of stereotlm in somebody else's program.
#include <stereotlm/platform/assembly/preloaded_system.h>
#include <stereotlm/platform/config/board_yaml.h>
#include <stereotlm/platform/figures/collect.h>

#include <cstdio>

struct OnePair : stereotlm::host::FrameSource, stereotlm::host::FrameSink {
  explicit OnePair(stereotlm::host::StereoPair p) : its_pair(std::move(p)) {}
  const stereotlm::host::StereoPair& pair(std::uint64_t) override { return its_pair; }
  void take(std::uint64_t, const stereotlm::kernels::GrayImage& image) override { disparity = image; }
  stereotlm::host::StereoPair its_pair;
  stereotlm::kernels::GrayImage disparity;
};

int sc_main(int, char**) {
  using namespace stereotlm;
  const auto config = platform::load_board("fpl2003", {"image={width: 64, height: 48}"});
  const auto tables = platform::identity_tables(config);
  OnePair frames({kernels::GrayImage(64, 48, 7), kernels::GrayImage(64, 48, 7)});
  Binder binder;
  platform::PreloadedSystem system("system", config, tables, 1, frames, frames, binder);
  sc_core::sc_start();
  const auto found = platform::collect_statistics(config, tables, system.board);
  std::printf("%s: %llu cycles, disparity %d\n", found.board.c_str(),
              static_cast<unsigned long long>(found.cycles), frames.disparity.at(32, 24));
  // Without contrast all candidates tie, and the smallest wins.
  return found.failed.empty() && found.frames == 1 && frames.disparity.at(32, 24) == 0 ? 0 : 1;
}
