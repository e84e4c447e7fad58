// Makes what contacts need of a body: voxels, entities, precise surfaces, triangles' tree. A scene pays for it when
// another body first comes near (DESIGN rule 2), between frames.
#pragma once

#include <utility>
#include <vector>

#include "engine/record/prepared_store.hpp"
#include "engine/simulation/world.hpp"

namespace verisim {

/// Will precise surfaces be made of it, under this method?
[[nodiscard]] bool will_be_exact(const BodyDescription& body, Hybrid method);

class BodyMaker {
 public:
  /// `threads`: same bits for any number. `store`: of what was prepared before, or null; same bits.
  BodyMaker(std::vector<BodyDescription> bodies, unsigned threads, std::shared_ptr<PreparedStore> store)
      : bodies_(std::move(bodies)), threads_(threads), store_(std::move(store)) {}

  /// Error(input), with body and reason, for a voxel size that voxelization would refuse, of every body that can meet
  /// another: before the first frame, not in the middle of a run.
  void check(const World& world) const;
  /// check(), and makes the bodies that a button may take: a hand takes the nearest, to half a voxel.
  void begin(World& world);
  /// Once; a second call does nothing. Error(input) with body and reason.
  void make(World& world, std::size_t body);
  /// Pairs that can meet as far as the devices' travel tells, ascending.
  [[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> pairs_that_can_meet(const World& world) const;

 private:
  void voxelize_body(const World& world, const BodyDescription& description, Body& body) const;
  [[nodiscard]] VoxelBody voxels_of(const BodyDescription& description, const Part& part, bool with_entities) const;
  [[nodiscard]] std::shared_ptr<const exact::ExactBody> exact_body_of(const World& world,
                                                                      const BodyDescription& description) const;

  std::vector<BodyDescription> bodies_;  ///< emptied as they are made
  unsigned threads_;
  std::shared_ptr<PreparedStore> store_;
};

}  // namespace verisim
