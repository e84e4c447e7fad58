// The inside of a Simulation: bodies, links, devices as the loop works on them. Everything is sized when it is made.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/constraint/blend.hpp"
#include "engine/contact/broad_phase.hpp"
#include "engine/contact/collision_link.hpp"
#include "engine/dynamics/body.hpp"
#include "engine/dynamics/coupling.hpp"
#include "engine/dynamics/integrator.hpp"
#include "engine/dynamics/ledger.hpp"
#include "engine/exact/convex_step.hpp"
#include "engine/exact/exact_link.hpp"
#include "engine/simulation/clocks.hpp"
#include "engine/simulation/hybrid_link.hpp"
#include "engine/simulation/simulation.hpp"
#include "engine/voxel/voxmap.hpp"

namespace verisim {

inline constexpr std::size_t kNone = static_cast<std::size_t>(-1);

struct Body {
  std::string name;
  RigidBody rigid;
  bool can_move = false;  ///< not fixed, and dynamic or something that a device may hold
  bool selectable = false;
  Bounds bounds_B;                                ///< of its meshes, body coordinates
  std::shared_ptr<const VoxelBody> voxels;        ///< null: nothing that moves can come near it
  std::unique_ptr<const MeshTree> mesh;           ///< null: not the way in which contacts are found
  Hybrid hybrid = Hybrid::off;                    ///< its method
  bool hybrid_enabled = true;                     ///< false: as if it were off
  std::unique_ptr<EntitySets> entities;           ///< null: no b-rep that the method could use
  std::shared_ptr<const exact::ExactBody> exact;  ///< null: not the method, or nothing precisely known
  std::size_t held_by = kNone;                    ///< device
  Coupling coupling;

  // of the frame that is being computed
  LinkBody link_body;
  Loads loads;
  std::uint64_t contacts = 0;
  unsigned links_touching = 0;  ///< of the last frame: shares the stability budget
  bool reshaped = false;        ///< a hybrid method changed forces of its contacts: they must not give energy
  std::size_t group = kNone;    ///< of bodies that share what their contacts may do: its first body
  ContactWork contact_work;     ///< of that body: the whole group's
  ContactEnd contact_end;
  Vector3d p_WC_found = Vector3d::Zero();  ///< m, centre of mass when contacts were found
  bool solved = false;                     ///< by the exact response: moves with `velocity`
  std::size_t island = kNone;              ///< of bodies that the exact response solves together: its first body
  int in_solver = exact::kFixed;
  ImplicitStep implicit;
  Vector6d velocity;
  Wrench exact_wrench;
  Wrench contact_wrench;  ///< as applied
};

struct Link {
  std::size_t first, second;               ///< bodies, first < second
  std::unique_ptr<CollisionLink> contact;  ///< null: one of them has no voxels
  std::unique_ptr<HybridLink> hybrid;      ///< null: no method, or one of them has no b-rep
  std::unique_ptr<exact::ExactLink> exact;
  MemoCounts counted;         ///< of `hybrid`, up to the last frame
  bool voxels_answer = true;  ///< false: every face of both is precisely known, the exact method needs no voxel

  // of the frame that is being computed
  bool near = false;
  Hybrid method = Hybrid::off;
  std::uint32_t contacts = 0, cache_hits = 0, cache_misses = 0;
  ConstraintKind constraint = ConstraintKind::none;
  double alpha = 0;
  double depth_max = 0;
  bool reshaped = false;  ///< its voxels' contacts were changed by a method, or appeared when one was switched off
  LinkSide first_side, second_side;  ///< of its voxels' contacts, if it touches
  Wrench on_second;                  ///< as applied
  [[nodiscard]] bool touches() const { return contact && contact->contacts().size > 0; }
};

struct Held {
  std::size_t body = kNone;
  Pose X_HB;               ///< body in handle coordinates, as grasped
  bool by_script = false;  ///< grasp(): held whatever the button says
  Wrench on_hand;          ///< what the hand felt last, about the virtual handle
  Pose handle_before;      ///< one frame ago
  bool sampled = false;    ///< handle_before is valid
};

/// What a wrench on one body is to the other, both as they stood when their contacts were found.
[[nodiscard]] Wrench reaction(const Wrench& wrench, const Body& on, const Body& other);

struct Simulation::Implementation {
  SimulationParameters parameters;
  double dt;
  unsigned threads = 1;
  std::vector<Body> bodies;
  std::vector<Link> links;                ///< ascending (first, second)
  std::vector<std::size_t> link_of_pair;  ///< (first * bodies + second) -> link or kNone
  std::unique_ptr<BroadPhase> broad_phase;
  std::vector<std::shared_ptr<Device>> devices;
  std::vector<Held> held;                     ///< per device
  std::unique_ptr<exact::ConvexStep> solver;  ///< null: no body's method is exact
  std::vector<std::shared_ptr<wii::Head>> heads;
  double grasp_distance = 0.1;
  std::vector<Grasp> first_grasps;  ///< of the scene: taken in the first frame, when the handles have been sampled
  Ledger ledger;
  EnergyState energy;
  Clocks clocks;
  std::uint64_t frame = 0, collision_frames = 0, frames_planned = 0;
  FrameCost cost;
  Totals totals;
  std::vector<Event> events;
  std::array<std::uint32_t, kStageNames.size()> stage_ns{};
  Schema schema;  ///< /state and /cost
  std::vector<std::byte> row;
  std::uint64_t hash = 0;

  Implementation(Scene scene, const SimulationOptions& options);

  // world.cpp: how a scene becomes this
  void choose_methods(const Scene& scene);
  void place_bodies(const Scene& scene);
  void voxelize_bodies(const Scene& scene);
  void make_links();
  void make_hybrid(const BodyDescription& description, Body& body);
  void make_hybrid(Link& link);
  [[nodiscard]] double reach_of(std::size_t body) const;
  /// m, between the boxes around two bodies' meshes, along the world's axes.
  [[nodiscard]] static double box_gap(const Body& a, const Body& b);
  /// m, by which the broad phase takes a body to be larger than its mesh: its voxels reach up to one voxel beyond that,
  /// on either side of a pair.
  [[nodiscard]] static double grown_by(const Body& body);

  // step.cpp: the stages of one frame, in their order
  void sample_devices(double t);
  void pull();
  void query_contacts();
  void count_contacts(Link& link, std::uint32_t contacts);
  void respond();
  void integrate();

  // sharing.cpp
  void join_groups();
  void share_contacts();
  [[nodiscard]] Wrench applied(const LinkSide& mine, const Body& body, const LinkSide& theirs, const Body& other) const;
  void tell_contacts();

  // hybrid.cpp
  [[nodiscard]] Hybrid method_of(const Link& link) const;
  [[nodiscard]] bool moves(const Body& body) const;
  [[nodiscard]] Pose relative_pose(const Link& link) const;
  bool restore_normals(Link& link);
  void restore_forces(Link& link);
  void blend(Link& link, LinkSide& on_first, LinkSide& on_second);
  void note(Link& link, const RestoreResult& result);
  void solve_exactly();
  [[nodiscard]] double closing(const Link& link) const;
  void find_exact_contacts(Link& link);
  void join_islands();
  void solve_island(std::size_t island);
  void share_out(Link& link, std::size_t first_row);
  [[nodiscard]] Wrench felt(const Body& body, const StepWork& work) const;
  void render();
  void follow_heads();
  void take_stock();

  // grasping.cpp
  void update_grasps();
  void take(std::size_t device, std::size_t body, bool by_script);
  void let_go(std::size_t device);
  [[nodiscard]] std::size_t nearest_body(const Vector3d& p_W) const;
  [[nodiscard]] CouplingTarget target_of(std::size_t device) const;
  [[nodiscard]] EnergyState energy_now() const;

  // columns.cpp: what a row holds
  void make_schema();
  void fill_row();
};

}  // namespace verisim
