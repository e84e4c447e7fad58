// Random drops and presses: a body of some kind falls, or is pressed by a hand, onto a seat of some kind. Metres.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "engine/base/pinned_math.hpp"
#include "engine/base/random.hpp"
#include "engine/device/sources.hpp"
#include "engine/geometry/loader.hpp"
#include "engine/simulation/simulation.hpp"

namespace verisim::drops {

using SolidPtr = std::shared_ptr<const Solid>;

inline SolidPtr make(Solid::Kind kind, std::vector<double> sizes, std::vector<SolidPtr> children = {}, Pose X = {}) {
  return std::make_shared<Solid>(Solid{kind, std::move(sizes), std::move(children), X});
}
inline SolidPtr box(double x, double y, double z) {
  return make(Solid::Kind::box, {x, y, z});
}
inline SolidPtr cylinder(double radius, double height) {
  return make(Solid::Kind::cylinder, {radius, height});
}
inline SolidPtr cone(double below, double above, double height) {
  return make(Solid::Kind::cone, {below, above, height});
}
inline SolidPtr ball(double radius) {
  return make(Solid::Kind::sphere, {radius});
}
inline SolidPtr torus(double ring_radius, double radius) {
  return make(Solid::Kind::torus, {ring_radius, radius});
}
inline SolidPtr operator+(const SolidPtr& a, const SolidPtr& b) {
  return make(Solid::Kind::sum, {}, {a, b});
}
inline SolidPtr operator-(const SolidPtr& a, const SolidPtr& b) {
  return make(Solid::Kind::difference, {}, {a, b});
}
inline SolidPtr operator*(const SolidPtr& a, const SolidPtr& b) {
  return make(Solid::Kind::intersection, {}, {a, b});
}
inline const Vector3d kHere = Vector3d::Zero();  // {} would be any numbers
inline SolidPtr moved(const SolidPtr& a, const Vector3d& by, const Vector3d& turn = Vector3d::Zero()) {
  return make(Solid::Kind::placed, {}, {a}, {by, rotation_from_vector(turn)});
}

/// A regular prism of n sides that lie `inner` from its axis.
inline SolidPtr prism(int n, double inner, double height) {
  SolidPtr all;
  for (int i = 0; i < n; ++i) {
    const SolidPtr half =
        moved(moved(box(0.08, 0.08, height), {inner - 0.04, 0, 0}), kHere, {0, 0, pinned::kFullTurn * i / n});
    all = all ? all * half : half;
  }
  return all;
}

struct Kind {
  std::string name;
  SolidPtr solid;
};

inline std::vector<Kind> body_kinds() {
  return {{"ball", ball(0.01)},
          {"pin", cylinder(0.008, 0.03)},
          {"disc", cylinder(0.015, 0.006)},
          {"tube", make(Solid::Kind::tube, {0.01, 0.006, 0.02})},
          {"cone", cone(0.0, 0.01, 0.02)},
          {"frustum", cone(0.006, 0.01, 0.016)},
          {"box", box(0.03, 0.02, 0.014)},
          {"prism3", prism(3, 0.006, 0.02)},
          {"prism5", prism(5, 0.008, 0.02)},
          {"prism6", prism(6, 0.008, 0.02)},
          {"prism8", prism(8, 0.008, 0.02)},
          {"chamfered", cylinder(0.008, 0.02) + moved(cone(0.006, 0.008, 0.002), {0, 0, -0.011})},
          {"stepped", cylinder(0.006, 0.03) + moved(cylinder(0.01, 0.012), {0, 0, 0.009})},
          {"keyed", cylinder(0.008, 0.02) + moved(box(0.006, 0.004, 0.02), {0.008, 0, 0})},
          {"ring", torus(0.01, 0.004)},
          {"filleted", moved(cylinder(0.008, 0.018), {0, 0, 0.001}) + cylinder(0.006, 0.02) +
                           moved(torus(0.006, 0.002), {0, 0, -0.008})}};
}

/// Thinner than a voxel, or hardly thicker.
inline std::vector<Kind> thin_kinds() {
  return {{"coin", cylinder(0.015, 0.00075)}, {"disc2", cylinder(0.015, 0.00225)},
          {"plate", box(0.03, 0.02, 0.0008)}, {"washer", make(Solid::Kind::tube, {0.014, 0.006, 0.001})},
          {"tile", prism(5, 0.012, 0.001)},   {"needle", cylinder(0.0006, 0.03)},
          {"blade", box(0.03, 0.003, 0.0005)}};
}

/// With inner corners, at which edges end without a corner of the body, and with tips.
inline std::vector<Kind> cornered_kinds() {
  return {
      {"cross", box(0.03, 0.008, 0.008) + box(0.008, 0.03, 0.008)},
      {"ell", moved(box(0.03, 0.008, 0.01), {0, -0.008, 0}) + moved(box(0.008, 0.024, 0.01), {-0.011, 0, 0})},
      {"bicone", moved(cone(0, 0.012, 0.01), {0, 0, -0.005}) + moved(cone(0.012, 0, 0.01), {0, 0, 0.005})},
      {"hourglass", moved(cone(0.012, 0.005, 0.01), {0, 0, -0.005}) + moved(cone(0.005, 0.012, 0.01), {0, 0, 0.005})}};
}

/// Their upper faces, or highest points, at z = 0.
inline std::vector<Kind> seat_kinds() {
  const double eighth = pinned::kFullTurn / 8, quarter = 2 * eighth;
  const SolidPtr block = moved(box(0.12, 0.12, 0.04), {0, 0, -0.02});
  const SolidPtr low = moved(box(0.12, 0.12, 0.02), {0, 0, -0.03});
  return {{"plane", block},
          {"hole", block - cylinder(0.0085, 0.1)},
          {"wide_hole", block - cylinder(0.02, 0.1)},
          {"pit", block - moved(box(0.04, 0.04, 0.03), {0, 0, 0.005})},
          {"bowl", block - moved(ball(0.03), {0, 0, 0.01})},
          {"funnel", block - moved(cone(0.006, 0.036, 0.03), {0, 0, -0.015})},
          {"groove", block - moved(box(0.03, 0.2, 0.03), kHere, {0, eighth, 0})},
          {"slot", block - moved(box(0.022, 0.2, 0.03), {0, 0, 0.005})},
          {"trough", block - moved(cylinder(0.02, 0.2), {0, 0, 0.005}, {quarter, 0, 0})},
          {"post", low + moved(cylinder(0.006, 0.03), {0, 0, -0.015})},
          {"square_post", low + moved(box(0.012, 0.012, 0.03), {0, 0, -0.015})},
          {"ridge", low + moved(box(0.02, 0.1, 0.02), {0, 0, -0.02 * std::sqrt(0.5)}, {0, eighth, 0})},
          {"spike", low + moved(cone(0.02, 0.002, 0.03), {0, 0, -0.015})},
          {"step", low + moved(box(0.06, 0.12, 0.02), {-0.03, 0, -0.01})},
          {"ring_groove", block - torus(0.02, 0.006)},
          {"corner",
           low + moved(box(0.02, 0.12, 0.02), {-0.02, 0, -0.01}) + moved(box(0.12, 0.02, 0.02), {0, -0.02, -0.01})}};
}

/// Holes with corners of 60 and 40 degrees.
inline std::vector<Kind> sharp_seats() {
  const SolidPtr block = moved(box(0.12, 0.12, 0.04), {0, 0, -0.02});
  const SolidPtr slit = box(0.08, 0.014, 0.1);
  return {{"triangle", block - prism(3, 0.006, 0.1)},
          {"small_tri", block - prism(3, 0.003, 0.1)},
          {"rhombus", block - slit * moved(slit, kHere, {0, 0, pinned::kFullTurn / 9})}};
}

/// With ribs, pits, slots and holes of 1.5 to 4 mm, that a voxel may be wider than.
inline std::vector<Kind> small_seats() {
  const SolidPtr block = moved(box(0.04, 0.04, 0.01), {0, 0, -0.005});
  const SolidPtr d_hole = cylinder(0.002, 0.03) - moved(box(0.004, 0.004, 0.03), {0.0035, 0, 0});
  const SolidPtr key = cylinder(0.0015, 0.03) + moved(box(0.0012, 0.001, 0.03), {0.0017, 0, 0});
  return {{"rib", block + box(0.002, 0.01, 0.0006)},
          {"high_rib", block + box(0.0015, 0.008, 0.006)},
          {"small_pit", block - box(0.0023, 0.002, 0.0026)},
          {"long_pit", block - box(0.004, 0.0015, 0.004)},
          {"thin_slot", block - box(0.0015, 0.08, 0.006)},
          {"d_hole", block - d_hole},
          {"key_hole", block - key},
          {"small_hex", block - prism(6, 0.0015, 0.03)},
          {"small_groove", block - moved(cylinder(0.0015, 0.08), kHere, {pinned::kFullTurn / 4, 0, 0})},
          {"two_ribs",
           block + moved(box(0.0015, 0.01, 0.003), {-0.0016, 0, 0}) + moved(box(0.0015, 0.01, 0.003), {0.0016, 0, 0})},
          {"stud", block + cylinder(0.001, 0.004)}};
}

/// Of half the size or less.
inline std::vector<Kind> small_bodies() {
  return {
      {"small_ball", ball(0.004)},
      {"small_pin", cylinder(0.0012, 0.008)},
      {"small_disc", cylinder(0.0045, 0.001)},
      {"small_box", box(0.006, 0.0058, 0.0044)},
      {"small_plate", box(0.01, 0.006, 0.001)},
      {"small_prism3", prism(3, 0.002, 0.006)},
      {"small_prism6", prism(6, 0.0025, 0.006)},
      {"capsule", cylinder(0.0015, 0.006) + moved(ball(0.0015), {0, 0, 0.003}) + moved(ball(0.0015), {0, 0, -0.003})},
      {"small_cone", cone(0.0, 0.003, 0.006)},
      {"small_ring", torus(0.004, 0.001)},
      {"small_keyed", cylinder(0.0013, 0.006) + moved(box(0.001, 0.0008, 0.006), {0.0015, 0, 0})}};
}

/// Balls and tori of which a part is cut away.
inline std::vector<Kind> cut_rounds() {
  const SolidPtr lower = moved(box(0.02, 0.02, 0.02), {0, 0, -0.01});
  return {{"half_ball", ball(0.0035) - lower},
          {"ball_cap", ball(0.004) - moved(lower, {0, 0, 0.0025})},
          {"ball_bored", ball(0.0035) - cylinder(0.002, 0.02)},
          {"half_torus", torus(0.0025, 0.001) - moved(box(0.02, 0.02, 0.02), {0.01, 0, 0})},
          {"torus_top", torus(0.0025, 0.001) - moved(lower, {0, 0, 0.0003})}};
}

/// With rims and thin walls beside which they come down.
inline std::vector<Kind> rims() {
  return {{"wide_cone", moved(cone(0.012, 0.002, 0.005), {0, 0, -0.0025})},
          {"disc", moved(cylinder(0.009, 0.002), {0, 0, -0.001})},
          {"sheet", moved(box(0.018, 0.018, 0.0008), {0, 0, -0.0004})},
          {"cup", moved(make(Solid::Kind::tube, {0.009, 0.008, 0.006}), {0, 0, -0.003})},
          {"shallow_bowl", moved(cylinder(0.01, 0.004), {0, 0, -0.002}) - moved(ball(0.02), {0, 0, 0.0185})}};
}

/// A kind with its part, loaded once.
struct Loaded {
  std::string name;
  Part part;
};
inline std::vector<Loaded> loaded(const std::vector<Kind>& kinds) {
  std::vector<Loaded> all;
  for (const Kind& kind : kinds) {
    all.push_back({kind.name, load_solid(*kind.solid, {})});
    all.back().part.solid = kind.solid->text();
  }
  return all;
}

struct DropScene {
  Scene scene;  ///< body 0: the seat; body 1: what falls
  bool pressed = false;
};

/// Where a body begins above the seat, and what it is made of.
struct DropRange {
  double dt = 0.001;                       ///< s
  double aside = 0.01;                     ///< m, of the seat's axis, at most
  double low = 0.021, high = 0.026;        ///< m, above the seat
  double voxel = 0.002, coarsest = 0.002;  ///< m, between these
};

/// Of even seeds the body falls, at up to 1 m/s when it begins; of odd ones a hand presses it down, held any way up.
inline DropScene drop(const Loaded& body, const Loaded& seat, std::uint64_t seed, const DropRange& range = {}) {
  const RandomStream random(seed, "drop");
  const auto between = [&](std::uint64_t k, double low, double high) { return low + (high - low) * random.uniform(k); };
  DropScene result;
  result.pressed = seed % 2 == 1;
  Scene& scene = result.scene;
  scene.parameters.hybrid = hybrid::exact;
  scene.parameters.integrator = Integrator::implicit;
  scene.parameters.timestep = range.dt;
  scene.parameters.all_bodies_are_dynamic = true;
  scene.parameters.gravity = {0, 0, -9.81};
  scene.parameters.max_stiffness = 1000;
  scene.parameters.max_angular_stiffness = 1;
  BodyDescription below, above;
  below.name = "seat";
  below.fixed = true;
  below.parts = {seat.part};
  above.name = "body";
  above.density = 2000;
  above.parts = {body.part};
  below.voxel_size = above.voxel_size = between(14, range.voxel, range.coarsest);
  above.X_WB.position = {between(0, -range.aside, range.aside), between(1, -range.aside, range.aside),
                         between(2, range.low, range.high)};
  const Vector3d turn(between(3, -1, 1), between(4, -1, 1), between(5, -1, 1));
  above.X_WB.rotation = rotation_from_vector(3 * turn);
  if (!result.pressed) {
    above.twist.linear = {between(6, -0.1, 0.1), between(7, -0.1, 0.1), between(8, -0.9, 0)};
    above.twist.angular = {between(9, -5, 5), between(10, -5, 5), between(11, -5, 5)};
  } else {
    HandDescription hand;
    hand.name = "hand";
    Pose target = above.X_WB;
    hand.path.push_back({target, 0.2, 0.01});
    target.position.z() = between(12, -0.02, 0);
    hand.path.push_back({target, between(13, 0.1, 0.5), 1});
    scene.devices = {make_hand(hand)};
    scene.grasps = {{0, 1}};
  }
  scene.bodies = {std::move(below), std::move(above)};
  return result;
}

}  // namespace verisim::drops
