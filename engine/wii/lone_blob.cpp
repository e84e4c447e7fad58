#include "engine/wii/lone_blob.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim::wii {
namespace {

constexpr double kFits = 9;         // of a cost: three standard deviations
constexpr double kLikely = 0.1;     // a head that would be another one
constexpr double kSamePlace = 0.1;  // m
constexpr double kSameTurn = 0.3;   // rad, three standard deviations of how far a head turns in a report or two

/// The head of least cost, if no other is likely. All others widen its covariance, as likely as they are.
SolvedPose only_one_of(std::span<const SolvedPose> heads) {
  const SolvedPose& best =
      *std::min_element(heads.begin(), heads.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; });
  SolvedPose head = best;
  for (const SolvedPose& other : heads) {
    Vector6d apart;
    apart << other.X_RH.position - best.X_RH.position,
        vector_from_rotation((other.X_RH.rotation * best.X_RH.rotation.conjugate()).normalized());
    const double likely = 1 / (1 + pinned::exp((other.cost - best.cost) / 2));
    const bool another = apart.tail<3>().norm() > kSameTurn || apart.head<3>().norm() > kSamePlace;
    if (likely > kLikely && another) return {};
    head.covariance += likely * apart * apart.transpose();
  }
  return head;
}

}  // namespace

std::span<const Sighting> pair_of(std::span<const Sighting> three) {
  VERISIM_ASSERT(three.size() == 3);
  return three.subspan(three[0].remote == three[1].remote ? 0 : 1, 2);
}

LoneBlobSolver::Result LoneBlobSolver::solve(std::span<const Sighting> three, const Pose& start,
                                             const std::optional<Quaterniond>& last) const {
  VERISIM_ASSERT(three.size() == 3);
  const std::span<const Sighting> pair = pair_of(three);
  std::array<Sighting, 3> used = {pair[0], pair[1], pair.data() == three.data() ? three[2] : three[0]};
  Sighting& lone = used[2];
  std::array<SolvedPose, 4> heads;
  std::size_t count = 0;
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 2 && !(last && best <= kFits); ++i) {
    const bool first_is_lone = (lone.p_H == pair[0].p_H) != (i == 1);
    const Sighting& same = first_is_lone ? pair[0] : pair[1];
    const Sighting& other = first_is_lone ? pair[1] : pair[0];
    lone.p_H = same.p_H;
    for (const double side : {1.0, -1.0}) {
      const SolvedPose head = solver_.solve(used, upright_, start_of_turn(lone, same, other, side, start.rotation));
      if (!head.found) continue;
      heads[count] = judged(head, last);
      best = std::min(best, heads[count++].cost);
    }
  }
  if (!(best <= kFits)) return {};
  const SolvedPose head = only_one_of(std::span(heads).first(count));
  return {head, !head.found};
}

/// A cost for comparison with other turns: the prior that heads are upright, wide while one pose is sought, counts in
/// full.
SolvedPose LoneBlobSolver::judged(SolvedPose head, const std::optional<Quaterniond>& last) const {
  const Matrix3d R_LH = upright_.C_LR * head.X_RH.rotation.toRotationMatrix();
  const double width = settings_.thresholds.prior_width;
  const double yaw = R_LH(2, 0) / settings_.yaw_sigma;
  const double pitch = R_LH(2, 1) / settings_.pitch_sigma;
  head.cost += (1 - 1 / (width * width)) * (yaw * yaw + pitch * pitch);
  if (last) {
    const Vector3d turn = vector_from_rotation((head.X_RH.rotation * last->conjugate()).normalized()) * (3 / kSameTurn);
    head.cost += turn.squaredNorm();
  }
  return head;
}

/// Where the head is if the LED of two images lies where its rays meet, and the other on its own ray, at the glasses'
/// distance from it, behind (side 1) or before (-1) the point that is nearest. `near` settles what is left open.
Pose LoneBlobSolver::start_of_turn(const Sighting& lone, const Sighting& same, const Sighting& other, double side,
                                   const Quaterniond& near) const {
  const Ray a = ray_of(lone), b = ray_of(same), c = ray_of(other);
  const double ab = a.along.dot(b.along);
  const Vector3d apart = b.eye - a.eye;
  const double on_b = (ab * a.along.dot(apart) - b.along.dot(apart)) / std::max(1 - ab * ab, 1e-9);
  const Vector3d known = b.eye + on_b * b.along;
  const Vector3d nearest = c.eye + c.along.dot(known - c.eye) * c.along;
  const double spacing_square = (other.p_H - same.p_H).squaredNorm();
  const double along = std::sqrt(std::max(0.0, spacing_square - (nearest - known).squaredNorm()));
  const Vector3d line = nearest + side * along * c.along - known;
  const Quaterniond turn = turn_between(near * (other.p_H - same.p_H), line).normalized();
  const Quaterniond R_RH = (turn * near).normalized();
  return {known - R_RH * same.p_H, R_RH};
}

LoneBlobSolver::Ray LoneBlobSolver::ray_of(const Sighting& s) const {
  const Vector3d ray = pinhole_.ray(s.u, s.v).normalized();
  if (s.remote == 0) return {Vector3d::Zero(), ray};
  return {settings_.X_R1R2->position, settings_.X_R1R2->rotation * ray};
}

}  // namespace verisim::wii
