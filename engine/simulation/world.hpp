// What is simulated, as plain data: bodies, the pairs of them that may meet, the hands that hold them, and what runs
// beside the loop. World coordinates, SI.
//
// Constants stand before state. A state has one writer, named beside it: a stage of the frame
// (engine/simulation/stages), or a script between frames through Simulation. What a stage keeps for itself, per body or
// per link, is the stage's.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/base/companion.hpp"
#include "engine/constraint/entities.hpp"
#include "engine/contact/mesh_query.hpp"
#include "engine/device/collision_start.hpp"
#include "engine/device/device.hpp"
#include "engine/dynamics/body.hpp"
#include "engine/dynamics/coupling.hpp"
#include "engine/exact/exact_body.hpp"
#include "engine/record/run_file.hpp"
#include "engine/simulation/clocks.hpp"
#include "engine/simulation/known_surface.hpp"
#include "engine/simulation/scene.hpp"
#include "engine/voxel/voxmap.hpp"

namespace verisim {

inline constexpr std::size_t kNone = static_cast<std::size_t>(-1);

struct Body {
  // constant
  std::string name;
  bool can_move = false;  ///< not fixed, and dynamic or something that a device may hold
  bool selectable = false;
  Bounds bounds_B;  ///< of its meshes
  Coupling coupling;
  double voxel_size = 0;       ///< m
  Hybrid asked = hybrid::off;  ///< by the scene, for this body
  Hybrid method =
      hybrid::off;       ///< that, but off where triangles are asked; which one acts on a pair: hybrid_method.hpp
  KnownSurface surface;  ///< as its models have it

  // constant once it is made, which is when another body first comes near (BodyMaker)
  std::shared_ptr<const VoxelBody> voxels;        ///< null: not made yet
  std::unique_ptr<const MeshTree> mesh;           ///< null: not the way in which contacts are found
  std::unique_ptr<const EntitySets> entities;     ///< null: no b-rep that the method could use
  std::shared_ptr<const exact::ExactBody> exact;  ///< null: not asked for, or nothing precisely known

  // state
  RigidBody rigid;              ///< stages/motion; a script that puts the body elsewhere
  bool hybrid_enabled = true;   ///< false: as if its method were off. A script
  std::size_t held_by = kNone;  ///< hand. stages/grasping
};

/// Two bodies of which at least one can move, and which came near each other: contact is found, answered and recorded
/// per link.
struct Link {
  std::size_t first, second;   ///< bodies, first < second
  std::size_t number = kNone;  ///< in the order of first meetings; kNone: made in advance. Simulation::prepare
};

/// A device and what it holds. stages/grasping writes it; from `collisions` on stages/rendering.
struct Hand {
  std::shared_ptr<Device> device;
  std::size_t body = kNone;
  Pose X_HB;                      ///< body in handle coordinates, as grasped
  bool by_script = false;         ///< grasp(): held whatever the button says
  Pose handle_before;             ///< one frame ago
  std::uint32_t collisions = 0;   ///< contacts of the body that it holds
  bool collision_starts = false;  ///< in the same frame
  CollisionStart detector;
  Vector3d ahead = Vector3d::Zero();  ///< rad, by which it is turned ahead of the body (CouplingForce::e)
};

struct World {
  SimulationParameters parameters;
  double dt = 0;  ///< s
  std::vector<Body> bodies;
  std::vector<Link> links;  ///< in the order in which they were made; grows between frames. Simulation::prepare
  /// Links whose bodies are near in this frame, ascending (first, second): what stages look at. stages/neighbours
  std::vector<std::size_t> near_links;
  /// Bodies that move in this frame, ascending. Whoever writes Body::held_by sets `holds_changed`. list_moving()
  std::vector<std::size_t> moving;
  bool holds_changed = true;
  /// Bodies of which anything is computed in this frame, ascending: those that move or are of a near link, and those of
  /// the last frame, so that what it left behind of them is taken back. Of all others everything is as it was.
  /// stages/busy
  std::vector<std::size_t> busy;
  std::vector<Hand> hands;
  std::vector<std::shared_ptr<Companion>> companions;
  Clocks clocks;
  std::uint64_t frame = 0;  ///< frames computed so far. Simulation::step

  /// s; never a sum of steps: its roundings would pile up, and 60.000 s would not be frame 60,000.
  [[nodiscard]] double time() const { return static_cast<double>(frame) * dt; }
  /// Does it move in this frame? What nobody holds stands still unless all bodies are dynamic.
  [[nodiscard]] bool moves(const Body& body) const {
    return body.can_move && (parameters.all_bodies_are_dynamic || body.held_by != kNone);
  }
  /// Writes `moving`.
  void list_moving() {
    if (!std::exchange(holds_changed, false)) return;
    moving.clear();
    for (std::size_t i = 0; i < bodies.size(); ++i)
      if (moves(bodies[i])) moving.push_back(i);
  }
  [[nodiscard]] bool is_implicit() const { return parameters.integrator == Integrator::implicit; }
};

/// m, by which a body is taken to be larger than its mesh: its voxels reach up to one voxel beyond that, on either side
/// of a pair.
[[nodiscard]] inline double grown_by(const Body& body) {
  return body.voxel_size > 0 ? 2 * body.voxel_size : 0;  // a size that is none is refused when it is needed
}
/// The box along the world's axes around a body's mesh.
[[nodiscard]] Bounds world_box(const Body& body);
/// m, between two boxes along the same axes; 0: they meet.
[[nodiscard]] double gap(const Bounds& a, const Bounds& b);

/// Places bodies, devices and companions. Adds to `events` what was asked for and cannot act. Error(input) with body
/// and reason. What contacts need of a body is made when something comes near (body_maker.hpp).
/// @pre no device, companion or method is null; grasps name a device and a body
[[nodiscard]] World make_world(const Scene& scene, std::vector<Event>& events);

}  // namespace verisim
