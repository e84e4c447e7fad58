// The class behind search(): what is common to features against faces (search.cpp) and edges against edges
// (search_edges.cpp). Private to this folder.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "engine/exact/candidate.hpp"
#include "engine/exact/curving.hpp"
#include "engine/exact/near_pairs.hpp"
#include "engine/exact/ownership_culling.hpp"

namespace verisim::exact {

inline constexpr double kSlack = 1e-9;  // m: more than double precision says of bodies of kilometres

class Search {
 public:
  Search(const ExactBody& mover, const ExactBody& base, const RelativeMotion& motion, RowList& rows, SearchCost& cost)
      : pair_{mover, base, motion}, near_(mover, base, motion), rows_(rows), cost_(cost) {}

  double run(NodePairs& stack);

 private:
  [[nodiscard]] const PlacedFeature& placed_feature(const SampleBlock& block);
  void test_block(std::uint32_t block, std::uint32_t face);
  void cross_block(std::uint32_t block, std::uint32_t edge);
  /// Where edges are looked at: as they are, and after the step with RelativeMotion::free_twist and `during`.
  enum class When : std::uint8_t { now, ahead, after };
  [[nodiscard]] BodyPair pair_at(When when);
  void cross_block(When when, const PlacedFeature& placed, const SampleBlock& block, std::uint32_t edge);
  [[nodiscard]] bool cross_segment(When when, const ExactEdge& edge, std::uint32_t count, Candidate& c);
  [[nodiscard]] bool may_cross(const Feature& feature, const Measure& a, const Measure& b, double way) const;
  [[nodiscard]] bool is_led_all_along(const PlacedFeature& placed, const SampleBlock& block, const ExactEdge& edge,
                                      double way) const;
  [[nodiscard]] double longest_way(const PlacedFeature& placed, const SampleBlock& block) const;
  void reduce_group(const PlacedFeature& placed, const CurveFromSurface& curve, std::uint32_t begin,
                    std::span<double> now, std::span<double> remaining, std::uint32_t face);
  [[nodiscard]] bool evaluate_segment(const PlacedFeature& placed, const CurveFromSurface& curve, std::uint32_t count,
                                      std::uint32_t face, Candidate& c);
  [[nodiscard]] bool is_plane(std::uint32_t face) const {
    return pair_.base.faces[face].surface->kind() == SurfaceKind::plane;
  }
  /// A direction of the mover at the end of the step without contact.
  [[nodiscard]] Vector3d turned(const Vector3d& direction) const {
    return direction + pair_.motion.dt * pair_.motion.free_twist.angular.cross(direction);
  }
  [[nodiscard]] bool is_back_facing(const SampleBlock& block, const Vector3d& normal) const;
  [[nodiscard]] double share_of_crossing(const Candidate& c, double length) const;
  [[nodiscard]] double touching_fraction(const PlacedFeature& placed, const Candidate& c, std::uint32_t count) const;
  [[nodiscard]] bool evaluate_candidate(const PlacedFeature& placed, std::uint32_t face, std::uint32_t count,
                                        Candidate& c);
  [[nodiscard]] bool is_near(const PlacedFeature& placed, std::uint32_t count, Candidate& c) const;
  [[nodiscard]] bool is_between(const PlacedFeature& placed, const Candidate& c) const;
  [[nodiscard]] bool is_passed_by(const PlacedFeature& placed, const CurveFromSurface& curve, const Candidate& c) const;
  [[nodiscard]] static double clearance_along(const PlacedFeature& placed, const Measure& here, const Candidate& c);
  [[nodiscard]] double slide(const Vector3d& p) const;
  [[nodiscard]] double slide_along(const Candidate& c) const;
  [[nodiscard]] double way_across(const PlacedFeature& placed, const Twist& twist) const;
  void add_along(const PlacedFeature& placed, const CurveFromSurface& curve, Candidate& best, std::uint32_t count,
                 std::uint32_t face);
  [[nodiscard]] bool lies_beyond(const PlacedFeature& placed, const CurveFromSurface& curve, const Candidate& best,
                                 const Measure& here, std::uint32_t count) const;
  [[nodiscard]] Candidate closest_of_group(const PlacedFeature& placed, const CurveFromSurface& curve,
                                           std::uint32_t group, std::uint32_t count) const;
  [[nodiscard]] static double part_beside(double turn, double of_one);
  [[nodiscard]] static Measure measure_at(const CurveFromSurface& curve, const Place& place);
  [[nodiscard]] std::optional<Candidate> candidate_beside(const PlacedFeature& placed, const Candidate& closest,
                                                          double turn, std::uint32_t face);
  [[nodiscard]] static bool is_bent(const Measure& here);
  bool add_beside(const PlacedFeature& placed, const CurveFromSurface& curve, const Candidate& closest, double of_one,
                  std::uint32_t count, std::uint32_t face);
  void add_conforming(const PlacedFeature& placed, const CurveFromSurface& curve, Candidate& best, std::uint32_t count,
                      std::uint32_t face);
  static void ask_beyond_the_end(const PlacedFeature& placed, const Candidate& best, std::span<double> remaining);
  /// `shares`: the group's stiffness with the closest place.
  struct GroupEnd {
    Candidate place;
    bool shares;
  };
  [[nodiscard]] std::optional<GroupEnd> group_end(const PlacedFeature& placed, const CurveFromSurface& curve,
                                                  const Candidate& best, std::span<const double> gaps_ahead, int side,
                                                  std::uint32_t face);
  [[nodiscard]] static double share_of_end(double mine, double other);
  void add_group_ends(const PlacedFeature& placed, const CurveFromSurface& curve, Candidate& best,
                      std::span<const double> gaps_ahead, std::uint32_t face);
  void add_face_row(const PlacedFeature& placed, const Candidate& c, std::uint32_t count, std::uint32_t face);
  void add_row(const PlacedFeature& placed, const Candidate& c, std::uint32_t count, std::uint32_t entity,
               double curving);

  const BodyPair pair_;
  std::optional<RelativeMotion> still_ahead_, still_after_;  ///< of pair_at(), when first asked for
  NearPairs near_;
  RowList& rows_;
  SearchCost& cost_;
  double depth_max_ = 0;
  PlacedFeature placed_{};                    ///< of the block that is tested
  FeatureAfter after_;                        ///< of its last row
  std::array<Measure, kBlockSize> measures_;  ///< of its samples, from the first one on
  std::uint32_t measures_begin_ = 0;
};

/// The feature of a block in the coordinates of the base. Blocks are tested one after the other, each against several
/// entities.
inline const PlacedFeature& Search::placed_feature(const SampleBlock& block) {
  const Feature& feature = pair_.mover.features[block.feature];
  if (placed_.feature != &feature) placed_ = placed_by(pair_.motion.now, feature);
  return placed_;
}

}  // namespace verisim::exact
