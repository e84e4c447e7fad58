// Sharp-edge ownership: which of two faces that meet in an edge a point near that edge belongs to. At a convex edge the
// solid is the intersection of the two half spaces, so the face with the larger signed distance owns the point; at a
// concave edge it is their union, and either face keeps its own points. exact_link.hpp gives the rules and their
// reasons. Base coordinates [m] (see candidate.hpp). Private to this folder.
#pragma once

#include <span>

#include "engine/exact/candidate.hpp"

namespace verisim::exact {

/// m: contacts are hardly ever so deep, walls never so thin. What is deeper may have come in through another face.
inline constexpr double kThinnest = 1e-5;

/// True if another of the face's edges hides one from a place: so the far side of a narrow rib or slot is no border of
/// what lies beside its near side. A place that is beyond the near side, too, is still nearer to it.
/// @param edges   of the face, near the place    @param across  of the place, from the face across edge e
[[nodiscard]] bool is_hidden(const ExactBody& base, std::uint32_t face, std::span<const std::uint32_t> edges,
                             std::uint32_t e, const Vector3d& p, const SurfaceAt& across);

/// True if a point of a face's surface lies within the face.
[[nodiscard]] bool is_on_face(const ExactBody& base, std::uint32_t face, const Vector3d& foot);

/// Which distances are compared at a convex edge.
///   by_position     those of the point as it is: the point is inside both faces
///   by_free_motion  those after the step without contact: the point is outside both, and the face that it would pass
///                   last owns it
///   by_last_motion  those after a repetition of the last step: the point lies on one of the faces. It slides along
///                   that face; its motion without contact would push it into the face and says nothing about sliding
enum class OwnershipRule : std::uint8_t { by_position, by_free_motion, by_last_motion };
/// @param a, b        signed distances of the point from the two faces [m]
/// @param coincident  m: SearchThresholds::coincident
[[nodiscard]] OwnershipRule ownership_rule(double a, double b, double coincident);

/// The other face of an edge of `face`. @pre the edge is one of its (not asserted: it is asked in the search's loops)
[[nodiscard]] std::uint32_t face_across(const ExactEdge& edge, std::uint32_t face);

/// The distances of a point from two faces as its rule compares them [m].
struct ComparedDistances {
  double mine, other;
};
/// By that rule; compared_distances() by the one that holds at the point.
[[nodiscard]] ComparedDistances compared_by(const BodyPair& pair, OwnershipRule rule, const Vector3d& p,
                                            const SurfaceAt& mine, const SurfaceAt& other);
[[nodiscard]] ComparedDistances compared_distances(const BodyPair& pair, const Vector3d& p, const SurfaceAt& mine,
                                                   const SurfaceAt& other);

/// True if `mine` owns the point p against `other`, its neighbour across a convex edge of the base.
/// @param mine, other  distance and normal of the two faces at p
/// @param wins_tie     the answer where both are equally far
[[nodiscard]] bool owns_point(const BodyPair& pair, const Vector3d& p, const SurfaceAt& mine, const SurfaceAt& other,
                              bool wins_tie);

/// True if a place lies on a face that can push it, across a convex edge of `face` near `foot`, a point of that: it
/// will slide on, and not fall beside it. @param except  a face that does not count; kNoFace: all do
[[nodiscard]] bool lies_across(const BodyPair& pair, std::uint32_t face, const Vector3d& foot, const Candidate& c,
                               std::uint32_t except);

/// True if the candidate becomes a row against `face` of the base: its foot lies within the face's trim, and no sharp
/// edge gives the point to another face. Sets the candidate's weight.
/// @pre place, point, gap and normal of `c` are those against `face`, which is one of the base's
[[nodiscard]] bool accept_candidate(const BodyPair& pair, const PlacedFeature& placed, std::uint32_t face,
                                    Candidate& c);

}  // namespace verisim::exact
