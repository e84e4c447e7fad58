#include "bench/peers/insertion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/base/pinned_math.hpp"

namespace verisim::peers {
namespace {

Vector3d sector_normal(int i) {
  const double angle = 2 * pinned::kPi * (i + 0.5) / kWedges;
  return {std::cos(angle), std::sin(angle), 0};
}

/// Shortest distance between the line through `p` along the unit vector `a` and the segment from s to t.
double line_to_segment(const Vector3d& p, const Vector3d& a, const Vector3d& s, const Vector3d& t) {
  const auto off_line = [&](const Vector3d& q) { return Vector3d(q - p - a.dot(q - p) * a); };
  const Vector3d from = off_line(s);
  const Vector3d way = off_line(t) - from;
  const double fraction = way.squaredNorm() > 0 ? std::clamp(-from.dot(way) / way.squaredNorm(), 0.0, 1.0) : 0.0;
  return (from + fraction * way).norm();
}

}  // namespace

std::vector<Vector3d> wedge(int sector, const Cut& cut) {
  const double half = kBlockHeight / 2 - cut.drawn_in, hole = kHoleRadius + cut.drawn_in;
  const double corner = 1 / std::cos(pinned::kPi / cut.wedges);
  // The cone's line keeps its distance from where it was: it meets the others a little elsewhere.
  const double shift = (std::sqrt(2.0) - 1) * cut.drawn_in;
  std::vector<Vector3d> vertices;
  for (const int k : {sector, sector + 1}) {
    const double angle = 2 * pinned::kPi * k / cut.wedges;
    const Vector3d d(std::cos(angle), std::sin(angle), 0), z = Vector3d::UnitZ();
    const Vector3d outer = (kBlockHalf - cut.drawn_in) / d.cwiseAbs().maxCoeff() * d;
    vertices.push_back(hole * corner * d - half * z);
    if (cut.chamfer > 0) {
      vertices.push_back(hole * corner * d + (kBlockHeight / 2 - cut.chamfer - shift) * z);
      vertices.push_back((kHoleRadius + cut.chamfer + shift) * corner * d + half * z);
    } else {
      vertices.push_back(hole * corner * d + half * z);
    }
    vertices.push_back(outer + half * z);
    vertices.push_back(outer - half * z);
  }
  return vertices;
}

double depth_in_circle(const Pose& X, double radius, double chamfer) {
  constexpr int kAngles = 720;
  const Matrix3d R = X.rotation.toRotationMatrix();
  const double top = kBlockHeight / 2 - chamfer;
  double deepest = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < kAngles; ++i) {
    const double angle = 2 * pinned::kPi * i / kAngles;
    const Vector3d ring(std::cos(angle), std::sin(angle), 0);
    for (const double end : {-0.5, 0.5}) {
      const Vector3d p = X.position + R * (radius * ring + Vector3d(0, 0, end * kPinLength));
      if (p.z() >= -kBlockHeight / 2 && p.z() <= top) deepest = std::max(deepest, p.head<2>().norm() - kHoleRadius);
    }
    for (const double z : {-kBlockHeight / 2, top}) {
      const Vector3d q = kHoleRadius * ring + Vector3d(0, 0, z) - X.position;
      const double along = R.col(2).dot(q);
      if (std::abs(along) <= kPinLength / 2) deepest = std::max(deepest, radius - (q - along * R.col(2)).norm());
    }
  }
  return deepest;
}

double overlap_with_circle(const Pose& X, double radius, double chamfer) {
  return std::max(0.0, depth_in_circle(X, radius, chamfer));
}

double overlap_with_polygon(const Pose& X, double radius, double chamfer) {
  const Vector3d a = X.rotation * Vector3d::UnitZ();
  const double corner = kHoleRadius / std::cos(pinned::kPi / kWedges);
  double deepest = 0;
  for (int i = 0; i < kWedges; ++i) {
    const Vector3d n = sector_normal(i);
    const Vector3d across = n - n.dot(a) * a;
    for (const double end : {-0.5, 0.5}) {
      const Vector3d p = X.position + end * kPinLength * a + radius * across.normalized();
      if (p.z() < kBlockHeight / 2 - chamfer && p.z() > -kBlockHeight / 2)
        deepest = std::max(deepest, n.dot(p) - kHoleRadius);
    }
    for (const double z : {-kBlockHeight / 2, kBlockHeight / 2 - chamfer}) {
      const double from = 2 * pinned::kPi * i / kWedges, to = 2 * pinned::kPi * (i + 1) / kWedges;
      const Vector3d s(corner * std::cos(from), corner * std::sin(from), z);
      const Vector3d t(corner * std::cos(to), corner * std::sin(to), z);
      if (std::abs(a.dot(0.5 * (s + t) - X.position)) < kPinLength / 2)
        deepest = std::max(deepest, radius - line_to_segment(X.position, a, s, t));
    }
  }
  return deepest;
}

namespace {

/// A band of quadrilaterals between two rings of vertices, [a, a + n) and [b, b + n).
void add_band(Mesh& mesh, int a, int b, int n) {
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    mesh.triangles.push_back({a + i, a + j, b + i});
    mesh.triangles.push_back({a + j, b + j, b + i});
  }
}

void add_ring(Mesh& mesh, double radius, double z, int sides) {
  for (int i = 0; i < sides; ++i) {
    const double angle = 2 * pinned::kPi * i / sides;
    mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
}

/// The outer square, in as many points as the hole has.
void add_square(Mesh& mesh, double z, int sides) {
  for (int i = 0; i < sides; ++i) {
    const double angle = 2 * pinned::kPi * i / sides;
    const Vector3d d(std::cos(angle), std::sin(angle), 0);
    mesh.vertices.push_back(kBlockHalf / d.cwiseAbs().maxCoeff() * d + Vector3d(0, 0, z));
  }
}

}  // namespace

Mesh block_mesh(double chamfer, int sides) {
  const double corner = 1 / std::cos(pinned::kPi / sides), half = kBlockHeight / 2;
  Mesh mesh;
  add_square(mesh, half, sides);
  if (chamfer > 0) add_ring(mesh, (kHoleRadius + chamfer) * corner, half, sides);
  add_ring(mesh, kHoleRadius * corner, half - chamfer, sides);
  add_ring(mesh, kHoleRadius * corner, -half, sides);
  add_square(mesh, -half, sides);
  const int rings = static_cast<int>(mesh.vertices.size()) / sides;
  for (int i = 0; i < rings; ++i) add_band(mesh, ((i + 1) % rings) * sides, i * sides, sides);
  return mesh;
}

Vector3d force_at_rest(const Insertion& task) {
  constexpr double kStiffness = 5000, kAngular = 50;
  const Hand hand = hand_at(task, exact::test::steps_of(task) * kStep);
  const Vector3d axis = hand.rotation * Vector3d::UnitZ();
  const Vector3d beside = Vector3d(axis.x(), axis.y(), 0).normalized();  // the plane: beside and z
  const double tilt_hand = std::atan2(axis.dot(beside), axis.z()), radius = kHoleRadius - task.clearance;
  const double x = hand.position.dot(beside), z = hand.position.z();
  const double top = kBlockHeight / 2 - task.chamfer, bottom = kBlockHeight / 2;
  const auto room = [&](double a, double height) { return kHoleRadius * std::cos(a) - height * std::sin(a) - radius; };
  const auto pushed = [&](double a) {  // how far the bounds push the pin along n
    const double w = std::cos(a) * x - std::sin(a) * z;
    return std::clamp(w, -room(a, bottom), room(a, top)) - w;
  };
  const auto energy = [&](double a) {
    const double off = pushed(a), turned = tilt_hand - a;
    return 0.5 * kStiffness * off * off + 0.5 * kAngular * turned * turned;
  };
  // The largest tilt that the hole has room for, by bisection: room on both sides together shrinks as it grows.
  double low = 0, high = tilt_hand;
  const auto fits = [&](double a) { return room(a, top) + room(a, bottom) >= 0; };
  for (int i = 0; i < 100 && !fits(tilt_hand); ++i) (fits(0.5 * (low + high)) ? low : high) = 0.5 * (low + high);
  high = fits(tilt_hand) ? tilt_hand : low;
  low = 0;
  for (int i = 0; i < 200; ++i) {  // golden section: the energy has one minimum there
    const double part = 0.3819660112501051 * (high - low);
    if (energy(low + part) < energy(high - part))
      high -= part;
    else
      low += part;
  }
  const double a = 0.5 * (low + high);
  return kStiffness * pushed(a) * (std::cos(a) * beside - std::sin(a) * Vector3d::UnitZ());
}

Vector3d Coupling::inertia() const {
  return exact::test::HeldPin::inertia(radius);
}

Wrench Coupling::pull(const Hand& hand, const Motion& m) const {
  const auto limited = [](const Vector3d& w, double most) {
    return Vector3d(w.norm() > most ? w * (most / w.norm()) : w);
  };
  const Matrix3d R = m.X_WB.rotation.toRotationMatrix();
  const Matrix3d B = R * Matrix3d((2 * (50 * inertia()).cwiseSqrt()).asDiagonal()) * R.transpose();
  const Vector3d force = 5000 * (hand.position - m.X_WB.position) + 2 * std::sqrt(5000.0) * (hand.velocity - m.v);
  const Vector3d torque = 50 * vector_from_rotation(hand.rotation * m.X_WB.rotation.conjugate()) - B * m.omega;
  return {limited(force, 100), limited(torque, 5)};
}

}  // namespace verisim::peers
