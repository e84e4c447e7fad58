// Friction between two bodies that touch by voxels, just enough that what may rest does rest.
//
// Voxels are frictionless. But a body that settles on them tilts by some mrad, and normals between a face and its
// border leave a push of up to 1e-3 of its weight: it gets some mm/s, and nothing would stop it. So where the contacts
// press, a bristle holds the two bodies together: a spring across the force, that is stretched by the way that the
// point of pressure slides and by how far the body turns, times its distance from there, and slips beyond kGrip times
// the force (Dahl's model of friction, with a damper). It stores
// no more than it was given, and forgets what it slips. What slides faster moves on purpose: there the limit fades by
// the square of the speed, to 3e-7 of the force at 1 m/s.
#pragma once

#include "engine/base/pose.hpp"

namespace verisim {

class Grip {
 public:
  static constexpr double kGrip = 3e-3;  ///< of the pressing force, at rest
  static constexpr double kFast = 1e-2;  ///< m/s at which half of it is left

  /// Where the springs of the contacts press, and how the body that is held moved there since the frame before,
  /// relative to the other. Any axes, the same in every frame, as below.
  struct Patch {
    Vector3d middle = Vector3d::Zero();  ///< m
    double radius = 0;                   ///< m, root mean square
    Vector3d slid = Vector3d::Zero();    ///< m
    Vector3d turned = Vector3d::Zero();  ///< rad
  };
  /// Once in every frame with contacts that press.
  void follow(const Patch& patch);
  void let_go() { stretched_ = held_ = {}; }

  /// About the centre of mass of the body that is held.
  struct Now {
    Vector3d arm;       ///< m, to the middle of the patch
    double radius;      ///< m, of the patch
    Twist velocity;     ///< relative to the other body
    Matrix6d mobility;  ///< change of that velocity by an impulse, of both bodies
    double budget;      ///< part of the stability budget of 4 that this contact has
    double dt;          ///< s
  };
  /// K = stiffness * across and D = damping * across of the grip's wrench, for an implicit step. Zero where it slips.
  struct Matrices {
    double stiffness = 0, damping = 0;  ///< N/m, N s/m
    Matrix6d across = Matrix6d::Zero();
  };
  /// Adds to `pressure`, the contacts' wrench on the body, what the grip does at the start of the step.
  /// @pre dt and budget are above 0; mobility is symmetric
  Matrices hold(const Now& now, Wrench& pressure);

 private:
  struct Bristle {
    Vector3d slid = Vector3d::Zero();    ///< m
    Vector3d turned = Vector3d::Zero();  ///< rad
  };
  Bristle stretched_;  ///< by the way since it was let go, but for what it slipped in earlier frames
  Bristle held_;       ///< what is left of that after the slip of this frame
};

}  // namespace verisim
