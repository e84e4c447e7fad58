#include "bench/gather_bound.hpp"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/gather_bound.cpp"
#include "hwy/foreach_target.h"  // compiles this file once per target
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace verisim::bench::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using Ints = hn::RebindToSigned<Floats>;
constexpr Floats kF;
constexpr Ints kI;

HWY_INLINE hn::Vec<Ints> cell_along(const GatherBound::Placement& f, int axis, hn::Vec<Floats> x, hn::Vec<Floats> y,
                                    hn::Vec<Floats> z) {
  const float* row = f.rotation + 3 * axis;
  const auto xy = hn::Add(hn::Mul(hn::Set(kF, row[0]), x), hn::Mul(hn::Set(kF, row[1]), y));
  const auto g = hn::Add(hn::Add(xy, hn::Mul(hn::Set(kF, row[2]), z)), hn::Set(kF, f.position[axis]));
  const auto inside = hn::Min(hn::Max(g, hn::Zero(kF)), hn::Set(kF, static_cast<float>(f.cells[axis] - 1)));
  return hn::ConvertTo(kI, inside);  // not negative: truncation is floor
}

std::uint64_t gather_all(const GatherBound::Placement& f, const Pointshell& b) {
  const std::size_t lanes = hn::Lanes(kI);
  const auto row = hn::Set(kI, f.cells[0]);
  const auto slice = hn::Set(kI, f.cells[0] * f.cells[1]);
  auto sum = hn::Zero(kI);
  for (std::size_t i = 0, end = b.size() / 16 * 16; i < end; i += lanes) {
    const auto x = hn::LoadU(kF, &b.x[i]);
    const auto y = hn::LoadU(kF, &b.y[i]);
    const auto z = hn::LoadU(kF, &b.z[i]);
    const auto index = hn::Add(hn::Add(cell_along(f, 0, x, y, z), hn::Mul(cell_along(f, 1, x, y, z), row)),
                               hn::Mul(cell_along(f, 2, x, y, z), slice));
    const auto words = hn::GatherOffset(kI, reinterpret_cast<const std::int32_t*>(f.table), index);
    sum = hn::Add(sum, hn::And(words, hn::Set(kI, 255)));
  }
  return static_cast<std::uint32_t>(hn::GetLane(hn::SumOfLanes(kI, sum)));
}

}  // namespace verisim::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace verisim::bench {

HWY_EXPORT(gather_all);

GatherBound::GatherBound(const Voxmap& a) : origin_(a.origin) {
  const double bytes = static_cast<double>(a.layers.size());
  const Vector3d sides = a.voxel_size * kBrickSide * a.bricks.cast<double>();
  per_metre_ = std::cbrt(bytes / sides.prod());
  std::size_t cells = 1;
  for (int i = 0; i < 3; ++i) {
    cells_[i] = static_cast<std::int32_t>(std::ceil(sides[i] * per_metre_));
    cells *= static_cast<std::size_t>(cells_[i]);
  }
  table_.resize(cells + 3);  // the last byte is gathered with the three after it
  for (std::size_t i = 0; i < table_.size(); ++i) table_[i] = static_cast<std::uint8_t>(i * 167 >> 3);
}

GatherBound::Placement GatherBound::placement(const Pointshell& b, const Pose& X_AB) const {
  Placement f{};
  const Matrix3d R = X_AB.rotation.toRotationMatrix() * per_metre_;
  const Vector3d t = (X_AB * b.reference - origin_) * per_metre_;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) f.rotation[3 * i + j] = static_cast<float>(R(i, j));
    f.position[i] = static_cast<float>(t[i]);
    f.cells[i] = cells_[i];
  }
  f.table = table_.data();
  return f;
}

std::uint64_t GatherBound::sum(const Pointshell& b, const Pose& X_AB) const {
  return HWY_DYNAMIC_DISPATCH(gather_all)(placement(b, X_AB), b);
}

std::uint64_t GatherBound::sum_plainly(const Pointshell& b, const Pose& X_AB) const {
  const Placement f = placement(b, X_AB);
  std::uint32_t total = 0;
  const std::size_t whole = b.size() / 16 * 16;
  for (std::size_t i = 0; i < whole; ++i) {
    std::size_t index = 0;
    for (int axis = 2; axis >= 0; --axis) {
      const float* row = f.rotation + 3 * axis;
      const float g = row[0] * b.x[i] + row[1] * b.y[i] + row[2] * b.z[i] + f.position[axis];
      const float inside = std::min(std::max(g, 0.0F), static_cast<float>(f.cells[axis] - 1));
      index = index * static_cast<std::size_t>(f.cells[axis]) + static_cast<std::size_t>(inside);
    }
    total += f.table[index];
  }
  return total;
}

}  // namespace verisim::bench
#endif
