// What a scene will need (DESIGN rule 2): which of its bodies are prepared for contact, when, why, and what that takes.
// From boxes, triangles and how far devices travel; nothing is prepared for it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/simulation/scene.hpp"

namespace verisim {

struct BodyPlan {
  /// start: before the first frame. near: between frames, once another body comes near. never: nothing can come near.
  enum class Prepared { start, near, never };
  std::string name;
  bool can_move = false;
  std::string_view method;  ///< hybrid method asked for
  double mass = 0;          ///< kg
  double voxel_size = 0;    ///< m
  std::size_t triangles = 0, faces = 0;
  Prepared prepared = Prepared::never;
  std::string why;                 ///< of `prepared`
  bool entities = false;           ///< voxels will know faces and edges
  bool exact = false;              ///< precise surfaces will be made
  double voxel_bytes = 0;          ///< of voxels, estimated to 20 %; 0 where none are made
  std::vector<std::size_t> meets;  ///< bodies that it can meet, ascending
};

struct ScenePlan {
  std::vector<BodyPlan> bodies;                            ///< as in the scene
  std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< that can meet, ascending
  std::string_view method;                                 ///< of bodies that name none
  Integrator integrator = Integrator::semi_implicit;
};

/// Error(input) as Simulation's constructor has it, for a voxel size too.
[[nodiscard]] ScenePlan plan_of(const Scene& scene);

}  // namespace verisim
