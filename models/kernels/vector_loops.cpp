#include "models/kernels/vector_loops.h"

#include <cstddef>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "models/kernels/vector_loops.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace stereotlm::kernels::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Capped: longer vectors gain nothing here, and no vector may be longer than the padding.
using Tag16 = hn::CappedTag<std::int16_t, kLaneAlignment / sizeof(std::int16_t)>;
using Tag32 = hn::CappedTag<std::int32_t, kLaneAlignment / sizeof(std::int32_t)>;

void step_windows(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                  std::int16_t* leaving, std::int32_t* windows) {
  const Tag16 d16;
  const hn::Rebind<std::uint8_t, Tag16> d8;
  const Tag32 d32;
  const hn::Rebind<std::int16_t, Tag32> d16_half;
  HWY_ALIGN std::int16_t change[kLanePadding];
  for (int d = 0; d < lanes; d += static_cast<int>(hn::Lanes(d16))) {
    auto sums = hn::Zero(d16);
    for (int row = 0; row < rows; ++row) {
      const auto right = hn::PromoteTo(d16, hn::LoadU(d8, histories[row] + d));
      sums = hn::Add(sums, hn::Abs(hn::Sub(right, hn::Set(d16, left[row]))));
    }
    hn::Store(hn::Sub(sums, hn::Load(d16, leaving + d)), d16, change);
    hn::Store(sums, d16, leaving + d);
    for (std::size_t part = 0; part < hn::Lanes(d16); part += hn::Lanes(d32)) {
      std::int32_t* window = windows + d + part;
      hn::Store(hn::Add(hn::Load(d32, window), hn::PromoteTo(d32, hn::Load(d16_half, change + part))), d32,
                window);
    }
  }
}

// The keys of the lanes that `lane` numbers.
HWY_INLINE hn::Vec<Tag32> keys_at(const std::int32_t* sums, hn::Vec<Tag32> lane, hn::Vec<Tag32> candidates) {
  const Tag32 d32;
  const auto key = hn::Or(hn::ShiftLeft<8>(hn::Load(d32, sums)), lane);
  return hn::IfThenElse(hn::Lt(lane, candidates), key,
                        hn::Set(d32, std::numeric_limits<std::int32_t>::max()));
}

void step_chain(const std::int32_t* sums, int candidates, int lanes, const std::int32_t* held,
                std::int32_t* next) {
  const Tag32 d32;
  const auto step = static_cast<int>(hn::Lanes(d32));
  const auto limit = hn::Set(d32, candidates);
  auto lane = hn::Iota(d32, 0);
  for (int d = 0; d < lanes; d += step) {
    hn::StoreU(hn::Min(hn::LoadU(d32, held + d - 1), keys_at(sums + d, lane, limit)), d32, next + d);
    lane = hn::Add(lane, hn::Set(d32, step));
  }
}

std::int32_t smallest_key(const std::int32_t* sums, int candidates, int lanes) {
  const Tag32 d32;
  const auto step = static_cast<int>(hn::Lanes(d32));
  const auto limit = hn::Set(d32, candidates);
  auto lane = hn::Iota(d32, 0);
  auto best = hn::Set(d32, std::numeric_limits<std::int32_t>::max());
  for (int d = 0; d < lanes; d += step) {
    best = hn::Min(best, keys_at(sums + d, lane, limit));
    lane = hn::Add(lane, hn::Set(d32, step));
  }
  return hn::GetLane(hn::MinOfLanes(d32, best));
}

// The usual sizes are compiled for themselves: kSize is 0 for any other.
template <int kSize>
void filter_column_of(const float* columns, std::ptrdiff_t stride, const float* weights, int any_size,
                      int rows, int shift, std::uint8_t* out) {
  const int size = kSize != 0 ? kSize : any_size;
  const hn::CappedTag<float, kFilterBlock> df;
  const hn::RebindToSigned<decltype(df)> d32;
  const hn::Rebind<std::uint8_t, decltype(df)> d8;
  for (int k = 0; k < rows; k += static_cast<int>(hn::Lanes(df))) {
    // Four sums, because one alone would wait for itself.
    auto even = hn::Zero(df);
    auto odd = even;
    auto even_before = even;
    auto odd_before = even;
    const float* weight = weights;
    const float* tap = columns + k;
    for (int i = 0; i < size; ++i, weight += size, tap += stride) {
      for (int j = 0; j + 1 < size; j += 2) {
        even = hn::MulAdd(hn::LoadU(df, tap + j), hn::Set(df, weight[j]), even);
        odd = hn::MulAdd(hn::LoadU(df, tap + j + 1), hn::Set(df, weight[j + 1]), odd);
      }
      even = hn::MulAdd(hn::LoadU(df, tap + size - 1), hn::Set(df, weight[size - 1]), even);
      const auto even_now = even;
      const auto odd_now = odd;
      even = even_before;
      odd = odd_before;
      even_before = even_now;
      odd_before = odd_now;
    }
    const auto sum = hn::ConvertTo(d32, hn::Add(hn::Add(even, even_before), hn::Add(odd, odd_before)));
    const auto level = hn::Add(hn::ShiftRightSame(sum, shift), hn::Set(d32, 128));
    hn::StoreU(hn::DemoteTo(d8, hn::Min(hn::Max(level, hn::Zero(d32)), hn::Set(d32, 255))), d8, out + k);
  }
}

void filter_column(const float* columns, std::ptrdiff_t stride, const float* weights, int size, int rows,
                   int shift, std::uint8_t* out) {
  switch (size) {
    case 3:
      return filter_column_of<3>(columns, stride, weights, size, rows, shift, out);
    case 5:
      return filter_column_of<5>(columns, stride, weights, size, rows, shift, out);
    case 7:
      return filter_column_of<7>(columns, stride, weights, size, rows, shift, out);
    default:
      return filter_column_of<0>(columns, stride, weights, size, rows, shift, out);
  }
}

}  // namespace stereotlm::kernels::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace stereotlm::kernels {

HWY_EXPORT(step_windows);
HWY_EXPORT(step_chain);
HWY_EXPORT(smallest_key);
HWY_EXPORT(filter_column);

void step_windows(const std::uint8_t* const* histories, const std::uint8_t* left, int rows, int lanes,
                  std::int16_t* leaving, std::int32_t* windows) {
  HWY_DYNAMIC_DISPATCH(step_windows)
  (histories, left, rows, lanes, leaving, windows);
}

void step_chain(const std::int32_t* sums, int candidates, int lanes, const std::int32_t* held,
                std::int32_t* next) {
  HWY_DYNAMIC_DISPATCH(step_chain)(sums, candidates, lanes, held, next);
}

std::int32_t smallest_key(const std::int32_t* sums, int candidates, int lanes) {
  return HWY_DYNAMIC_DISPATCH(smallest_key)(sums, candidates, lanes);
}

void filter_column(const float* columns, std::ptrdiff_t stride, const float* weights, int size, int rows,
                   int shift, std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(filter_column)(columns, stride, weights, size, rows, shift, out);
}

}  // namespace stereotlm::kernels
#endif
