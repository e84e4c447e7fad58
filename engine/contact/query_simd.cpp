// Two passes over a cluster: all its points for their layer, then the few in a voxel of layer <= 0 for their depth.
// Every lane does what query_arithmetic.hpp does for one point, in the same order; Mul and Add stay apart because
// MulAdd fuses on some targets only.
//
// Compaction stores whole vectors whose first lanes count, so every array here has room for one more vector at its end.
// AVX-512's compress is used in its register form: the one that writes memory is microcode on Zen 4, a hundred cycles.
// Narrower targets use a table of their own: Highway 1.0.3 copies its table to the stack at every call under g++ 12.
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

}  // namespace verisim
#endif

HWY_BEFORE_NAMESPACE();
namespace verisim::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using Ints = hn::RebindToSigned<Floats>;
using F = hn::Vec<Floats>;
using I = hn::Vec<Ints>;
using M = hn::Mask<Floats>;
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

/// Points [i, i + kLanes) of the shell; beyond its end: zeros, since reading there would leave the allocation.
HWY_INLINE Triple load_points(const Pointshell& shell, std::size_t i) {
  if (HWY_LIKELY(i + kLanes <= shell.x.size())) {
    return {hn::LoadU(kF, &shell.x[i]), hn::LoadU(kF, &shell.y[i]), hn::LoadU(kF, &shell.z[i])};
  }
  HWY_ALIGN float padded[3][kLanes] = {};
  const std::size_t bytes = (shell.x.size() - i) * sizeof(float);
  std::memcpy(padded[0], &shell.x[i], bytes);
  std::memcpy(padded[1], &shell.y[i], bytes);
  std::memcpy(padded[2], &shell.z[i], bytes);
  return {hn::Load(kF, padded[0]), hn::Load(kF, padded[1]), hn::Load(kF, padded[2])};
}

/// Cell of a local coordinate along one axis, clamped to the grid.
HWY_INLINE I cell_along(F local, std::int32_t base, std::int32_t cell_max) {
  const I bits = hn::BitCast(kI, hn::Add(hn::Floor(local), hn::Set(kF, kIntegerMagic)));
  const I cell = hn::Add(bits, hn::Set(kI, base - kIntegerMagicBits));
  return hn::Min(hn::Max(cell, hn::Zero(kI)), hn::Set(kI, cell_max));
}

HWY_INLINE I slots_of(const QueryFrame& f, I x, I y, I z) {
  const I row = hn::Mul(hn::ShiftRight<kBrickShift>(y), hn::Set(kI, f.row));
  const I slice = hn::Mul(hn::ShiftRight<kBrickShift>(z), hn::Set(kI, f.slice));
  const I brick = hn::Add(hn::Add(hn::ShiftRight<kBrickShift>(x), row), slice);
  const I seven = hn::Set(kI, kBrickSide - 1);
  const I in_brick =
      hn::Or(hn::Or(hn::And(x, seven), hn::ShiftLeft<3>(hn::And(y, seven))), hn::ShiftLeft<6>(hn::And(z, seven)));
  const I block = hn::GatherIndex(kI, reinterpret_cast<const std::int32_t*>(f.brick_block), brick);
  return hn::Or(hn::ShiftLeft<9>(block), in_brick);
}

/// The layers at the slots, each in the highest byte of its lane. Gathers whole aligned words (blocks have 512 bytes,
/// so none reaches beyond the table) and shifts the byte up.
HWY_INLINE I layers_on_top(const QueryFrame& f, I slots) {
  using Unsigned = hn::RebindToUnsigned<Ints>;
  const Unsigned u;
  const I word_index = hn::BitCast(kI, hn::ShiftRight<2>(hn::BitCast(u, slots)));
  const I words = hn::GatherIndex(kI, reinterpret_cast<const std::int32_t*>(f.layers), word_index);
  const I shift = hn::ShiftLeft<3>(hn::AndNot(slots, hn::Set(kI, 3)));  // byte k of 4 moves up by 24 - 8 k bits
  return hn::BitCast(kI, hn::Shl(hn::BitCast(u, words), hn::BitCast(u, shift)));
}

/// Moves the lanes of a mask to the front.
#if HWY_MAX_BYTES == 64
class Compaction {
 public:
  explicit HWY_INLINE Compaction(hn::Mask<Ints> mask) : ints_(mask), floats_(hn::RebindMask(kF, mask)) {}
  HWY_INLINE void store(F v, float* column) const { hn::StoreU(hn::Compress(v, floats_), kF, column); }
  HWY_INLINE void store(I v, std::int32_t* column) const { hn::StoreU(hn::Compress(v, ints_), kI, column); }
  [[nodiscard]] HWY_INLINE std::size_t count() const { return hn::CountTrue(kI, ints_); }

 private:
  hn::Mask<Ints> ints_;
  M floats_;
};
#else
class Compaction {
 public:
  explicit HWY_INLINE Compaction(hn::Mask<Ints> mask) : bits_(bits_of(mask)) {}
  HWY_INLINE void store(F v, float* column) const {
    hn::StoreU(hn::TableLookupLanes(v, hn::SetTableIndices(kF, row())), kF, column);
  }
  HWY_INLINE void store(I v, std::int32_t* column) const {
    hn::StoreU(hn::TableLookupLanes(v, hn::SetTableIndices(kI, row())), kI, column);
  }
  [[nodiscard]] HWY_INLINE std::size_t count() const { return static_cast<std::size_t>(std::popcount(bits_)); }

 private:
  static HWY_INLINE unsigned bits_of(hn::Mask<Ints> mask) {
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(kI, mask, bits);
    return bits[0];
  }
  [[nodiscard]] HWY_INLINE const std::int32_t* row() const { return kLanesToFront<kLanes>[bits_].data(); }
  unsigned bits_;
};
#endif

struct Candidates {
  static constexpr std::size_t kRoom = kBrickCells + kLanes;
  HWY_ALIGN float x[kRoom], y[kRoom], z[kRoom];  ///< local coordinates
  HWY_ALIGN std::int32_t point[kRoom], slot[kRoom], layer[kRoom];
  std::size_t size;
};

HWY_INLINE void find_candidates(const QueryFrame& f, const Pointshell& shell, const ClusterFrame& c,
                                Candidates& found) {
  found.size = 0;
  const I first_above_zero = hn::Set(kI, 1 << 24);
  for (std::size_t i = c.begin; i < c.end; i += kLanes) {
    const Triple p = load_points(shell, i);
    const Triple d = {hn::Sub(p.x, hn::Set(kF, c.center[0])), hn::Sub(p.y, hn::Set(kF, c.center[1])),
                      hn::Sub(p.z, hn::Set(kF, c.center[2]))};
    const Triple turned = rotate(f.voxels, d);
    const Triple local = {hn::Add(turned.x, hn::Set(kF, c.fraction[0])), hn::Add(turned.y, hn::Set(kF, c.fraction[1])),
                          hn::Add(turned.z, hn::Set(kF, c.fraction[2]))};
    const I slots =
        slots_of(f, cell_along(local.x, c.base[0], f.cell_max[0]), cell_along(local.y, c.base[1], f.cell_max[1]),
                 cell_along(local.z, c.base[2], f.cell_max[2]));
    const I layers = layers_on_top(f, slots);
    const auto within = hn::And(hn::Lt(layers, first_above_zero), hn::FirstN(kI, c.end - i));
    if (hn::AllFalse(kI, within)) continue;
    const Compaction front(within);
    const std::size_t at = found.size;
    front.store(local.x, found.x + at);
    front.store(local.y, found.y + at);
    front.store(local.z, found.z + at);
    front.store(hn::Iota(kI, static_cast<std::int32_t>(i)), found.point + at);
    front.store(slots, found.slot + at);
    front.store(hn::ShiftRight<24>(layers), found.layer + at);
    found.size = at + front.count();
  }
}

HWY_INLINE void append_touching(const QueryFrame& f, const Pointshell& shell, const ClusterFrame& c,
                                const Candidates& found, ContactList& out) {
  const F half = hn::Set(kF, 0.5F);
  const F voxel_size = hn::Set(kF, f.voxel_size);
  for (std::size_t i = 0; i < found.size; i += kLanes) {
    const auto real = hn::FirstN(kI, found.size - i);
    const I points =
        hn::IfThenElseZero(real, hn::Load(kI, found.point + i));  // point 0 stands in for lanes of no candidate
    const Triple n =
        rotate(f.rotation, {hn::GatherIndex(kF, shell.nx.data(), points), hn::GatherIndex(kF, shell.ny.data(), points),
                            hn::GatherIndex(kF, shell.nz.data(), points)});
    const Triple local = {hn::LoadU(kF, found.x + i), hn::LoadU(kF, found.y + i), hn::LoadU(kF, found.z + i)};
    const F along = hn::Add(hn::Add(hn::Mul(hn::Sub(half, hn::Sub(local.x, hn::Floor(local.x))), n.x),
                                    hn::Mul(hn::Sub(half, hn::Sub(local.y, hn::Floor(local.y))), n.y)),
                            hn::Mul(hn::Sub(half, hn::Sub(local.z, hn::Floor(local.z))), n.z));
    const F layer = hn::ConvertTo(kF, hn::LoadU(kI, found.layer + i));
    const F depth = hn::Mul(hn::Sub(along, layer), voxel_size);
    const auto touching = hn::And(hn::RebindMask(kI, hn::Gt(depth, hn::Zero(kF))), real);
    if (hn::AllFalse(kI, touching)) continue;
    const Compaction front(touching);
    const std::size_t at = out.size;
    front.store(points, reinterpret_cast<std::int32_t*>(&out.point[at]));
    front.store(hn::LoadU(kI, found.slot + i), reinterpret_cast<std::int32_t*>(&out.slot[at]));
    front.store(hn::Mul(hn::Add(hn::Set(kF, static_cast<float>(c.base[0])), local.x), voxel_size), &out.x[at]);
    front.store(hn::Mul(hn::Add(hn::Set(kF, static_cast<float>(c.base[1])), local.y), voxel_size), &out.y[at]);
    front.store(hn::Mul(hn::Add(hn::Set(kF, static_cast<float>(c.base[2])), local.z), voxel_size), &out.z[at]);
    front.store(n.x, &out.nx[at]);
    front.store(n.y, &out.ny[at]);
    front.store(n.z, &out.nz[at]);
    front.store(depth, &out.depth[at]);
    out.size += static_cast<std::uint32_t>(front.count());
  }
}

std::uint64_t append_contacts_simd(const QueryFrame& f, const Pointshell& shell, std::span<const ClusterFrame> clusters,
                                   ContactList& contacts) {
  Candidates found;  // not initialised: 12 kB that only the compaction writes
  std::uint64_t candidates = 0;
  for (const ClusterFrame& c : clusters) {
    find_candidates(f, shell, c, found);
    append_touching(f, shell, c, found, contacts);
    candidates += found.size;
  }
  return candidates;
}

}  // namespace verisim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace verisim {

HWY_EXPORT(append_contacts_simd);

std::uint64_t append_contacts(const QueryFrame& frame, const Pointshell& shell, std::span<const ClusterFrame> clusters,
                              ContactList& contacts) {
  return HWY_DYNAMIC_DISPATCH(append_contacts_simd)(frame, shell, clusters, contacts);
}

}  // namespace verisim
#endif
