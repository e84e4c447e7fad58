#include "engine/voxel/overlap.hpp"

#include <algorithm>
#include <cmath>

#include "engine/base/error.hpp"
#include "engine/voxel/voxelize.hpp"

namespace verisim {

namespace {

/// Coordinates (u, v) of the three planes: xy, yz, xz.
constexpr std::array<std::array<int, 2>, 3> kPlanes = {{{0, 1}, {1, 2}, {0, 2}}};

/// Bit y of a byte to all eight bits of byte y.
std::uint64_t bits_to_rows(std::uint64_t byte) {
  const std::uint64_t one_per_row = (byte * kEveryByte) & 0x8040201008040201;
  return ((one_per_row + 0x7F * kEveryByte) >> 7 & kEveryByte) * 0xFF;
}

}  // namespace

TriangleOverlap::TriangleOverlap(const Vector3d& a, const Vector3d& b, const Vector3d& c)
    : lower_(a.cwiseMin(b).cwiseMin(c)), upper_(a.cwiseMax(b).cwiseMax(c)), normal_((b - a).cross(c - a)) {
  const std::array<const Vector3d*, 3> corners = {&a, &b, &c};
  const double na = normal_.dot(a), nb = normal_.dot(b), nc = normal_.dot(c);
  normal_low_ = std::min({na, nb, nc});
  normal_high_ = std::max({na, nb, nc});
  for (std::size_t plane = 0; plane < 3; ++plane) {
    const int u = kPlanes[plane][0], v = kPlanes[plane][1];
    for (std::size_t i = 0; i < 3; ++i) {
      const Vector3d edge = *corners[(i + 1) % 3] - *corners[i];
      FlatAxis& axis = axes_[plane][i];
      axis.u = -edge[v];
      axis.v = edge[u];
      const auto along = [&](const Vector3d& p) { return axis.u * p[u] + axis.v * p[v]; };
      axis.low = std::min({along(a), along(b), along(c)});
      axis.high = std::max({along(a), along(b), along(c)});
    }
  }
}

TriangleOverlap::Range TriangleOverlap::overlapped(double low, double high, double corner, const BoxLattice& lattice) {
  const auto center = [&](int i) { return corner + (i + 0.5) * lattice.side; };
  Range range = {0, kBrickSide};
  while (range.begin < range.end && center(range.begin) + lattice.half_side < low) ++range.begin;
  while (range.end > range.begin && center(range.end - 1) - lattice.half_side > high) --range.end;
  return range;
}

std::uint64_t TriangleOverlap::pattern(int plane, const BoxLattice& lattice, Range u, Range v) const {
  const int axis_u = kPlanes[static_cast<std::size_t>(plane)][0], axis_v = kPlanes[static_cast<std::size_t>(plane)][1];
  const auto center_u = [&](int i) { return lattice.corner[axis_u] + (i + 0.5) * lattice.side; };
  const auto center_v = [&](int i) { return lattice.corner[axis_v] + (i + 0.5) * lattice.side; };
  std::uint64_t bits = 0;
  for (int j = v.begin; j < v.end; ++j)
    bits |= ((std::uint64_t{1} << u.end) - (std::uint64_t{1} << u.begin)) << (8 * j);
  for (const FlatAxis& axis : axes_[static_cast<std::size_t>(plane)]) {
    const double radius = lattice.half_side * (std::abs(axis.u) + std::abs(axis.v));
    const double low = axis.low - radius, high = axis.high + radius;
    const double u0 = axis.u * center_u(u.begin), u1 = axis.u * center_u(u.end - 1);
    const double v0 = axis.v * center_v(v.begin), v1 = axis.v * center_v(v.end - 1);
    if (std::min(u0, u1) + std::min(v0, v1) >= low && std::max(u0, u1) + std::max(v0, v1) <= high) continue;
    for (int j = v.begin; j < v.end; ++j) {
      const double row = axis.v * center_v(j);
      std::uint64_t in = 0;
      for (int i = u.begin; i < u.end; ++i) {
        const double t = axis.u * center_u(i) + row;
        in |= static_cast<std::uint64_t>((t >= low) & (t <= high)) << i;
      }
      bits &= in << (8 * j) | ~(std::uint64_t{0xFF} << (8 * j));
    }
  }
  return bits;
}

void TriangleOverlap::keep_near_plane(const BoxLattice& lattice, const std::array<Range, 3>& range,
                                      BrickMask& mask) const {
  const double radius = lattice.half_side * normal_.cwiseAbs().sum();
  const double low = normal_low_ - radius, high = normal_high_ + radius;
  const auto along = [&](int axis, int i) { return normal_[axis] * (lattice.corner[axis] + (i + 0.5) * lattice.side); };
  std::array<double, 8> along_x{};
  for (int x = range[0].begin; x < range[0].end; ++x) along_x[static_cast<std::size_t>(x)] = along(0, x);
  const auto [x_first, x_last] = std::minmax(along_x[static_cast<std::size_t>(range[0].begin)],
                                             along_x[static_cast<std::size_t>(range[0].end - 1)]);
  for (int z = range[2].begin; z < range[2].end; ++z) {
    std::uint64_t& word = mask[static_cast<std::size_t>(z)];
    const double along_z = along(2, z);
    for (int y = range[1].begin; y < range[1].end; ++y) {
      const std::uint64_t row_bits = std::uint64_t{0xFF} << (8 * y);
      if ((word & row_bits) == 0) continue;
      const double row = along_z + along(1, y);
      if (x_first + row >= low && x_last + row <= high) continue;
      std::uint64_t in = 0;
      for (int x = range[0].begin; x < range[0].end; ++x) {
        const double t = along_x[static_cast<std::size_t>(x)] + row;
        in |= static_cast<std::uint64_t>((t >= low) & (t <= high)) << x;
      }
      word &= in << (8 * y) | ~row_bits;
    }
  }
}

BrickMask TriangleOverlap::touched(const BoxLattice& lattice) const {
  BrickMask mask{};
  std::array<Range, 3> range;
  for (int axis = 0; axis < 3; ++axis) {
    Range& r = range[static_cast<std::size_t>(axis)];
    r = overlapped(lower_[axis], upper_[axis], lattice.corner[axis], lattice);
    if (r.begin >= r.end) return mask;
  }
  const std::uint64_t xy = pattern(0, lattice, range[0], range[1]);
  if (xy == 0) return mask;
  const std::uint64_t yz = pattern(1, lattice, range[1], range[2]);
  const std::uint64_t xz = pattern(2, lattice, range[0], range[2]);
  for (int z = range[2].begin; z < range[2].end; ++z) {
    mask[static_cast<std::size_t>(z)] = xy & bits_to_rows(yz >> (8 * z) & 0xFF) & (xz >> (8 * z) & 0xFF) * kEveryByte;
  }
  keep_near_plane(lattice, range, mask);
  return mask;
}

bool triangle_touches_box(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& center,
                          double half_side) {
  VERISIM_ASSERT(half_side > 0);
  const double half = half_side * (1 + kTouchTolerance);
  const std::array<Vector3d, 3> p = {a - center, b - center, c - center};
  const auto separates = [&](const Vector3d& axis) {
    const double radius = half * axis.cwiseAbs().sum();
    const double p0 = axis.dot(p[0]), p1 = axis.dot(p[1]), p2 = axis.dot(p[2]);
    return std::min({p0, p1, p2}) > radius || std::max({p0, p1, p2}) < -radius;
  };
  for (int i = 0; i < 3; ++i) {
    if (separates(Vector3d::Unit(i))) return false;
  }
  const std::array<Vector3d, 3> edges = {b - a, c - b, a - c};
  for (const Vector3d& edge : edges) {
    for (int i = 0; i < 3; ++i) {
      if (separates(edge.cross(Vector3d::Unit(i)))) return false;
    }
  }
  return !separates(edges[0].cross(edges[1]));
}

}  // namespace verisim
