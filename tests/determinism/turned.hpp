// Turned parts with their b-rep, made from pinned functions and without a CAD kernel: for the scenes whose bits must
// not depend on anything.
#pragma once

#include <array>
#include <numbers>
#include <vector>

#include "tests/simulation/scenes.hpp"

namespace verisim::determinism {

struct ProfilePoint {
  double radius, z;  ///< m
};

/// Turns a profile about an axis along z through (x, 0, 0). The profile goes once around the material with the material
/// on its left, seen with the radius to the right and z up; what goes along the axis makes no face.
class Turned {
 public:
  Turned(std::vector<ProfilePoint> profile, double x, int facets = 48)
      : profile_(std::move(profile)), x_(x), facets_(facets) {
    for (const ProfilePoint& p : profile_) first_vertex_.push_back(add_ring(p));
    face_.assign(profile_.size(), kNoFace);
    for (std::size_t i = 0; i < profile_.size(); ++i) add_face(i);
    for (std::size_t i = 0; i < profile_.size(); ++i) add_edge(i);
  }

  [[nodiscard]] Part part(std::string name) && {
    std::vector<std::uint32_t> face_of_triangle = mesh_.face_of_triangle;
    Part part = scenes::part_of(std::move(name), std::move(mesh_));
    part.mesh.face_of_triangle = std::move(face_of_triangle);
    part.faces = std::move(faces_);
    part.edges = std::move(edges_);
    part.exact = true;
    return part;
  }

 private:
  static constexpr double kTwoPi = 2 * std::numbers::pi;

  [[nodiscard]] std::size_t next(std::size_t i) const { return (i + 1) % profile_.size(); }
  [[nodiscard]] Vector3d on_axis(double z) const { return {x_, 0, z}; }

  std::uint32_t add_ring(const ProfilePoint& p) {
    const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
    if (p.radius == 0) mesh_.vertices.push_back(on_axis(p.z));
    for (int i = 0; p.radius > 0 && i < facets_; ++i) {
      const auto [c, s] = shapes::on_circle(i, facets_);
      mesh_.vertices.push_back(on_axis(p.z) + p.radius * Vector3d(c, s, 0));
    }
    return first;
  }

  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (a == b || b == c || c == a) return;
    mesh_.triangles.push_back({a, b, c});
    mesh_.face_of_triangle.push_back(static_cast<std::uint32_t>(faces_.size() - 1));
  }

  /// Between the i-th point and the next.
  void add_face(std::size_t i) {
    const ProfilePoint& from = profile_[i];
    const ProfilePoint& to = profile_[next(i)];
    if (from.radius == 0 && to.radius == 0) return;
    face_[i] = static_cast<std::uint32_t>(faces_.size());
    Face& face = faces_.emplace_back();
    face.surface = surface(from, to);
    const auto [low, high] = std::minmax(from.z, to.z);
    face.u_range = {0, kTwoPi};
    face.v_range = std::holds_alternative<Cone>(face.surface) ? std::array{0.0, high - low} : std::array{low, high};
    const auto vertex = [&](std::size_t ring, int k) {
      const bool is_point = profile_[ring].radius == 0;
      return first_vertex_[ring] + (is_point ? 0U : static_cast<std::uint32_t>(k % facets_));
    };
    for (int k = 0; k < facets_; ++k) {
      const std::array<std::uint32_t, 4> q = {vertex(i, k), vertex(i, k + 1), vertex(next(i), k + 1),
                                              vertex(next(i), k)};
      add_triangle(q[0], q[1], q[2]);
      add_triangle(q[0], q[2], q[3]);
    }
  }

  [[nodiscard]] Surface surface(const ProfilePoint& from, const ProfilePoint& to) const {
    const Vector3d z = Vector3d::UnitZ();
    const Vector3d x = Vector3d::UnitX();
    if (from.z == to.z) return Plane{on_axis(from.z), from.radius < to.radius ? Vector3d(-z) : z, x};
    const bool hole = to.z < from.z;
    if (from.radius == to.radius) return Cylinder{on_axis(0), z, x, from.radius, hole};
    const auto& [small, large] = from.radius < to.radius ? std::pair(from, to) : std::pair(to, from);
    const double angle = pinned::atan2(large.radius - small.radius, std::abs(large.z - small.z));
    return Cone{on_axis(small.z), small.z < large.z ? z : Vector3d(-z), x, small.radius, angle, hole};
  }

  /// At the i-th point, between the faces on either side of it.
  void add_edge(std::size_t i) {
    const ProfilePoint& p = profile_[i];
    if (p.radius == 0) return;
    const std::size_t before = (i + profile_.size() - 1) % profile_.size();
    const auto number = static_cast<std::uint32_t>(edges_.size());
    Edge& edge = edges_.emplace_back();
    edge.curve = Circle{on_axis(p.z), Vector3d::UnitZ(), Vector3d::UnitX(), p.radius};
    edge.t_range = {0, kTwoPi};
    edge.length = kTwoPi * p.radius;
    edge.faces = {face_[before], face_[i]};
    for (int k = 0; k <= facets_; ++k)
      edge.polyline.push_back(mesh_.vertices[first_vertex_[i] + static_cast<std::uint32_t>(k % facets_)]);
    for (const std::uint32_t f : edge.faces) faces_[f].edges.push_back(number);
  }

  std::vector<ProfilePoint> profile_;
  double x_;
  int facets_;
  TriangleMesh mesh_;
  std::vector<std::uint32_t> first_vertex_;
  std::vector<std::uint32_t> face_;  ///< from each point to the next; kNoFace: along the axis
  std::vector<Face> faces_;
  std::vector<Edge> edges_;
};

/// Turned bodies, standing upright.
inline Part turned_pin(double radius, double from, double to, double x = 0) {
  return Turned({{0, from}, {radius, from}, {radius, to}, {0, to}}, x).part("pin");
}
inline Part turned_tube(double inner, double outer, double from, double to, double x = 0) {
  return Turned({{inner, from}, {outer, from}, {outer, to}, {inner, to}}, x).part("tube");
}

}  // namespace verisim::determinism
