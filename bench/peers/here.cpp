// This project's methods: the whole frame of a simulation whose handle is the hand, as a scenario of it would run, and
// what finds contacts alone. The damper of its coupling is on the difference of the angular velocities, where that of
// the reference is on the pin's alone: they differ in the half second in which an engaged hand begins to lean.
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "bench/peers/peer.hpp"
#include "engine/contact/query.hpp"
#include "engine/device/sources.hpp"
#include "engine/exact/exact_link.hpp"
#include "engine/simulation/simulation.hpp"
#include "engine/voxel/voxelize.hpp"

namespace verisim::peers {
namespace {

struct Dials {
  Hybrid hybrid;
  Integrator integrator = Integrator::implicit;
  double voxel_size = 0.0045;  ///< m
};

constexpr std::size_t kPin = 1;

BodyDescription body_from(const char* name, const Solid& solid, double voxel_size) {
  BodyDescription body;
  body.name = name;
  body.parts.push_back(load_solid(solid, {}));
  body.voxel_size = voxel_size;
  return body;
}

Scene scene_of(const Insertion& task, const Dials& dials, const Pose& start) {
  Scene scene;
  SimulationParameters& p = scene.parameters;
  p.timestep = kStep;
  p.hybrid = dials.hybrid;
  p.integrator = dials.integrator;
  p.max_stiffness = 5000;
  p.max_angular_stiffness = 50;
  p.max_coupling_force = task.force_max;
  p.max_coupling_torque = task.torque_max;
  BodyDescription block = body_from("block", exact::test::block_solid(task.chamfer), dials.voxel_size);
  block.fixed = true;
  BodyDescription pin = body_from("pin", exact::test::pin_solid(task.clearance), dials.voxel_size);
  pin.density = 1 / pin.parts.front().mass.volume;  // 1 kg
  pin.X_WB = start;
  scene.bodies = {std::move(block), std::move(pin)};
  HapticSamples samples;
  for (int i = 0; i <= exact::test::steps_of(task); ++i) {
    const Hand hand = hand_at(task, i * kStep);
    samples.t.push_back(i * kStep);
    samples.pose.push_back({hand.position, hand.rotation});
  }
  scene.devices = {make_replay("hand", std::move(samples))};
  scene.grasps = {{0, kPin}};
  return scene;
}

class InScene final : public Pusher {
 public:
  InScene(const Insertion& task, const Dials& dials, const Pose& start)
      : simulation_(scene_of(task, dials, start), {}) {
    simulation_.prepare_all();
  }
  [[nodiscard]] Motion motion() const override {
    const Twist twist = simulation_.body_twist(kPin);
    return {simulation_.body_pose(kPin), twist.linear, twist.angular};
  }
  Vector3d step(const Hand& /*hand: the device plays it*/) override {
    const Vector3d before = simulation_.body_twist(kPin).linear;
    simulation_.prepare();
    simulation_.step();
    return (simulation_.body_twist(kPin).linear - before) / kStep - simulation_.body_force(kPin).force;  // of 1 kg
  }

 private:
  Simulation simulation_;
};

class Voxels final : public Finder {
 public:
  Voxels(double clearance, double voxel_size)
      : block_(voxelize("block", load_solid(exact::test::block_solid(), {}).mesh, {.voxel_size = voxel_size})),
        pin_(voxelize("pin", load_solid(exact::test::pin_solid(clearance), {}).mesh, {.voxel_size = voxel_size})),
        contacts_(pin_.shell.size()) {}
  void place(const Pose& X) override { X_ = X; }
  double query() override {
    QueryCost cost;
    verisim::query(block_.voxmap, pin_.shell, X_, contacts_, cost);
    float deepest = kNothing;
    for (std::uint32_t i = 0; i < contacts_.size; ++i) deepest = std::max(deepest, contacts_.depth[i]);
    return static_cast<double>(deepest);
  }

 private:
  VoxelBody block_, pin_;
  ContactList contacts_;
  Pose X_;
};

class Surfaces final : public Finder {
 public:
  Surfaces(double clearance, double spacing, double margin)
      : link_(exact::test::body_of(exact::test::block_solid(), spacing),
              exact::test::body_of(exact::test::pin_solid(clearance), spacing), 4096),
        margin_(margin) {}
  void place(const Pose& X) override { X_ = X; }
  double query() override {
    const exact::BodyMotion standing, held{X_, X_.position, {}, {}};
    link_.find(standing, held, kStep, margin_);
    double nearest = -kNothing;
    for (const exact::ContactRow& row : link_.rows().rows()) nearest = std::min(nearest, row.gap);
    return -nearest;
  }

 private:
  exact::ExactLink link_;
  double margin_;
  Pose X_;
};

void add_pushes(Engine& engine, const Hybrid& hybrid) {
  const bool is_exact = hybrid == hybrid::exact;
  for (const double size : {0.009, 0.0045, 0.00225})
    for (const Integrator integrator : {Integrator::implicit, Integrator::semi_implicit}) {
      if (is_exact && integrator == Integrator::semi_implicit) continue;  // its problem holds the coupling, too
      const Dials dials{hybrid, integrator, size};
      engine.pushes.push_back({.text = fmt::format("{} every {:g} mm{}", is_exact ? "points" : "voxels", 1e3 * size,
                                                   is_exact                             ? ""
                                                   : integrator == Integrator::implicit ? ", implicit"
                                                                                        : ", semi-implicit"),
                               .round = true,
                               .make = [dials](const Insertion& task, const Pose& start) -> std::unique_ptr<Pusher> {
                                 return std::make_unique<InScene>(task, dials, start);
                               }});
    }
}

}  // namespace

std::vector<Engine> engines_here() {
  const auto engine = [](const char* name) { return Engine{.name = name, .version = VERISIM_VERSION, .package = ""}; };
  Engine off = engine("Verisim off"), restore = engine("Verisim restore"), exact = engine("Verisim exact");
  add_pushes(off, hybrid::off);
  add_pushes(restore, hybrid::restore);
  add_pushes(exact, hybrid::exact);
  for (const double size : {0.009, 0.0045, 0.00225, 0.001})
    off.finds.push_back({.text = fmt::format("voxels of {:g} mm", 1e3 * size),
                         .make = [size](double clearance) -> std::unique_ptr<Finder> {
                           return std::make_unique<Voxels>(clearance, size);
                         }});
  for (const double spacing : {0.018, 0.009, 0.0045})
    for (const double margin : {0.0, 0.0005, 0.005})
      exact.finds.push_back({.text = fmt::format("points every {:g} mm, margin {:g} mm", 1e3 * spacing, 1e3 * margin),
                             .make = [spacing, margin](double clearance) -> std::unique_ptr<Finder> {
                               return std::make_unique<Surfaces>(clearance, spacing, margin);
                             }});
  return {std::move(off), std::move(restore), std::move(exact)};
}

}  // namespace verisim::peers
