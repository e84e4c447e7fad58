// The bound that a query is measured against: what remains of it if nothing had to be decided. Every point is
// transformed and one byte is gathered from a table of the same size; no list, no layers, no culling. Vectorised like
// the query.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/base/pose.hpp"
#include "engine/voxel/voxmap.hpp"

namespace verisim::bench {

/// A dense table with as many bytes as the voxmap's layers, stretched over the voxmap's grid: neighbouring points read
/// neighbouring bytes, as in the query.
class GatherBound {
 public:
  explicit GatherBound(const Voxmap& a);
  /// Sum of the gathered bytes, so that none of the work can be left out. Whole vectors only: up to 15 points are left
  /// out.
  [[nodiscard]] std::uint64_t sum(const Pointshell& b, const Pose& X_AB) const;
  /// The same point by point: what sum() must equal.
  [[nodiscard]] std::uint64_t sum_plainly(const Pointshell& b, const Pose& X_AB) const;

  struct Placement {
    float rotation[9];  ///< to cells of the table
    float position[3];
    std::int32_t cells[3];
    const std::uint8_t* table;
  };

 private:
  [[nodiscard]] Placement placement(const Pointshell& b, const Pose& X_AB) const;
  std::vector<std::uint8_t> table_;
  std::int32_t cells_[3];
  Vector3d origin_;
  double per_metre_;
};

}  // namespace verisim::bench
