#include "engine/stability/fits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/base/pinned_math.hpp"
#include "engine/stability/law.hpp"

namespace verisim::stability {
namespace {

constexpr double kGravity = 9.81, kSteel = 7800;

Scene scene_of(const Fit& f) {
  const double r = f.radius, hole = r * (1 + f.clearance), height = 2 * r, length = 3 * r;
  Scene scene;
  SimulationParameters& p = scene.parameters;
  p.all_bodies_are_dynamic = true;
  p.hybrid = hybrid::exact;
  p.integrator = Integrator::implicit;
  p.gravity = {-kGravity, 0, 0};
  BodyDescription block =
      solid_body("block", difference(box_solid({5 * r, 5 * r, height}), cylinder_solid(hole, 2 * height)), 1, r / 8);
  block.fixed = true;
  BodyDescription pin = solid_body("pin", *cylinder_solid(r, length), 1, r / 8);
  pin.density = kSteel;
  pin.twist.angular = {0, 0, f.spin};
  scene.bodies = {std::move(block), std::move(pin)};
  return scene;
}

}  // namespace

Row fit(const std::string& what, const Fit& f) {
  const double clearance = f.radius * f.clearance, half = f.radius;  // half the height of the block
  double overlap = 0, energy = 0, spin = f.spin, low = 1e300, high = -1e300, slides = 0;
  const Said said =
      run([&] { return scene_of(f); }, f.frames,
          [&](Simulation& s) {
            const Pose pose = s.body_pose(1);
            const Twist twist = s.body_twist(1);
            const Vector3d axis = pose.rotation * Vector3d::UnitZ();
            for (const double z : {-half, half}) {  // where the axis passes through the hole's ends
              const Vector3d at = pose.position + (z - pose.position.z()) / axis.z() * axis;
              overlap = std::max(overlap, at.head<2>().norm() - clearance);
            }
            // J/kg, beyond what it fell for; of a spin what is beside the axis.
            const double turning = f.radius * f.radius * twist.angular.head<2>().squaredNorm();
            energy = std::max(energy, 0.5 * (twist.linear.squaredNorm() + turning) + kGravity * pose.position.x());
            spin = twist.angular.z();
            if (s.frame() * 5 < f.frames * 4) return;
            // From the hole's axis: round the hole it may swing, without friction for ever.
            low = std::min(low, pose.position.head<2>().norm());
            high = std::max(high, pose.position.head<2>().norm());
            slides = std::max(slides, s.dt() * twist.linear.norm());
          });
  Row row;
  row.what = what;
  row.theory = "overlaps by less than a spring of steel gives way to its fall; gains no energy; lies still";
  const double spin_error = f.spin > 0 ? spin / f.spin - 1 : 0;
  row.figures = {{"clearance", "m", clearance},
                 {"overlap", "m", overlap},
                 {"overlap_by_clearance", "1", overlap / clearance},
                 {"energy_gained", "g clearance", energy / (kGravity * clearance)},
                 {"spin_error", "1", spin_error},
                 {"moves_at_end", "clearance", (high - low) / clearance}};
  // The spring that exactStiffness makes of the hole's height is pressed by x when the pin has fallen through the
  // clearance c: m g (c + x) = k x^2 / 2, so x = s + sqrt(s^2 + 2 s c) with the sag s = m g / k. A step that takes
  // energy presses it less.
  const double k = SimulationParameters().exact_stiffness * 2 * half;
  const double mass = kSteel * pinned::kPi * f.radius * f.radius * 3 * f.radius;
  const double sag = mass * kGravity / k;
  const double allowed = sag + std::sqrt(sag * sag + 2 * sag * clearance);
  const bool no_energy = energy <= 1e-3 * kGravity * clearance;
  // What lies on a spring that pushes and does not pull swings with less than the sag to either side. What slides on
  // along the wall goes straight within a step, and the wall curves away by way^2 / (2 c).
  const bool rests = high - low <= 2 * sag + slides * slides / (2 * clearance);
  row.figures.push_back({"allowed", "m", allowed});
  conclude(row, said, overlap <= allowed && no_energy && rests && std::abs(spin_error) <= 1e-3,
           overlap <= clearance + f.radius, !rests);
  return row;
}

}  // namespace verisim::stability
