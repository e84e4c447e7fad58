// Three passes over some dozen vectors of points: where they lie in A's grid, which layer is there, and how deep the
// few in a voxel of layer <= 0 are. Each pass is a short loop, so that the CPU works on several vectors at a time, and
// none branches on what was looked up just before. Every lane does what query_arithmetic.hpp does for one point, in the
// same order; Mul and Add stay apart because MulAdd fuses on some targets only.
//
// Compaction stores whole vectors whose first lanes count, so every column has room for one more vector at its end.
// AVX-512's compress is used once per vector, in its register form: the one that writes memory is microcode on Zen 4, a
// hundred cycles. Narrower targets use a table of their own: Highway 1.0.3 copies its table to the stack at every call
// under g++ 12.
#include "engine/contact/query_simd.hpp"

#include <array>
#include <bit>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "engine/contact/query_simd.cpp"
#include "hwy/foreach_target.h"  // compiles this file once per target
#include "hwy/highway.h"

#ifndef VERISIM_CONTACT_LANES_TO_FRONT
#define VERISIM_CONTACT_LANES_TO_FRONT
namespace verisim {

/// Row m: the lanes that are set in the mask m, in order.
template <std::size_t lanes>
inline constexpr auto kLanesToFront = [] {
  std::array<std::array<std::int32_t, lanes>, std::size_t{1} << lanes> table{};
  for (std::size_t mask = 0; mask < table.size(); ++mask) {
    std::size_t at = 0;
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      if ((mask >> lane & 1) != 0) table[mask][at++] = static_cast<std::int32_t>(lane);
    }
  }
  return table;
}();

/// What a cell of a window adds to a point's place along each axis: to the brick's number in the window, and, in the
/// upper half, to the cell's number in the brick.
alignas(64) inline constexpr auto kBrickAndCell = [] {
  std::array<std::array<std::int32_t, 32>, 3> table{};
  for (std::int32_t axis = 0, stride = 1; axis < 3; ++axis, stride *= 3) {
    for (std::int32_t i = 0; i < 3 * kBrickSide; ++i) {
      table[axis][i] = (i >> kBrickShift) * stride | (i & 7) << (16 + axis * kBrickShift);
    }
  }
  return table;
}();

}  // namespace verisim
#endif

HWY_BEFORE_NAMESPACE();
namespace verisim::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using Ints = hn::RebindToSigned<Floats>;
using F = hn::Vec<Floats>;
using I = hn::Vec<Ints>;
constexpr Floats kF;
constexpr Ints kI;
constexpr std::size_t kLanes = hn::MaxLanes(kF);
static_assert(kLanes <= ContactList::kPadding);

struct Triple {
  F x, y, z;
};

HWY_INLINE F dot(const float* row, const Triple& v) {
  const F xy = hn::Add(hn::Mul(hn::Set(kF, row[0]), v.x), hn::Mul(hn::Set(kF, row[1]), v.y));
  return hn::Add(xy, hn::Mul(hn::Set(kF, row[2]), v.z));
}

HWY_INLINE Triple rotate(const float* matrix, const Triple& v) {
  return {dot(matrix, v), dot(matrix + 3, v), dot(matrix + 6, v)};
}

/// Values [i, i + kLanes) of three columns; beyond their end: zeros, since reading there would leave the allocation.
using Column = std::vector<float>;
HWY_INLINE Triple load_points(const Column& x, const Column& y, const Column& z, std::size_t i) {
  if (HWY_LIKELY(i + kLanes <= x.size())) {
    return {hn::LoadU(kF, &x[i]), hn::LoadU(kF, &y[i]), hn::LoadU(kF, &z[i])};
  }
  HWY_ALIGN float padded[3][kLanes] = {};
  const std::size_t bytes = (x.size() - i) * sizeof(float);
  std::memcpy(padded[0], &x[i], bytes);
  std::memcpy(padded[1], &y[i], bytes);
  std::memcpy(padded[2], &z[i], bytes);
  return {hn::Load(kF, padded[0]), hn::Load(kF, padded[1]), hn::Load(kF, padded[2])};
}

HWY_INLINE I clamped(I cell, std::int32_t cell_max) {
  return hn::Min(hn::Max(cell, hn::Zero(kI)), hn::Set(kI, cell_max));
}

/// Cells along the three axes; only the low bits count.
struct Cells {
  I x, y, z;
};

HWY_INLINE I in_brick(const Cells& c) {
  const I x = hn::And(c.x, hn::Set(kI, 0007));
  const I xy = hn::OrAnd(x, hn::ShiftLeft<kBrickShift>(c.y), hn::Set(kI, 0070));
  return hn::OrAnd(xy, hn::ShiftLeft<2 * kBrickShift>(c.z), hn::Set(kI, 0700));
}

/// A point's place in the grid: where it is, rounded to its cell, and that cell counted from the corner of the window.
struct Located {
  Triple local, rounded;
  Cells cells;
};

HWY_INLINE Located locate_points(const QueryConstants& f, const Pointshell& shell, const PlacedCluster& c,
                                 std::size_t i) {
  const Triple p = load_points(shell.x, shell.y, shell.z, i);
  const Triple d = {hn::Sub(p.x, hn::Set(kF, c.center[0])), hn::Sub(p.y, hn::Set(kF, c.center[1])),
                    hn::Sub(p.z, hn::Set(kF, c.center[2]))};
  const Triple turned = rotate(f.voxels, d);
  Located at;
  at.local = {hn::Add(turned.x, hn::Set(kF, c.local[0])), hn::Add(turned.y, hn::Set(kF, c.local[1])),
              hn::Add(turned.z, hn::Set(kF, c.local[2]))};
  at.rounded = {hn::Add(at.local.x, hn::Set(kF, c.rounder[0])), hn::Add(at.local.y, hn::Set(kF, c.rounder[1])),
                hn::Add(at.local.z, hn::Set(kF, c.rounder[2]))};
  at.cells = {hn::BitCast(kI, at.rounded.x), hn::BitCast(kI, at.rounded.y), hn::BitCast(kI, at.rounded.z)};
  return at;
}

/// Slots of any points, looked up in the map's table of bricks.
HWY_INLINE I slots_anywhere(const QueryConstants& f, const PlacedCluster& c, const Cells& cells) {
  const auto in_grid = [&](I cell, int axis) {
    return clamped(hn::Add(cell, hn::Set(kI, c.corner[axis] - kRounderBits)), f.cell_max[axis]);
  };
  const Cells g = {in_grid(cells.x, 0), in_grid(cells.y, 1), in_grid(cells.z, 2)};
  const I row = hn::Mul(hn::ShiftRight<kBrickShift>(g.y), hn::Set(kI, f.row));
  const I slice = hn::Mul(hn::ShiftRight<kBrickShift>(g.z), hn::Set(kI, f.slice));
  const I brick = hn::Add(hn::Add(hn::ShiftRight<kBrickShift>(g.x), row), slice);
  const I block = hn::GatherIndex(kI, reinterpret_cast<const std::int32_t*>(f.brick_block), brick);
  return hn::Or(hn::ShiftLeft<3 * kBrickShift>(block), in_brick(g));
}

/// The 3 x 3 x 3 bricks around a cluster's base: all that its points can lie in if it is `near`. One look-up less in
/// memory, and no clamping, since what is beyond the grid is outside here too.
struct Window {
  static constexpr std::int32_t kSide = 3;
  HWY_ALIGN std::int32_t first_slot[32] = {};  ///< x fastest; the last 5 serve lanes without a point

  HWY_INLINE void open(const QueryConstants& f, const PlacedCluster& c) {
    const std::int32_t low[3] = {c.corner[0] >> kBrickShift, c.corner[1] >> kBrickShift, c.corner[2] >> kBrickShift};
    const bool within = low[0] >= 0 && low[1] >= 0 && low[2] >= 0 && low[0] + kRowRead <= f.bricks[0] &&
                        low[1] + kSide <= f.bricks[1] && low[2] + kSide <= f.bricks[2];
    if (HWY_LIKELY(within)) {
      copy(f, low);
    } else {
      copy_part(f, low);
    }
  }

  HWY_INLINE I slots(const Cells& c) const {
#if HWY_MAX_BYTES == 64
    // Tables of 32 words in two registers each, which take an index modulo 32: lanes without a point do no harm.
    const auto look_up = [](const std::int32_t* table, I index) {
      return I{_mm512_permutex2var_epi32(hn::Load(kI, table).raw, index.raw, hn::Load(kI, table + 16).raw)};
    };
    const I both = hn::Add(hn::Add(look_up(kBrickAndCell[0].data(), c.x), look_up(kBrickAndCell[1].data(), c.y)),
                           look_up(kBrickAndCell[2].data(), c.z));
    return hn::Or(look_up(first_slot, both), hn::ShiftRight<16>(both));
#else
    const I y = hn::ShiftRight<kBrickShift>(c.y);
    const I z = hn::ShiftRight<kBrickShift>(c.z);
    const I xy = hn::Add(hn::ShiftRight<kBrickShift>(c.x), hn::Add(y, hn::Add(y, y)));
    const I brick = hn::Add(xy, hn::Add(z, hn::ShiftLeft<3>(z)));
    return hn::Or(hn::GatherIndex(kI, first_slot, hn::And(brick, hn::Set(kI, 31))), in_brick(c));
#endif
  }

 private:
  static constexpr std::int32_t kRowRead = 4;  ///< bricks that copy_row reads

  HWY_INLINE void copy(const QueryConstants& f, const std::int32_t low[3]) {
    const std::uint32_t* slice = f.brick_block + low[0] + low[1] * f.row + low[2] * f.slice;
    std::int32_t* slot = first_slot;
    for (int z = 0; z < kSide; ++z, slice += f.slice, slot += kSide * kSide) {
      copy_row(slice, slot);
      copy_row(slice + f.row, slot + kSide);
      copy_row(slice + 2 * f.row, slot + 2 * kSide);
    }
  }

  /// Four at a time; the next row overwrites the fourth.
  static HWY_INLINE void copy_row(const std::uint32_t* row, std::int32_t* slot) {
    constexpr hn::CappedTag<std::int32_t, kRowRead> kRow;
    for (int x = 0; x < kRowRead; x += static_cast<int>(hn::MaxLanes(kRow))) {
      const auto blocks = hn::LoadU(kRow, reinterpret_cast<const std::int32_t*>(row + x));
      hn::StoreU(hn::ShiftLeft<3 * kBrickShift>(blocks), kRow, slot + x);
    }
  }

  void copy_part(const QueryConstants& f, const std::int32_t low[3]) {
    std::int32_t* slot = first_slot;
    for (std::int32_t z = low[2]; z < low[2] + kSide; ++z) {
      for (std::int32_t y = low[1]; y < low[1] + kSide; ++y) {
        for (std::int32_t x = low[0]; x < low[0] + kSide; ++x, ++slot) {
          const bool in_grid = x >= 0 && y >= 0 && z >= 0 && x < f.bricks[0] && y < f.bricks[1] && z < f.bricks[2];
          const std::uint32_t block = in_grid ? f.brick_block[x + y * f.row + z * f.slice] : kOutsideBlock;
          *slot = static_cast<std::int32_t>(block << 3 * kBrickShift);
        }
      }
    }
  }
};

#if HWY_MAX_BYTES == 64
/// The layers at 16 slots. Loaded one by one into four registers: a gather instruction takes half as long again.
class Layers {
 public:
  Layers() = default;
  HWY_INLINE Layers(const QueryConstants& f, const std::int32_t* slots)
      : bytes_(_mm_or_si128(_mm_or_si128(every_fourth<0>(f, slots), every_fourth<1>(f, slots)),
                            _mm_or_si128(every_fourth<2>(f, slots), every_fourth<3>(f, slots)))) {}
  [[nodiscard]] HWY_INLINE hn::Mask<Ints> not_outside() const {
    return hn::Mask<Ints>{_mm_cmple_epi8_mask(bytes_, _mm_setzero_si128())};
  }
  [[nodiscard]] HWY_INLINE I values() const { return I{_mm512_cvtepi8_epi32(bytes_)}; }

 private:
  template <int first>
  static HWY_INLINE __m128i every_fourth(const QueryConstants& f, const std::int32_t* slots) {
    const auto layer = [&](int lane) { return f.layers[static_cast<std::uint32_t>(slots[lane])]; };
    __m128i bytes = _mm_insert_epi8(_mm_setzero_si128(), layer(first), first);
    bytes = _mm_insert_epi8(bytes, layer(first + 4), first + 4);
    bytes = _mm_insert_epi8(bytes, layer(first + 8), first + 8);
    return _mm_insert_epi8(bytes, layer(first + 12), first + 12);
  }
  __m128i bytes_;
};
#else
/// The layers at a vector of slots.
class Layers {
 public:
  Layers() = default;
  /// Gathers whole aligned words (blocks have 512 bytes, so none reaches beyond the table) and shifts the byte up.
  HWY_INLINE Layers(const QueryConstants& f, const std::int32_t* from) {
    using Unsigned = hn::RebindToUnsigned<Ints>;
    const Unsigned u;
    const I slots = hn::Load(kI, from);
    const I word_index = hn::BitCast(kI, hn::ShiftRight<2>(hn::BitCast(u, slots)));
    const I words = hn::GatherIndex(kI, reinterpret_cast<const std::int32_t*>(f.layers), word_index);
    const I shift = hn::ShiftLeft<3>(hn::AndNot(slots, hn::Set(kI, 3)));  // byte k of 4 moves up by 24 - 8 k bits
    on_top_ = hn::BitCast(kI, hn::Shl(hn::BitCast(u, words), hn::BitCast(u, shift)));
  }
  [[nodiscard]] HWY_INLINE hn::Mask<Ints> not_outside() const { return hn::Lt(on_top_, hn::Set(kI, 1 << 24)); }
  [[nodiscard]] HWY_INLINE I values() const { return hn::ShiftRight<24>(on_top_); }

 private:
  I on_top_;  ///< each in the highest byte of its lane
};
#endif

/// The lanes that are set in a mask, in order.
#if HWY_MAX_BYTES == 64
HWY_INLINE I lanes_to_front(hn::Mask<Ints> mask) {
  return hn::Compress(hn::Iota(kI, 0), mask);
}
#else
HWY_INLINE I lanes_to_front(hn::Mask<Ints> mask) {
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(kI, mask, bits);
  return hn::LoadU(kI, kLanesToFront<kLanes>[bits[0]].data());
}
#endif

/// Moves the lanes of a mask to the front.
class Compaction {
 public:
  explicit HWY_INLINE Compaction(hn::Mask<Ints> mask)
      : lanes_(lanes_to_front(mask)), indices_(hn::IndicesFromVec(kI, lanes_)), count_(hn::CountTrue(kI, mask)) {}
  HWY_INLINE void store(F v, float* column) const {
    hn::StoreU(hn::BitCast(kF, hn::TableLookupLanes(hn::BitCast(kI, v), indices_)), kF, column);
  }
  HWY_INLINE void store(I v, std::uint32_t* column) const {
    hn::StoreU(hn::TableLookupLanes(v, indices_), kI, reinterpret_cast<std::int32_t*>(column));
  }
  /// The numbers of the lanes, counted from `first`.
  HWY_INLINE void store_numbers(std::size_t first, std::uint32_t* column) const {
    const I numbers = hn::Add(lanes_, hn::Set(kI, static_cast<std::int32_t>(first)));
    hn::StoreU(numbers, kI, reinterpret_cast<std::int32_t*>(column));
  }
  [[nodiscard]] HWY_INLINE std::size_t count() const { return count_; }

 private:
  I lanes_;
  decltype(hn::IndicesFromVec(kI, I())) indices_;
  std::size_t count_;
};

/// Vectors of points on their way through the passes. Small enough to stay in the first-level cache.
struct Chunk {
  static constexpr std::size_t kFull = 64;
  static constexpr std::size_t kRoom = kFull + kBrickCells / kLanes + 1;
  struct Vector {
    const PlacedCluster* cluster;
    std::size_t begin;  ///< its first point
    [[nodiscard]] HWY_INLINE hn::Mask<Ints> points() const { return hn::FirstN(kI, cluster->end - begin); }
  };
  Vector vectors[kRoom];
  HWY_ALIGN std::int32_t slots[kRoom][kLanes];
  Layers layers[kRoom];
  std::size_t with_candidates[kRoom];  ///< numbers of the vectors that have any
  std::size_t size = 0;
};

/// First pass: the slots of a cluster's points.
template <bool near>
HWY_INLINE void find_slots(const QueryConstants& f, const Pointshell& shell, const PlacedCluster& c,
                           const Window& window, Chunk& chunk) {
  for (std::size_t i = c.begin; i < c.end; i += kLanes) {
    const Located at = locate_points(f, shell, c, i);
    I slots;
    if constexpr (near) {
      slots = window.slots(at.cells);
    } else {
      slots = slots_anywhere(f, c, at.cells);
    }
    hn::Store(slots, kI, chunk.slots[chunk.size]);
    chunk.vectors[chunk.size++] = {&c, i};
  }
}

/// Of a chunk: vectors with candidates, and the candidates in them.
struct Found {
  std::size_t vectors = 0;
  std::size_t candidates = 0;
};

/// Second pass: the layers, and which vectors have candidates.
HWY_INLINE Found find_candidates(const QueryConstants& f, Chunk& chunk) {
  Found found;
  for (std::size_t k = 0; k < chunk.size; ++k) {
    const Layers layers(f, chunk.slots[k]);
    const std::size_t count = hn::CountTrue(kI, hn::And(layers.not_outside(), chunk.vectors[k].points()));
    chunk.layers[k] = layers;
    chunk.with_candidates[found.vectors] = k;
    found.vectors += count != 0 ? 1 : 0;
    found.candidates += count;
  }
  return found;
}

/// From a point to the centre of its voxel along one axis [voxel].
HWY_INLINE F to_center(F local, F rounded, float rounder) {
  return hn::Sub(hn::Sub(rounded, hn::Set(kF, rounder)), local);
}

HWY_INLINE F coordinates(std::int32_t base, F local, F voxel_size) {
  return hn::Mul(hn::Add(hn::Set(kF, static_cast<float>(base) + 0.5F), local), voxel_size);
}

/// Where a list goes on.
struct Columns {
  std::uint32_t *point, *slot;
  float *x, *y, *z, *nx, *ny, *nz, *depth;
};

HWY_INLINE Columns columns_of(ContactList& list) {
  return {list.point.data(), list.slot.data(), list.x.data(),  list.y.data(),    list.z.data(),
          list.nx.data(),    list.ny.data(),   list.nz.data(), list.depth.data()};
}

/// Third pass: writes those candidates of a vector that have a depth above zero to row `end` and on. Returns how many.
HWY_INLINE std::size_t append_touching(const QueryConstants& f, const Pointshell& shell, const Chunk& chunk,
                                       std::size_t k, const Columns& out, std::size_t end) {
  const Chunk::Vector& v = chunk.vectors[k];
  const PlacedCluster& c = *v.cluster;
  const F voxel_size = hn::Set(kF, f.voxel_size);
  const Located at = locate_points(f, shell, c, v.begin);  // once more: as quick as to have stored it
  const Triple n = rotate(f.rotation, load_points(shell.nx, shell.ny, shell.nz, v.begin));
  const F x = hn::Mul(to_center(at.local.x, at.rounded.x, c.rounder[0]), n.x);
  const F y = hn::Mul(to_center(at.local.y, at.rounded.y, c.rounder[1]), n.y);
  const F z = hn::Mul(to_center(at.local.z, at.rounded.z, c.rounder[2]), n.z);
  const F along = hn::Add(hn::Add(x, y), z);
  const F depth = hn::Mul(hn::Sub(along, hn::ConvertTo(kF, chunk.layers[k].values())), voxel_size);
  const auto candidates = hn::And(chunk.layers[k].not_outside(), v.points());
  const Compaction front(hn::And(hn::RebindMask(kI, hn::Gt(depth, hn::Zero(kF))), candidates));
  front.store_numbers(v.begin, out.point + end);
  front.store(hn::Load(kI, chunk.slots[k]), out.slot + end);
  front.store(coordinates(c.base[0], at.local.x, voxel_size), out.x + end);
  front.store(coordinates(c.base[1], at.local.y, voxel_size), out.y + end);
  front.store(coordinates(c.base[2], at.local.z, voxel_size), out.z + end);
  front.store(n.x, out.nx + end);
  front.store(n.y, out.ny + end);
  front.store(n.z, out.nz + end);
  front.store(depth, out.depth + end);
  return front.count();
}

/// Second and third pass. Empties the chunk and returns the number of candidates that were in it.
std::size_t finish(const QueryConstants& f, const Pointshell& shell, Chunk& chunk, ContactList& contacts) {
  const Found found = find_candidates(f, chunk);
  const Columns columns = columns_of(contacts);
  std::size_t end = contacts.size;
  for (std::size_t k = 0; k < found.vectors; ++k) {
    end += append_touching(f, shell, chunk, chunk.with_candidates[k], columns, end);
  }
  contacts.size = static_cast<std::uint32_t>(end);
  chunk.size = 0;
  return found.candidates;
}

std::uint64_t append_contacts_simd(const QueryConstants& f, const Pointshell& shell,
                                   std::span<const PlacedCluster> clusters, ContactList& contacts) {
  Chunk chunk;
  std::uint64_t candidates = 0;
  // Each window is opened one cluster ahead: loading it whole has to wait until its rows have left the CPU's store
  // buffer.
  Window windows[2];
  if (!clusters.empty()) windows[0].open(f, clusters[0]);
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    if (i + 1 < clusters.size()) windows[(i + 1) % 2].open(f, clusters[i + 1]);
    if (clusters[i].near) {
      find_slots<true>(f, shell, clusters[i], windows[i % 2], chunk);
    } else {
      find_slots<false>(f, shell, clusters[i], windows[i % 2], chunk);
    }
    if (chunk.size >= Chunk::kFull) candidates += finish(f, shell, chunk, contacts);
  }
  return candidates + finish(f, shell, chunk, contacts);
}

}  // namespace verisim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace verisim {

HWY_EXPORT(append_contacts_simd);

std::uint64_t append_contacts(const QueryConstants& constants, const Pointshell& shell,
                              std::span<const PlacedCluster> clusters, ContactList& contacts) {
  if (clusters.empty()) return 0;
  VERISIM_ASSERT(contacts.size <= clusters.front().begin);  // every point before it gave one contact or none
  VERISIM_ASSERT(clusters.back().end <= shell.size());
  VERISIM_ASSERT(shell.size() <= contacts.capacity());
  return HWY_DYNAMIC_DISPATCH(append_contacts_simd)(constants, shell, clusters, contacts);
}

}  // namespace verisim
#endif
