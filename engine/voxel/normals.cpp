#include "engine/voxel/normals.hpp"

#include <algorithm>
#include <cmath>

#include "engine/voxel/clip.hpp"

namespace verisim {

namespace {

constexpr double kCancelled = 0x1p-10;      // |sum| / area below which opposite faces count as cancelling
constexpr double kSameDirection = 0x1p-30;  // distance of unit normals that differ by rounding only

bool same_direction(const Vector3d& a, const Vector3d& b) {
  return (a - b).cwiseAbs().maxCoeff() < kSameDirection;
}

/// Lexicographic, but blind to rounding.
bool before(const Vector3d& a, const Vector3d& b) {
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(a[axis] - b[axis]) > kSameDirection) return a[axis] < b[axis];
  }
  return false;
}

struct Cells {
  int begin, end;
};

/// Cells of the brick whose grown interval meets [low, high].
Cells cells_meeting(double low, double high) {
  const int begin = static_cast<int>(std::floor(std::clamp(low - kCandidateMargin, -1.0, 8.0)));
  const int end = static_cast<int>(std::floor(std::clamp(high + kCandidateMargin, -1.0, 8.0))) + 1;
  return {std::max(begin, 0), std::min(end, kBrickSide)};
}

Polygon slab_of_cell(const Polygon& polygon, int axis, int cell) {
  return slab(polygon, axis, cell - kCandidateMargin, cell + 1 + kCandidateMargin);
}

/// Calls visit(x, y, z, polygon) with the part of the triangle in each cell of the brick that has one.
template <class Visit>
void for_each_piece(const std::array<Vector3d, 3>& corners, Visit visit) {
  const Polygon triangle{.corner = {corners[0], corners[1], corners[2]}, .size = 3};
  const Cells slabs = cells_meeting(triangle.low(2), triangle.high(2));
  for (int z = slabs.begin; z < slabs.end; ++z) {
    const Polygon in_z = slab_of_cell(triangle, 2, z);
    if (in_z.empty()) continue;
    const Cells rows = cells_meeting(in_z.low(1), in_z.high(1));
    for (int y = rows.begin; y < rows.end; ++y) {
      const Polygon in_yz = slab_of_cell(in_z, 1, y);
      if (in_yz.empty()) continue;
      const Cells cells = cells_meeting(in_yz.low(0), in_yz.high(0));
      for (int x = cells.begin; x < cells.end; ++x) {
        const Polygon piece = slab_of_cell(in_yz, 0, x);
        if (!piece.empty()) visit(x, y, z, piece);
      }
    }
  }
}

std::size_t cell_index(int x, int y, int z) {
  const int index = x + 8 * y + 64 * z;
  return static_cast<std::size_t>(index);
}

}  // namespace

void BrickNormals::load(std::span<const std::uint32_t> triangles, const Eigen::Vector3i& corner) {
  facets_.clear();
  for (const std::uint32_t t : triangles) {
    Facet facet{.corners = mesh_.corners(t), .inward = Vector3d::Zero()};
    for (Vector3d& p : facet.corners) p -= corner.cast<double>();
    const auto& [a, b, c] = facet.corners;
    const Vector3d outward = (b - a).cross(c - a);
    const double length = outward.norm();
    if (!(length > 0)) continue;  // no area: no weight
    facet.inward = outward / -length;
    facets_.push_back(facet);
  }
}

void BrickNormals::add_areas(const Facet& facet) {
  for_each_piece(facet.corners, [&](int x, int y, int z, const Polygon& piece) {
    const double area = piece.area(facet.inward);
    const std::size_t cell = cell_index(x, y, z);
    area_[cell] += area;
    sum_[cell] += area * facet.inward;
  });
}

Vector3d BrickNormals::largest_direction(int x, int y, int z) const {
  std::vector<std::pair<Vector3d, double>> directions;
  for (const Facet& facet : facets_) {
    double area = 0;
    for_each_piece(facet.corners, [&](int px, int py, int pz, const Polygon& piece) {
      if (px == x && py == y && pz == z) area += piece.area(facet.inward);
    });
    const auto known = std::find_if(directions.begin(), directions.end(), [&](const auto& direction) {
      return same_direction(direction.first, facet.inward);
    });
    if (known != directions.end()) {
      known->second += area;
    } else {
      directions.emplace_back(facet.inward, area);
    }
  }
  const auto* best = &directions.front();
  for (const auto& candidate : directions) {
    const double more = candidate.second - best->second;
    const bool equal = std::abs(more) <= kSameDirection * best->second;
    if (equal ? before(candidate.first, best->first) : more > 0) best = &candidate;
  }
  return best->first;
}

std::span<const Vector3d> BrickNormals::compute(std::span<const std::uint32_t> triangles, const Eigen::Vector3i& corner,
                                                const BrickMask& cells) {
  load(triangles, corner);
  result_.clear();
  const auto n = static_cast<std::size_t>(count(cells));
  if (facets_.empty()) {
    result_.assign(n, Vector3d::UnitZ());
    return result_;
  }
  const bool flat = std::all_of(facets_.begin() + 1, facets_.end(), [&](const Facet& facet) {
    return same_direction(facet.inward, facets_.front().inward);
  });
  if (flat) {
    result_.assign(n, facets_.front().inward);
    return result_;
  }
  sum_.fill(Vector3d::Zero());
  area_.fill(0);
  for (const Facet& facet : facets_) add_areas(facet);
  for_each_cell(cells, [&](int x, int y, int z) {
    const std::size_t cell = cell_index(x, y, z);
    const double length = sum_[cell].norm();
    if (length > kCancelled * area_[cell]) {
      result_.push_back(sum_[cell] / length);
    } else {
      result_.push_back(area_[cell] > 0 ? largest_direction(x, y, z) : Vector3d::UnitZ());
    }
  });
  return result_;
}

}  // namespace verisim
