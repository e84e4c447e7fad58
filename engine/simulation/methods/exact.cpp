// `exact`: contacts between precisely known faces come from those faces, and one convex problem per island of bodies
// answers them (stages/exact_response). Contacts at other faces stay the voxels'. A pair of which one body has no
// precise surface is restored.
#include "engine/simulation/hybrid_method.hpp"
#include "engine/simulation/world.hpp"
#include "engine/voxel/association.hpp"

namespace verisim {
namespace {

bool all_faces_known(const Body& body) {
  return body.surface.is_whole() && body.exact->precise_face_count == body.exact->faces.size();
}

/// Set by set: is there a precise surface for every face in it, and at least one face?
std::vector<bool> precisely_known(const BodyFeatures& features) {
  std::vector<bool> known;
  for (std::size_t id = 0; id < features.sets.size(); ++id) {
    bool any = false;
    bool all = true;
    for (const EntityNumber entity : features.sets[static_cast<FeatureSetId>(id)]) {
      if (!features.is_face(entity)) continue;
      any = true;
      all = all && !std::holds_alternative<OtherSurface>(features.face(entity).surface);
    }
    known.push_back(any && all);
  }
  return known;
}

class ExactPair final : public PairMethod {
 public:
  explicit ExactPair(const Pair& pair)
      : map_(*pair.map().voxels),
        points_(*pair.points().voxels),
        link_(pair.first.exact, pair.second.exact),
        needs_voxels_(!all_faces_known(pair.first) || !all_faces_known(pair.second)),
        map_known_(precisely_known(map_.features)),
        points_known_(precisely_known(points_.features)) {}

  [[nodiscard]] bool needs_voxels() const override { return needs_voxels_; }
  void take_over(ContactList& contacts) const override {
    contacts.keep_if([&](std::uint32_t i) {
      return !map_known_[feature_at(map_, contacts.slot[i])] ||
             !points_known_[feature_of_point(points_.shell, contacts.point[i])];
    });
  }
  [[nodiscard]] exact::ExactLink* precise() override { return &link_; }

 private:
  const VoxelBody& map_;
  const VoxelBody& points_;
  exact::ExactLink link_;
  bool needs_voxels_;
  std::vector<bool> map_known_, points_known_;  ///< by set id
};

class Exact final : public HybridMethod {
 public:
  constexpr Exact() : HybridMethod("exact", 30) {}
  [[nodiscard]] bool needs_precise_surfaces() const override { return true; }
  [[nodiscard]] std::unique_ptr<PairMethod> make(const Pair& pair) const override {
    if (!pair.first.exact || !pair.second.exact) return hybrid::restore->make(pair);
    return std::make_unique<ExactPair>(pair);
  }
};

constinit const Exact kExact;

}  // namespace

constinit const Hybrid hybrid::exact = &kExact;

}  // namespace verisim
