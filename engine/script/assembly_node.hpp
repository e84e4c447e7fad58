// The tree that a script builds below addObject (models, solids and placements of them), and its conversion into the
// parts of one body.
//
// Body coordinates. Scales are baked into the geometry. If all leaves of a child have one placement (the usual
// Transform{…, Model "f.step"}), that placement belongs to the start pose and the body's coordinates are those of the
// model file, scaled. Leaves with different placements are baked into the coordinates of the child's outermost group.
#pragma once

#include <memory>
#include <string>
#include <unordered_set>
#include <vector>

#include "engine/geometry/loader.hpp"
#include "engine/simulation/inputs.hpp"

namespace verisim::script {

struct Node {
  enum class Kind { model, solid, group };
  Kind kind = Kind::group;
  // model
  std::string file;       ///< as Inputs knows it
  int part = 0;           ///< 1 … n: this solid of the file alone; 0: all
  double file_scale = 1;  ///< Model{ scale= }
  bool recover = false;   ///< Model{ brep= }: faces and edges of a mesh file from its triangles
  // solid
  std::shared_ptr<const Solid> solid;
  int pieces = 1;  ///< primitives and operations of `solid`, repeated ones counted each time
  // group: similarity x -> pose * (scale x)
  double scale = 1;
  Pose pose;
  std::vector<std::shared_ptr<Node>> children;

  Node() = default;
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;
  ~Node();  ///< iterative: a chain of a million groups must not overflow the stack
};

/// True if `node` is `top` or somewhere below it. Calls `visit` once for each group that is searched.
template <typename Visit>
[[nodiscard]] bool hangs_below(const Node& top, const Node& node, Visit visit) {
  std::vector<const Node*> waiting = {&top};
  std::unordered_set<const Node*> seen;
  while (!waiting.empty()) {
    const Node* here = waiting.back();
    waiting.pop_back();
    if (here == &node) return true;
    if (!seen.insert(here).second) continue;
    visit();
    for (const auto& child : here->children) waiting.push_back(child.get());
  }
  return false;
}

struct PlacedParts {
  Pose pose;                ///< of the body's coordinates in those of the child
  std::vector<Part> parts;  ///< in body coordinates
  std::string stem;         ///< file name without folder and extension of the first model; empty for solids
};

/// Limits: a script can nest and reuse nodes so that few of them stand for very many.
inline constexpr int kSolidPiecesMax = 1000;
inline constexpr int kNodesMax = 10'000;
inline constexpr int kNodeDepthMax = 100;

/// Loads the leaves below `nodes`. Error(input): more or deeper nested nodes than the limits above; from loading;
/// nothing in it; a part number that the file does not have; scales and positions that lead beyond all numbers.
/// @pre no node is null
[[nodiscard]] PlacedParts resolve(const std::vector<std::shared_ptr<Node>>& nodes, Inputs& inputs);

/// The parts of a model file, with the meaning of scale and recover that LoadOptions has. @pre scale is above 0
[[nodiscard]] const std::vector<Part>& load_file(Inputs& inputs, const std::string& file, double scale, bool recover);

/// A part in other coordinates: every point p becomes X * p. Area, volume and trimmed bounds do not change.
/// @pre X is finite, its rotation unit
[[nodiscard]] Part placed(const Part& part, const Pose& X);

/// The solid with all lengths times `scale`. @pre there is one, and so its children; scale is above 0
[[nodiscard]] std::shared_ptr<const Solid> scaled(const std::shared_ptr<const Solid>& solid, double scale);

}  // namespace verisim::script
