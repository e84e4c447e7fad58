// A scene as plain data: what a scenario script describes and a Simulation is made from. World coordinates, SI.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/companion.hpp"
#include "engine/constraint/alignment.hpp"
#include "engine/constraint/reduction.hpp"
#include "engine/device/device.hpp"
#include "engine/geometry/part.hpp"
#include "engine/simulation/hybrid_method.hpp"
#include "engine/voxel/declared_features.hpp"

namespace verisim {

enum class Integrator { semi_implicit, implicit };

/// How contacts of two bodies are found: pointshell against voxmap, or triangle against triangle to compare with (no
/// hybrid method acts on those).
enum class ContactMethod { voxmap, fcl };

/// defineSimulationParameters{…} (INTERFACES sections 2 and 3: names and defaults).
struct SimulationParameters {
  double timestep = 0.001;              ///< s
  Vector3d gravity = Vector3d::Zero();  ///< m/s^2
  std::uint64_t seed = 1;
  std::optional<double> duration;  ///< s; none: as long as the longest trace or operator task, else 1 s
  double frame_rate = 60;          ///< Hz, of the script's frames
  Integrator integrator = Integrator::semi_implicit;
  Hybrid hybrid = hybrid::restore;  ///< where both bodies have b-reps; of two that differ the lesser acts
  /// Nobody named a method, or an integrator: where `exact` can act, it does, and its steps are implicit
  /// (make_world.cpp). A scenario's default; a Scene that is made here names both.
  bool hybrid_by_default = false, integrator_by_default = false;
  ContactMethod contact = ContactMethod::voxmap;
  AlignmentMeasure alignment = AlignmentMeasure::by_type;
  Reduction reduction = Reduction::common_freedom;
  double max_stiffness = 300;                                            ///< N/m, virtual coupling
  double max_angular_stiffness = 0.1;                                    ///< N m/rad
  double max_coupling_force = std::numeric_limits<double>::infinity();   ///< N
  double max_coupling_torque = std::numeric_limits<double>::infinity();  ///< N m
  double coupling_damping_ratio = 1;  ///< of the critical damping of the virtual coupling
  /// The rule that keeps explicit couplings and contacts within their stability budget. False: they have the stiffness
  /// asked for, whatever comes of it. For those who look for the bound itself (engine/stability); no word of scenarios.
  bool stability_rule = true;
  bool all_bodies_are_dynamic = false;  ///< false: bodies that no device holds do not move
  double contact_stiffness = 10000;     ///< N/m per contact, before the stability rule (contact/penalty.hpp)
  double contact_damping_ratio = 0.5;   ///< of the critical damping of the contact stiffness in force
  // Of contacts between precise surfaces (`exact`). Stiffness: N/m per m of an edge; half of E / (1 - nu^2) of steel on
  // steel by default (engine/exact/exact_body.hpp). Restitution: speed of rebound by speed of approach, 0 (inelastic)
  // to 1; slower approaches than restitution_speed [m/s] are inelastic, so that what bounces comes to rest
  // (engine/exact/convex_step.hpp). Friction: coefficient, 0 to 1, of what slides faster than 1 mm/s; what is slower it
  // resists in proportion, so that it holds nothing for ever. So little as by default holds light bodies between heavy
  // ones (stages/exact_response.cpp) and takes a millionth of its weight from what slides.
  double exact_stiffness = 1.15e11;
  double exact_friction = 1e-6;
  double restitution = 0;
  double restitution_speed = 0.01;
  /// Voxels' contacts give back what they were given: their springs begin where they began
  /// (contact/collision_link.hpp), and what `restore` or `blend` changed is bounded (stages/passivity.hpp). False:
  /// depths act as the voxels give them.
  bool passive_contacts = true;
};

struct BodyDescription {
  std::string name;
  std::vector<Part> parts;   ///< one or more solids that move as one; part coordinates = body coordinates
  Pose X_WB;                 ///< start pose
  double density = 20;       ///< kg/m^3 (SPARTA's usual)
  double voxel_size = 0;     ///< m
  double point_spacing = 0;  ///< m; 0: one point per surface voxel
  bool fixed = false;
  bool selectable = true;
  bool use_brep = true;                        ///< brep=: hybrid methods may use its parts' entities
  std::shared_ptr<DeclaredFeatures> declared;  ///< entities declared by hand, brep= or not; null: none
  std::optional<Hybrid> hybrid;                ///< none: the simulation's
  bool hybrid_enabled = true;                  ///< may be switched during the run (setHybridEnabled)
  Twist twist;                                 ///< start velocity
};

/// grasp(device, body): holds from the first frame, whatever the button says. Indices into Scene.
struct Grasp {
  std::size_t device;
  std::size_t body;
};

struct Scene {
  SimulationParameters parameters;
  std::vector<BodyDescription> bodies;                 ///< in the order of addObject
  std::vector<std::shared_ptr<Device>> devices;        ///< in the order of addDevice: outermost filter of each chain
  std::vector<std::shared_ptr<Companion>> companions;  ///< advanced beside the loop, in this order
  std::vector<Grasp> grasps;
  double grasp_distance = 0.1;  ///< m, handle to body's nearest point, for button grasping
};

}  // namespace verisim
