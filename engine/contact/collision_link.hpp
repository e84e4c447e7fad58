// One CollisionLink per pair of bodies. It finds their contacts and sums the contacts' forces. In between a hybrid
// method may change each contact (dissertation sections 6.4.2 and 8.5: detection is separate from response).
//
// The pair is (first, second) in the order in which the scenario added the bodies. One provides the points (the one
// with fewer, the second if equal), the other the voxmap. Contact lists are in the body coordinates of the voxmap's
// body, relative to its grid origin. Results are in world coordinates.
//
// A contact's spring begins where the contact began. A voxel's depth jumps: a point that enters a voxel from the side
// is a step deep at once, and where normals turn from voxel to voxel the depth of a point that slides goes up and down
// as a saw. A force of such a depth belongs to no potential: it throws what touches, and nothing comes to rest. So the
// spring of a point is pressed by what the point has come inwards along its contact's normal since it touched (in the
// first frame: in that frame), and never by more than the depth (PenaltyParameters::from_touch). It gives back what it
// was given. Where the stability rule changes the stiffness, the springs keep their forces. Reported depths are those
// of the places. Where springs press, a little friction holds what may rest (grip.hpp).
// Contacts of triangles (find_by_triangles) have no memory, and no friction: their depths are of a continuous surface.
#pragma once

#include <cstdint>

#include "engine/base/pose.hpp"
#include "engine/contact/grip.hpp"
#include "engine/contact/mesh_query.hpp"
#include "engine/contact/penalty.hpp"
#include "engine/contact/query.hpp"
#include "engine/voxel/voxmap.hpp"

namespace verisim {

/// State of a body in this frame.
struct LinkBody {
  Pose X_WB;
  Vector3d p_WC;                     ///< centre of mass
  Twist twist;                       ///< of the centre of mass
  Matrix6d inverse_mass;             ///< world coordinates; zero for a body that does not move
  double budget = kStabilityBudget;  ///< part of the stability budget for what this link does at the start of a step
};

struct PenaltyParameters {
  double stiffness_max = 1000;  ///< N/m per contact
  double damping_ratio = 0.5;   ///< of critical
  bool stabilize = true;        ///< apply the stability rule of penalty.hpp
  bool from_touch = false;      ///< springs begin where contacts began; else depths press them as the voxels give these
};

/// The response on one body.
struct LinkSide {
  Wrench wrench;                          ///< on the body, about its centre of mass, world coordinates
  Matrix6d stiffness = Matrix6d::Zero();  ///< K = k W about the centre of mass, world
  Matrix6d damping = Matrix6d::Zero();    ///< D = b W
  Vector6d drift = Vector6d::Zero();      ///< K times the other body's twist at this centre of mass
};

struct LinkSides {
  LinkSide first, second;
};

class CollisionLink {
 public:
  /// Both must outlive the link. @pre both are voxelized, and the clusters of their points cover
  /// these in order
  CollisionLink(const VoxelBody& first, const VoxelBody& second);
  /// Switches detection to triangles against triangles, with at most kMeshContactsMax contacts.
  void find_by_triangles(const MeshTree& first, const MeshTree& second);
  static constexpr std::size_t kMeshContactsMax = 16384;

  /// Detection: fills the contact list. No allocation (but by FCL). @pre rotations are unit, if the poses are finite
  void query(const Pose& X_W1, const Pose& X_W2, QueryCost& cost);
  [[nodiscard]] ContactList& contacts() { return contacts_; }
  [[nodiscard]] const ContactList& contacts() const { return contacts_; }

  // Of both parts: @pre dt is finite and above 0; stiffness_max and damping_ratio are finite and not negative; inverse
  // masses are symmetric; the budget of a body that moves is above 0. Where there is no contact, nothing is asked.

  /// Response, part one: sets the stiffness by the stability rule and the penalty force of every contact.
  void respond(const LinkBody& first, const LinkBody& second, const PenaltyParameters& parameters, double dt);
  /// Response, part two: sums what the contacts' forces now are. No matrices.
  void sum_up(const LinkBody& first, const LinkBody& second, LinkSides& sides);

  // For an implicit step, in which only one of the bodies moves. Methods may have changed normals. Forces of single
  // contacts are not stored.

  /// Both parts in one pass, with matrices.
  void respond_at_once(const LinkBody& first, const LinkBody& second, const PenaltyParameters& parameters, double dt,
                       LinkSides& sides);

  [[nodiscard]] double depth_max() const { return depth_max_; }  ///< m
  [[nodiscard]] double stiffness() const { return stiffness_; }  ///< N/m per contact, as the rule allowed
  void clear();                                                  ///< no contact in this frame

  /// True if the first body provides the voxmap.
  [[nodiscard]] bool first_is_map() const { return first_is_map_; }

 private:
  /// Replaces each contact's depth by how far its spring is pressed (see above).
  void follow_motion();
  struct PressureSum;
  /// How the bodies slid where springs press. What lies at x, relative to the grid's origin, came `turned x + moved`
  /// since the query before.
  void follow_patch(const PressureSum& pressure, const Matrix3d& turned, const Vector3d& moved);
  /// Sets W_, stiffness_ and damping_.
  void choose_stiffness(const LinkBody& first, const LinkBody& second, const PenaltyParameters& parameters, double dt);
  /// Twist of the points' body relative to the map's, at the centre of the points' body, axes of the map's.
  [[nodiscard]] Twist relative_twist(const LinkBody& first, const LinkBody& second) const;
  /// Of the points' body relative to the map's: what an impulse changes that twist by.
  [[nodiscard]] Matrix6d mobility(const LinkBody& first, const LinkBody& second) const;
  /// Adds what the grip does to the contacts' wrench on the points' body.
  Grip::Matrices hold(const LinkBody& first, const LinkBody& second, Wrench& on_points);
  /// A wrench on the points' body, axes of the map's, becomes that on both.
  void give_wrench(const LinkBody& first, const LinkBody& second, const Wrench& on_points, LinkSides& sides) const;
  /// With the matrices of both.
  void give_pushing(const LinkBody& first, const LinkBody& second, const Pushing& contacts, LinkSides& sides);

  const Voxmap* map_;
  const Pointshell* shell_;
  bool first_is_map_;
  const MeshTree* map_mesh_ = nullptr;  ///< null: by voxels
  const MeshTree* points_mesh_ = nullptr;
  ContactList contacts_;
  std::vector<float> depth_before_;    ///< m, of each point: how far its spring was pressed in query met_in_
  std::vector<std::uint64_t> met_in_;  ///< query in which each point was last in contact, from 1; 0: never
  std::uint64_t queries_ = 0;
  Pose X_MP_, X_MP_before_;  ///< of the points' body in the map's, in this query and in the one before
  double stiffness_before_ = 0;
  Grip grip_;
  Grip::Patch patch_;             ///< in axes of the map's body, relative to its grid's origin
  std::uint64_t pressed_in_ = 0;  ///< query in which any spring was pressed
  double dt_ = 0;
  double deepest_ = 0;             ///< m, of the places, not of the springs
  Matrix6d W_ = Matrix6d::Zero();  ///< about the points' body's centre of mass, axes of the map's body
  Vector3d about_ = Vector3d::Zero();
  double stiffness_ = 0, damping_ = 0, depth_max_ = 0;
};

}  // namespace verisim
