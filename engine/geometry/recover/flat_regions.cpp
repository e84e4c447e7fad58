#include "engine/geometry/recover/flat_regions.hpp"

#include <CGAL/Shape_detection/Region_growing/Region_growing.h>
#include <CGAL/property_map.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numeric>

namespace verisim::recover {

namespace {

/// CGAL's neighbor query: the triangles adjacent to one.
class Beside {
 public:
  explicit Beside(const CanonicalMesh& mesh) : mesh_(mesh) {}
  void operator()(std::size_t triangle, std::vector<std::size_t>& found) const {
    for (const std::uint32_t t : mesh_.neighbors[triangle]) {
      if (t != kNone) found.push_back(t);
    }
  }

 private:
  const CanonicalMesh& mesh_;
};

/// CGAL's region type: the plane by least squares through the corners of the region so far.
class InPlane {
 public:
  InPlane(const CanonicalMesh& mesh, double tolerance, const RecoverThresholds& thresholds)
      : mesh_(mesh),
        tolerance_(tolerance),
        sliver_(thresholds.sliver * tolerance),
        same_normal_(thresholds.same_normal) {}

  bool is_part_of_region(std::size_t /*from*/, std::size_t triangle, const std::vector<std::size_t>& /*region*/) const {
    const auto t = static_cast<std::uint32_t>(triangle);
    for (std::size_t i = 0; i < 3; ++i) {
      if (std::abs((mesh_.corner(t, i) - point_).dot(normal_)) > tolerance_) return false;
    }
    return mesh_.heights[t] <= sliver_ || mesh_.normals[t].dot(normal_) >= same_normal_;
  }

  static bool is_valid_region(const std::vector<std::size_t>& /*region*/) { return true; }

  void update(const std::vector<std::size_t>& region) {
    if (region.size() == 1) {  // a seed: the largest triangle of its facet
      const auto seed = static_cast<std::uint32_t>(region[0]);
      origin_ = mesh_.centers[seed];
      seed_normal_ = mesh_.normals[seed];
      sum_.setZero();
      squares_.setZero();
      counted_ = 0;
    }
    for (; counted_ < region.size(); ++counted_) {
      for (std::size_t i = 0; i < 3; ++i) {
        const Vector3d p = mesh_.corner(static_cast<std::uint32_t>(region[counted_]), i) - origin_;
        sum_ += p;
        squares_ += p * p.transpose();
      }
    }
    const double n = 3 * static_cast<double>(counted_);
    point_ = origin_ + sum_ / n;
    const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(squares_ / n - sum_ * sum_.transpose() / (n * n));
    const Vector3d fitted = axes.eigenvectors().col(0);
    const double side = fitted.dot(seed_normal_);
    normal_ = std::abs(side) < same_normal_ ? seed_normal_ : Vector3d(side < 0 ? -fitted : fitted);
  }

 private:
  const CanonicalMesh& mesh_;
  double tolerance_, sliver_;  // m
  double same_normal_;         // cosine
  Vector3d origin_, seed_normal_, point_, normal_, sum_;
  Matrix3d squares_;
  std::size_t counted_ = 0;
};

/// CGAL's seed map: the order in which triangles are tried as seeds.
struct Seeds {
  using key_type = std::size_t;
  using value_type = std::size_t;
  using reference = std::size_t;
  using category = boost::readable_property_map_tag;
  const std::vector<std::size_t>* order;
  friend std::size_t get(const Seeds& seeds, std::size_t i) { return (*seeds.order)[i]; }
};

}  // namespace

std::vector<std::vector<std::uint32_t>> flat_regions(const CanonicalMesh& mesh, double tolerance,
                                                     const RecoverThresholds& thresholds) {
  std::vector<std::size_t> order(mesh.triangles.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return mesh.areas[a] > mesh.areas[b]; });
  std::vector<std::vector<std::uint32_t>> facets;
  if (order.empty()) return facets;
  Beside beside(mesh);
  InPlane in_plane(mesh, tolerance, thresholds);
  CGAL::Shape_detection::Region_growing<std::vector<std::size_t>, Beside, InPlane, Seeds> growing(
      order, beside, in_plane, Seeds{&order});
  std::vector<std::vector<std::size_t>> regions;
  growing.detect(std::back_inserter(regions));
  for (const std::vector<std::size_t>& region : regions) {
    std::vector<std::uint32_t>& facet = facets.emplace_back();
    for (const std::size_t t : region) facet.push_back(static_cast<std::uint32_t>(t));
  }
  return facets;
}

}  // namespace verisim::recover
