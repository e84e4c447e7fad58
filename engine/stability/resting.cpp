#include "engine/stability/resting.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/pinned_math.hpp"
#include "engine/stability/law.hpp"
#include "engine/stability/parts.hpp"

namespace verisim::stability {
namespace {

constexpr double kVoxels = 20;  // along an edge

BodyDescription box_of(const Resting& r, const std::string& name, const Vector3d& size, double mass) {
  const double voxel = r.size / kVoxels;
  return r.hybrid == hybrid::off ? box_body(name, size, mass, voxel) : solid_body(name, *box_solid(size), mass, voxel);
}

double mass_of(const Resting& r, int i) {
  return r.mass * pinned::pow(r.mass_ratio, i);
}

Scene scene_of(const Resting& r) {
  Scene scene;
  SimulationParameters& p = scene.parameters;
  p.timestep = r.step;
  p.all_bodies_are_dynamic = true;
  p.hybrid = r.hybrid;
  p.integrator = r.hybrid == hybrid::exact ? Integrator::implicit : Integrator::semi_implicit;
  p.gravity = {0, 0, -r.gravity};
  p.contact_stiffness = r.contact_stiffness;
  p.exact_stiffness = r.exact_stiffness;
  const double s = r.size;
  BodyDescription plate = box_of(r, "plate", {3 * s, 3 * s, s}, 1);
  plate.fixed = true;
  plate.X_WB.position = r.offset - Vector3d(0, 0, s / 2);
  scene.bodies.push_back(std::move(plate));
  for (int i = 0; i < r.boxes; ++i) {
    BodyDescription box = box_of(r, fmt::format("box{}", i), Vector3d::Constant(s), mass_of(r, i));
    box.X_WB.position = r.offset + Vector3d(0, 0, s * (0.5 + i - r.depth));
    scene.bodies.push_back(std::move(box));
  }
  return scene;
}

/// What poses and velocities say of box i, in edges and in m g edge.
class Watched {
 public:
  Watched(const Resting& r, int i) : r_(r), i_(i), rest_(r.offset + Vector3d(0, 0, r.size * (0.5 + i - r.depth))) {}

  void look(Simulation& simulation) {
    const std::size_t body = static_cast<std::size_t>(i_) + 1;
    const Pose pose = simulation.body_pose(body);
    const Twist twist = simulation.body_twist(body);
    const double m = mass_of(r_, i_), s = r_.size;
    const Vector3d moved = (pose.position - rest_) / s;
    double lowest = 1e300;
    for (int c = 0; c < 8; ++c)
      lowest = std::min(
          lowest,
          (pose.rotation * (0.5 * s * Vector3d((c & 1) != 0 ? 1 : -1, (c & 2) != 0 ? 1 : -1, (c & 4) != 0 ? 1 : -1)))
              .z());
    deeper = std::max(deeper, -(moved.z() + lowest / s + 0.5));
    aside = std::max(aside, moved.head<2>().norm());
    const double kinetic =
        0.5 * m * (twist.linear.squaredNorm() + s * s / 6 * twist.angular.squaredNorm());  // of a cube
    const double g = r_.gravity > 0 ? r_.gravity : 9.81;
    energy = std::max(energy, kinetic / (m * g * s) + (r_.gravity > 0 ? moved.z() : 0));
    height_now = moved.z();
    if (simulation.frame() * 5 < r_.frames * 4) return;
    low = std::min(low, moved.z());
    high = std::max(high, moved.z());
  }
  double deeper = 0, aside = 0, energy = 0, low = 1e300, high = -1e300, height_now = 0;

 private:
  const Resting& r_;
  int i_;
  Vector3d rest_;
};

/// How far the springs of exact contact are pressed at rest [edge]: k = exactStiffness times the length of the lowest
/// box's four lower edges; all of the weight is on them.
double sag_of(const Resting& r) {
  double weight = 0;
  for (int i = 0; i < r.boxes; ++i) weight += r.gravity * mass_of(r, i);
  return weight / (r.exact_stiffness * 4 * r.size) / r.size;
}

/// m: two surfaces that rest on each other overlap by less, roundings included (SearchThresholds::coincident).
constexpr double kFlush = 1e-7;

/// How much deeper than it began a corner may come [edge].
/// Exact: a mass that is put on a spring k at once goes 2 m g / k deep, for m g x = k x^2 / 2; of a tower each box adds
/// as much at most. But surfaces are known to each other to the depth of a voxel: what is deeper falls.
/// Voxels: each of the two surfaces is known to a voxel.
double depth_allowed(const Resting& r, double sag) {
  if (r.hybrid != hybrid::exact) return 2 / kVoxels;
  return std::min(1 / kVoxels, 2 * r.boxes * sag + kFlush / r.size);
}

}  // namespace

Row rest(const std::string& what, const Resting& r) {
  std::vector<Watched> boxes;
  for (int i = 0; i < r.boxes; ++i) boxes.emplace_back(r, i);
  const Said said = run([&] { return scene_of(r); }, r.frames,
                        [&](Simulation& s) {
                          for (Watched& box : boxes) box.look(s);
                        });
  double deeper = 0, aside = 0, energy = 0, restless = 0, away = 0;
  for (const Watched& box : boxes) {
    deeper = std::max(deeper, box.deeper);
    aside = std::max(aside, box.aside);
    energy = std::max(energy, box.energy);
    restless = std::max(restless, box.high - box.low);
    away = std::max(away, std::abs(box.height_now));
  }
  const bool is_exact = r.hybrid == hybrid::exact;
  const double sag = sag_of(r), allowed = depth_allowed(r, sag);
  Row row;
  row.what = what;
  row.theory = fmt::format("at rest: sinks by less than {:.2g} edges, not aside, gains no energy", allowed);
  row.figures = {{"sinks", "edge", deeper},
                 {"aside", "edge", aside},
                 {"energy_gained", "m g edge", energy},
                 {"moves_at_end", "edge", restless},
                 {"frames", "1", static_cast<double>(r.frames)}};
  // What stands swings about its rest with less than its springs are pressed, for they push and do not pull; where
  // that is less than roundings, with less than these.
  const double still = is_exact ? std::min(1e-3, 2 * sag) + kFlush / r.size : 1e-3 / kVoxels;
  // Without weight nothing holds it where it is; how fast it goes its energy says.
  const bool moves = r.gravity > 0 && restless > still;
  const bool laws = deeper <= allowed && aside <= 1e-3 && energy <= 1e-3 && !moves;
  conclude(row, said, laws, energy <= 1 && away <= 1 && aside <= 1, moves);
  return row;
}

Row coincide(Hybrid hybrid) {
  Resting r;
  r.hybrid = hybrid;
  Vector3d momentum = Vector3d::Zero();
  double energy = 0, fastest = 0;
  const auto make = [&] {
    r.boxes = 2;
    Scene scene = scene_of(r);
    scene.parameters.gravity.setZero();
    scene.bodies[0].X_WB.position.z() = -1;
    for (std::size_t i : {1U, 2U}) scene.bodies[i].X_WB = {};
    return scene;
  };
  const Said said = run(make, r.frames, [&](Simulation& s) {
    momentum.setZero();
    double kinetic = 0;
    for (std::size_t i : {1U, 2U}) {
      const Twist twist = s.body_twist(i);
      momentum += r.mass * twist.linear;
      kinetic += 0.5 * r.mass * (twist.linear.squaredNorm() + r.size * r.size / 6 * twist.angular.squaredNorm());
      fastest = std::max(fastest, twist.linear.norm());
    }
    energy = std::max(energy, kinetic);
  });
  Row row;
  row.what = fmt::format("two free boxes in one place, {}", hybrid->name());
  row.theory = "momentum stays 0; no energy, or an event that tells of it";
  row.figures = {{"momentum", "kg m/s", momentum.norm()}, {"energy", "J", energy}, {"fastest", "m/s", fastest}};
  const bool kept = momentum.norm() <= 1e-9 * std::max(1e-3, r.mass * fastest);
  conclude(row, said, kept && energy <= 1e-6, energy <= 1, false);
  return row;
}

Row many_contacts(int across, std::uint64_t frames) {
  constexpr double kCell = 1e-3, kThick = 6 * kCell;
  const double side = across * kCell, mass = 1, g = 9.81;
  double force = 0, height = 0, contacts = 0;
  const auto make = [&] {
    Scene scene;
    scene.parameters.all_bodies_are_dynamic = true;
    scene.parameters.hybrid = hybrid::off;
    scene.parameters.gravity = {0, 0, -g};
    scene.bodies = {box_body("plate", {side + 20 * kCell, side + 20 * kCell, kThick}, 1, kCell),
                    box_body("box", {side, side, kThick}, mass, kCell)};
    scene.bodies[0].fixed = true;
    scene.bodies[0].X_WB.position.z() = -kThick / 2;
    scene.bodies[1].X_WB.position.z() = kThick / 2 - 0.2 * kCell;
    return scene;
  };
  double impulse = 0;
  const Said said = run(make, frames, [&](Simulation& s) {
    force = s.body_force(1).force.z();
    impulse += force * s.dt();
    contacts = static_cast<double>(s.body_contacts(1));
    height = s.body_pose(1).position.z();
    if (s.frame() == frames) impulse -= mass * (s.body_twist(1).linear.z() + g * s.time());
  });
  Row row;
  row.what = fmt::format("{} contacts at once, voxels", contacts);
  row.theory = "what they push is the change of momentum; at rest the weight";
  const double force_error = force / (mass * g) - 1,
               impulse_error = impulse / (mass * g * 1e-3 * static_cast<double>(frames));
  row.figures = {{"contacts", "1", contacts},
                 {"force_error", "1", force_error},
                 {"impulse_error", "1", impulse_error},
                 {"sinks", "voxel", (kThick / 2 - height) / kCell}};
  const bool laws =
      std::abs(force_error) <= 1e-3 && std::abs(impulse_error) <= 1e-6 && std::abs(height - kThick / 2) <= kCell;
  conclude(row, said, laws, std::abs(height - kThick / 2) <= kCell, std::abs(force_error) > 1e-3);
  return row;
}

}  // namespace verisim::stability
