// What two remotes see when one shows both LEDs of a pair and the other shows one: the distance to that LED is known,
// and the second lies on its ray, before or behind where the ray comes nearest to the first. That is a head turned one
// way or the other; and where it is not known which LED the lone blob is, two more.
#pragma once

#include <optional>
#include <span>

#include "engine/wii/pose_solver.hpp"

namespace verisim::wii {

/// The two of these three sightings that are of one remote. @pre they are
[[nodiscard]] std::span<const Sighting> pair_of(std::span<const Sighting> three);

class LoneBlobSolver {
 public:
  /// Keeps references. @pre there is a second remote; the prior's yaw and pitch are 0 a priori
  LoneBlobSolver(const TrackerSettings& settings, const Pinhole& pinhole, const PoseSolver& solver,
                 const Upright& upright)
      : settings_(settings), pinhole_(pinhole), solver_(solver), upright_(upright) {}

  struct Result {
    SolvedPose head;         ///< found if one fits and no other is likely; all others widen its covariance
    bool ambiguous = false;  ///< several are likely. Neither: none fits, so a blob is no LED
  };
  /// At most four solutions from closed forms. `last` is the rotation R_RH of a head whose yaw was seen a report or two
  /// ago: then the lone blob is the LED that it was, and the head has hardly turned.
  /// @pre three sightings, a pair of one remote and one of the other
  [[nodiscard]] Result solve(std::span<const Sighting> three, const Pose& start,
                             const std::optional<Quaterniond>& last) const;

 private:
  struct Ray {
    Vector3d eye, along;
  };
  [[nodiscard]] Ray ray_of(const Sighting& s) const;
  [[nodiscard]] Pose start_of_turn(const Sighting& lone, const Sighting& same, const Sighting& other, double side,
                                   const Quaterniond& near) const;
  [[nodiscard]] SolvedPose judged(SolvedPose head, const std::optional<Quaterniond>& last) const;

  const TrackerSettings& settings_;
  const Pinhole& pinhole_;
  const PoseSolver& solver_;
  const Upright& upright_;
};

}  // namespace verisim::wii
