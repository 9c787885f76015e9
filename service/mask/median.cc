// Highway compiles this file once for each instruction set: everything in HWY_NAMESPACE is built several
// times, and HWY_DYNAMIC_DISPATCH calls the best one. Left out are sets that add nothing to minima and maxima
// of bytes, and those whose vectors have no size that a compiler knows, so that no array can hold them.
#define HWY_DISABLED_TARGETS \
  (HWY_SSE4 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "service/mask/median.cc"
#include "service/mask/median.h"

#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#ifndef SOFFIT_SERVICE_MASK_MEDIAN_ONCE
#define SOFFIT_SERVICE_MASK_MEDIAN_ONCE
namespace soffit {

constexpr int kWindow = 7;
constexpr int kTileRows = kWindow + 1;  ///< Two windows, one above the other, share all but two of these.
constexpr std::size_t kStripBytes =
    512;  ///< Done at a time, so that what windows share stays in the L1 cache.
constexpr int kMaxVectorBytes = 64;

/// Bytes of a row that are read to filter the first `bytes` of it; the window begins at the first.
constexpr int ReadBytes(int bytes) { return bytes + 3 * (kWindow - 1) + kMaxVectorBytes; }

using TileRows = std::array<const std::uint8_t*, kTileRows>;

}  // namespace soffit
#endif

HWY_BEFORE_NAMESPACE();
namespace soffit {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Bytes = hn::ScalableTag<std::uint8_t>;
using Vector = hn::Vec<Bytes>;

/// In every lane, N values in ascending order. After inlining these are registers, and what is computed for a
/// rank that nobody reads is never computed: pruning the networks is left to the compiler.
template <std::size_t N>
using Sorted = std::array<Vector, N>;

template <std::size_t kFirst, std::size_t N, std::size_t... I>
HWY_INLINE Sorted<sizeof...(I)> EveryOther(const Sorted<N>& all, std::index_sequence<I...>) {
  return {all[2 * I + kFirst]...};
}

template <std::size_t K, std::size_t E, std::size_t O>
HWY_INLINE Vector InterleavedRank(const Sorted<E>& even, const Sorted<O>& odd) {
  constexpr std::size_t kPair =
      (K + 1) / 2;  // Comparator of odd[kPair - 1] and even[kPair], to ranks 2 kPair - 1, 2 kPair.
  if constexpr (K == 0) {
    return even[0];
  } else if constexpr (kPair >= E) {
    return odd[kPair - 1];
  } else if constexpr (kPair > O) {
    return even[kPair];
  } else if constexpr (K % 2 == 1) {
    return hn::Min(odd[kPair - 1], even[kPair]);
  } else {
    return hn::Max(odd[kPair - 1], even[kPair]);
  }
}

template <std::size_t E, std::size_t O, std::size_t... K>
HWY_INLINE Sorted<E + O> Interleave(const Sorted<E>& even, const Sorted<O>& odd, std::index_sequence<K...>) {
  return {InterleavedRank<K>(even, odd)...};
}

/// Batcher's odd-even merge, of any two lengths.
template <std::size_t M, std::size_t N>
HWY_INLINE Sorted<M + N> Merge(const Sorted<M>& a, const Sorted<N>& b) {
  if constexpr (M == 0) {
    return b;
  } else if constexpr (N == 0) {
    return a;
  } else if constexpr (M == 1 && N == 1) {
    return {hn::Min(a[0], b[0]), hn::Max(a[0], b[0])};
  } else {
    const auto even = Merge(EveryOther<0>(a, std::make_index_sequence<(M + 1) / 2>()),
                            EveryOther<0>(b, std::make_index_sequence<(N + 1) / 2>()));
    const auto odd = Merge(EveryOther<1>(a, std::make_index_sequence<M / 2>()),
                           EveryOther<1>(b, std::make_index_sequence<N / 2>()));
    return Interleave(even, odd, std::make_index_sequence<M + N>());
  }
}

/// Sorts `load(kFirst)`, ..., `load(kFirst + N - 1)`.
template <std::size_t kFirst, std::size_t N, class Load>
HWY_INLINE Sorted<N> Sort(const Load& load) {
  if constexpr (N == 1) {
    return {load(kFirst)};
  } else {
    return Merge(Sort<kFirst, N / 2>(load), Sort<kFirst + N / 2, N - N / 2>(load));
  }
}

template <std::size_t kFirst, std::size_t N, std::size_t... I>
HWY_INLINE Sorted<sizeof...(I)> Ranks(const Sorted<N>& all, std::index_sequence<I...>) {
  return {all[kFirst + I]...};
}

/// The K values in the middle of N.
template <std::size_t K, std::size_t N>
HWY_INLINE Sorted<K> Middle(const Sorted<N>& all) {
  static_assert((N - K) % 2 == 0);
  return Ranks<(N - K) / 2>(all, std::make_index_sequence<K>());
}

/// Sorted values for every byte of a strip, one row per rank.
template <std::size_t N>
class SortedRows {
 public:
  HWY_INLINE void Store(std::size_t at, const Sorted<N>& sorted) {
    Store(at, sorted, std::make_index_sequence<N>());
  }
  HWY_INLINE Sorted<N> Load(std::size_t at) const { return Load(at, std::make_index_sequence<N>()); }

 private:
  template <std::size_t... I>
  HWY_INLINE void Store(std::size_t at, const Sorted<N>& sorted, std::index_sequence<I...>) {
    (hn::StoreU(sorted[I], Bytes(), &rows_[I][at]), ...);
  }
  template <std::size_t... I>
  HWY_INLINE Sorted<N> Load(std::size_t at, std::index_sequence<I...>) const {
    return {hn::LoadU(Bytes(), &rows_[I][at])...};
  }

  alignas(kMaxVectorBytes) std::uint8_t rows_[N][ReadBytes(kStripBytes)];
};

/// Filters the first `bytes` of two rows; `step` bytes lie between neighbours in a row.
///
/// The two windows share six rows. Each column of six is sorted once, each three columns are merged once, and
/// two of those and a column make the 42 shared values. Of n sorted values out of 49, the median can only be
/// one of the 50 - n in the middle: 8 are left, and 7 sorted ones of the row that only one window has decide.
void FilterStrip(const TileRows& tile, std::size_t bytes, std::size_t step, std::uint8_t* upper,
                 std::uint8_t* lower) {
  const Bytes d;
  const std::size_t lanes = hn::Lanes(d);
  SortedRows<6> columns;
  SortedRows<18> triples;
  for (std::size_t x = 0; x < bytes + 6 * step; x += lanes) {
    columns.Store(x, Sort<1, 6>([&](std::size_t row) HWY_ATTR { return hn::LoadU(d, tile[row] + x); }));
  }
  for (std::size_t x = 0; x < bytes + 3 * step; x += lanes) {
    triples.Store(x, Merge(Merge(columns.Load(x), columns.Load(x + step)), columns.Load(x + 2 * step)));
  }
  for (std::size_t x = 0; x < bytes; x += lanes) {
    const auto middle_of_36 = Middle<14>(Merge(triples.Load(x), triples.Load(x + 3 * step)));
    const auto middle_of_42 = Middle<8>(Merge(middle_of_36, columns.Load(x + 6 * step)));
    const auto median_with = [&](const std::uint8_t* row) HWY_ATTR {
      const auto seven = Sort<0, 7>([&](std::size_t i) HWY_ATTR { return hn::LoadU(d, row + x + i * step); });
      return Middle<1>(Merge(middle_of_42, seven))[0];
    };
    hn::StoreU(median_with(tile.front()), d, upper + x);
    hn::StoreU(median_with(tile.back()), d, lower + x);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace soffit
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>
#include <cstring>
#include <opencv2/imgproc.hpp>

#include "shared/result/result.h"

namespace soffit {
HWY_EXPORT(FilterStrip);
namespace {

using Row = std::array<std::uint8_t, ReadBytes(kStripBytes)>;

/// `count` bytes of a row from `first` on, which may lie before it: missing pixels are those of the nearest
/// end.
void CopyWithBorder(const std::uint8_t* row, int row_bytes, int step, int first, int count,
                    std::uint8_t* copy) {
  const int begin = std::max(first, 0);
  const int end = std::min(first + count, row_bytes);
  for (int at = first; at < begin; at += step) std::memcpy(copy + at - first, row, step);
  std::memcpy(copy + begin - first, row + begin, end - begin);
  for (int at = end; at < first + count; at += step)
    std::memcpy(copy + at - first, row + row_bytes - step, step);
}

/// Filters a row and the one below it into `upper` and `lower`. When both are the same, the upper one stays
/// there.
void FilterTwoRows(const cv::Mat& picture, int row, std::uint8_t* upper, std::uint8_t* lower) {
  constexpr int kReach = kWindow / 2;
  const int step = static_cast<int>(picture.elemSize());
  const int row_bytes = step * picture.cols;
  TileRows rows;
  for (int i = 0; i < kTileRows; ++i) {
    rows[i] = picture.ptr(std::clamp(row - kReach + i, 0, picture.rows - 1));
  }
  std::array<Row, kTileRows> border;
  std::array<std::array<std::uint8_t, kStripBytes + kMaxVectorBytes>, 2> strip;
  for (int at = 0; at < row_bytes; at += kStripBytes) {
    const int bytes = std::min<int>(kStripBytes, row_bytes - at);
    const int first = at - kReach * step;
    TileRows tile;
    for (std::size_t i = 0; i < tile.size(); ++i) {
      tile[i] = rows[i] + first;
      if (first >= 0 && first + ReadBytes(bytes) <= row_bytes) continue;
      CopyWithBorder(rows[i], row_bytes, step, first, bytes + 2 * kReach * step, border[i].data());
      tile[i] = border[i].data();
    }
    HWY_DYNAMIC_DISPATCH(FilterStrip)(tile, bytes, step, strip[0].data(), strip[1].data());
    std::memcpy(lower + at, strip[1].data(), bytes);
    std::memcpy(upper + at, strip[0].data(), bytes);
  }
}

}  // namespace

cv::Mat FilterMedian(const cv::Mat& picture, int size_px) {
  cv::Mat filtered;
  FilterMedian(picture, cv::Range(0, picture.rows), size_px, filtered);
  return filtered;
}

void FilterMedian(const cv::Mat& picture, const cv::Range& rows, int size_px, cv::Mat& filtered) {
  SOFFIT_EXPECT(rows.start >= 0 && rows.start <= rows.end && rows.end <= picture.rows);
  const bool has_network = picture.type() == CV_8UC1 || picture.type() == CV_8UC3;
  if (rows.empty() || !has_network || size_px != kWindow) {
    const int reach = size_px / 2;
    const cv::Range source(std::max(0, rows.start - reach), std::min(picture.rows, rows.end + reach));
    cv::Mat wider;
    cv::medianBlur(picture.rowRange(source), wider, size_px);
    filtered = wider.rowRange(rows.start - source.start, rows.end - source.start);
    return;
  }
  filtered.create(rows.size(), picture.cols, picture.type());
  for (int row = 0; row < rows.size(); row += 2) {
    FilterTwoRows(picture, rows.start + row, filtered.ptr(row),
                  filtered.ptr(std::min(row + 1, rows.size() - 1)));
  }
}

}  // namespace soffit
#endif
