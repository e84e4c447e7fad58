#include "engine/voxel/voxmap.hpp"

#include <cmath>

namespace verisim {

namespace {

/// The brick, cell in the brick and block of a grid cell.
struct Slot {
  std::uint32_t block;
  std::uint32_t cell;
};

bool in_grid(const Voxmap& map, const Eigen::Vector3i& cell) {
  return (cell.array() >= 0).all() && (cell.array() < kBrickSide * map.bricks.array()).all();
}

Slot slot_of(const Voxmap& map, const Eigen::Vector3i& cell) {
  const Eigen::Matrix<std::size_t, 3, 1> c = cell.cast<std::size_t>(), n = map.bricks.cast<std::size_t>();
  const std::size_t brick = ((c.z() >> kBrickShift) * n.y() + (c.y() >> kBrickShift)) * n.x() + (c.x() >> kBrickShift);
  return {map.brick_block[brick], static_cast<std::uint32_t>((c.x() & 7) + 8 * (c.y() & 7) + 64 * (c.z() & 7))};
}

template <class T>
std::size_t bytes(const std::vector<T>& column) {
  return column.capacity() * sizeof(T);
}

}  // namespace

Eigen::Vector3i Voxmap::cell_of(const Vector3d& p_B) const {
  return ((p_B - origin) / voxel_size).array().floor().cast<int>();
}

Layer Voxmap::layer(const Eigen::Vector3i& cell) const {
  if (!in_grid(*this, cell)) return kBand + 1;
  const Slot slot = slot_of(*this, cell);
  return layers[static_cast<std::size_t>(slot.block) * kBrickCells + slot.cell];
}

Layer Voxmap::layer_at(const Vector3d& p_B) const {
  // Compared as floating point first: a far point's cell need not fit an int.
  const Vector3d p = (p_B - origin) / voxel_size;
  const bool inside = (p.array() >= 0).all() && (p.array() < kBrickSide * bricks.cast<double>().array()).all();
  return inside ? layer(p.array().floor().cast<int>()) : Layer{kBand + 1};
}

std::int64_t Voxmap::surface_number(const Eigen::Vector3i& cell) const {
  if (!in_grid(*this, cell)) return -1;
  const Slot slot = slot_of(*this, cell);
  return surface_number_of_slot(*this, slot.block * kBrickCells + slot.cell);
}

std::size_t Voxmap::memory_bytes() const {
  return sizeof *this + bytes(brick_block) + bytes(brick_clearance) + bytes(layers) + bytes(surface_mask) +
         bytes(first_surface);
}

std::size_t Pointshell::memory_bytes() const {
  return sizeof *this + bytes(x) + bytes(y) + bytes(z) + bytes(nx) + bytes(ny) + bytes(nz) + bytes(voxel) +
         bytes(features) + bytes(clusters);
}

}  // namespace verisim
