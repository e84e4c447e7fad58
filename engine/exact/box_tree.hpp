// A static tree of boxes over numbered items, for finding which items of one body can be near which of another. Body
// coordinates. Splits at the median along the longest side: same items, same tree.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/geometry/mesh.hpp"

namespace verisim::exact {

struct BoxTree {
  struct Node {
    Vector3d center, half;      ///< m
    std::uint32_t left, right;  ///< children; leaf: left = number of the item, right = kLeaf
  };
  static constexpr std::uint32_t kLeaf = 0xFFFFFFFF;
  std::vector<Node> nodes;            ///< the root first; empty: no items
  std::vector<std::uint32_t> leaves;  ///< numbers of the nodes that are leaves, by the number of their item

  BoxTree() = default;
  explicit BoxTree(std::span<const Bounds> items);
};

}  // namespace verisim::exact
