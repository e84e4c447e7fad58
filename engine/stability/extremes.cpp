#include "engine/stability/extremes.hpp"

#include <fmt/format.h>

#include <cmath>

#include "engine/base/pinned_math.hpp"
#include "engine/stability/fits.hpp"
#include "engine/stability/law.hpp"
#include "engine/stability/parts.hpp"
#include "engine/stability/resting.hpp"

namespace verisim::stability {
namespace {

/// Inertia of a box about its principal axes [kg m^2].
Vector3d box_inertia(double mass, const Vector3d& size) {
  const Vector3d squares = size.cwiseAbs2();
  return mass / 12 * (Vector3d::Constant(squares.sum()) - squares);
}

/// A brick that nobody touches flies and turns, about an axis that is none of its own.
Row fly(double rate, std::uint64_t frames) {
  const Vector3d size(0.1, 0.06, 0.02), v(0.3, -0.2, 0.1);
  const double mass = 1;
  const Vector3d inertia = box_inertia(mass, size);
  Vector3d L0 = Vector3d::Zero();
  double E0 = 0, momentum_error = 0, energy_error = 0, off = 0;
  const auto make = [&] {
    Scene scene;
    scene.parameters.all_bodies_are_dynamic = true;
    scene.parameters.hybrid = hybrid::off;
    scene.bodies = {box_body("brick", size, mass, 0.005)};
    scene.bodies[0].twist = {v, rate * Vector3d(1, 2, 3).normalized()};
    return scene;
  };
  {
    const Vector3d omega = rate * Vector3d(1, 2, 3).normalized();
    L0 = inertia.asDiagonal() * omega;
    E0 = 0.5 * L0.dot(omega);
  }
  const Said said = run(make, frames, [&](Simulation& s) {
    const Pose pose = s.body_pose(0);
    const Vector3d omega = s.body_twist(0).angular;
    const Matrix3d R = pose.rotation.toRotationMatrix();
    const Vector3d L = R * inertia.asDiagonal() * R.transpose() * omega;
    momentum_error = std::max(momentum_error, (L - L0).norm() / L0.norm());
    energy_error = std::max(energy_error, std::abs(0.5 * L.dot(omega) / E0 - 1));
    off = (pose.position - s.time() * v).norm() / (s.time() * v.norm());
  });
  Row row;
  row.what = fmt::format("free flight, spin of {:g} rad/s, {} frames", rate, frames);
  row.theory = "momentum and place kept to 1e-9, energy of the spin to 1 %";
  row.figures = {
      {"momentum_error", "1", momentum_error}, {"energy_error", "1", energy_error}, {"place_error", "1", off}};
  conclude(row, said, momentum_error <= 1e-9 && energy_error <= 0.01 && off <= 1e-9, energy_error <= 1, false);
  return row;
}

using Make = std::function<Row(const std::string&)>;

struct List {
  std::vector<Task> tasks;
  void add(const std::string& what, bool is_long, const Make& make) {
    tasks.push_back({"", RowKind::extreme, what, is_long, [=] { return make(what); }});
  }
  void rest(const std::string& what, bool is_long, const Resting& r) {
    add(what, is_long, [r](const std::string& words) { return stability::rest(words, r); });
  }
};

void add_fits(List& list) {
  for (int i = -6; i <= -1; ++i)
    list.add(fmt::format("clearance of 1e{} of the radius, exact", i), false, [i](const std::string& what) {
      Fit f;
      f.clearance = pinned::pow(10.0, i);
      return fit(what, f);
    });
  for (const double spin : {1e2, 1e4})
    list.add(fmt::format("pin that spins with {:g} rad/s in its hole, exact", spin), false,
             [spin](const std::string& what) {
               Fit f;
               f.spin = spin;
               return fit(what, f);
             });
}

void add_resting(List& list, Hybrid hybrid) {
  Resting usual;
  usual.hybrid = hybrid;
  const std::string name(hybrid->name());
  const auto named = [&](const std::string& what) { return what + ", " + name; };
  for (int i = -6; i <= 3; ++i) {
    Resting r = usual;
    r.size = pinned::pow(10.0, i);
    list.rest(named(fmt::format("box of 1e{} m on a plate", i)), i % 3 != 0, r);
  }
  for (int i = -9; i <= 9; i += 3) {
    Resting r = usual;
    r.mass = pinned::pow(10.0, i);
    list.rest(named(fmt::format("box of 1e{} kg on a plate", i)), i % 9 != 0, r);
  }
  for (const double offset : {1e3, 1e6}) {
    Resting r = usual;
    r.offset = {offset, -offset, offset};
    list.rest(named(fmt::format("box on a plate {:g} m from the origin", offset)), offset < 1e6, r);
  }
  for (const double depth : {0.1, 0.5, 1.0}) {
    Resting r = usual;
    r.depth = depth;
    r.gravity = 0;
    list.rest(named(fmt::format("box that begins with {:g} of its edge inside of a plate, no gravity", depth)),
              depth != 0.5, r);
  }
  for (const double ratio : {1.0, 1e3, 1e-3}) {
    Resting r = usual;
    r.boxes = 3;
    r.mass_ratio = ratio;
    list.rest(named(fmt::format("tower of 3 flush boxes, each {:g} times the one below", ratio)), ratio < 1, r);
  }
  Resting lasting = usual;
  for (const std::uint64_t frames : {100000U, 1000000U}) {
    lasting.frames = frames;
    list.rest(named(fmt::format("box on a plate for {} frames", frames)), frames > 100000, lasting);
  }
}

}  // namespace

std::vector<Task> extreme_tasks() {
  List list;
  add_fits(list);
  for (const Hybrid hybrid : {hybrid::exact, hybrid::restore, hybrid::off}) add_resting(list, hybrid);
  for (const Hybrid hybrid : {hybrid::exact, hybrid::off})
    list.add(fmt::format("two free boxes in one place, {}", hybrid->name()), false,
             [hybrid](const std::string&) { return coincide(hybrid); });
  list.add("10^4 contacts at once", false, [](const std::string&) { return many_contacts(100, 300); });
  list.add("10^5 contacts at once", true, [](const std::string&) { return many_contacts(317, 300); });
  for (const double rate : {1e2, 1e3, 1e4})
    list.add(fmt::format("spin of {:g} rad/s", rate), false, [rate](const std::string&) { return fly(rate, 10000); });
  list.add("free flight of a million frames", true, [](const std::string&) { return fly(10, 1000000); });
  return std::move(list.tasks);
}

}  // namespace verisim::stability
