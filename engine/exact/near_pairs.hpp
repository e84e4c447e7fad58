// Which blocks of the mover may be near which entities of the base: boxes against boxes, in the coordinates of the base
// [m]. A box of the mover is replaced by the one along the base's axes around it. Private to this folder.
#pragma once

#include <algorithm>
#include <array>

#include "engine/exact/search.hpp"

namespace verisim::exact {

class NearPairs {
 public:
  /// All are kept by reference.
  NearPairs(const ExactBody& mover, const ExactBody& base, const RelativeMotion& motion)
      : blocks_(mover.block_tree),
        motion_(motion),
        R_abs_(motion.now.R.cwiseAbs()),
        are_few_(std::max({mover.block_tree.leaves.size(), base.face_tree.leaves.size(),
                           base.edge_tree.leaves.size()}) <= kFew) {}

  /// Calls test(block, entity) for all blocks that may be within the margin of an entity. The order depends on the
  /// bodies alone, not on their poses. @param entities  face_tree or edge_tree of the base
  template <typename Test>
  void find(const BoxTree& entities, NodePairs& stack, Test&& test) {
    if (blocks_.nodes.empty() || entities.nodes.empty()) return;
    if (are_few_) {
      compare_all(entities, test);
    } else {
      descend(entities, stack, test);
    }
  }

 private:
  struct PlacedBox {
    Vector3d center, half;
  };

  [[nodiscard]] PlacedBox placed(const BoxTree::Node& box) const {
    return {motion_.now.R * box.center + motion_.now.p, R_abs_ * box.half};
  }
  [[nodiscard]] bool are_near(const PlacedBox& block, const BoxTree::Node& entity) const {
    for (int i = 0; i < 3; ++i)  // most are apart along the first
      if (std::abs(block.center[i] - entity.center[i]) > block.half[i] + entity.half[i] + motion_.margin) return false;
    return true;
  }

  /// The box along the mover's axes around one of the base, mover's coordinates: of a tilted mover the box along the
  /// base's axes is much larger than its own.
  [[nodiscard]] PlacedBox seen_from_mover(const BoxTree::Node& box) const {
    return {motion_.now.R.transpose() * (box.center - motion_.now.p), R_abs_.transpose() * box.half};
  }

  /// Of small bodies all that is near the other as a whole is compared with each other: a tree of a dozen items has
  /// twice as many nodes, and most of them are near.
  template <typename Test>
  void compare_all(const BoxTree& entities, Test& test) {
    const PlacedBox whole = placed(blocks_.nodes[0]);
    if (!are_near(whole, entities.nodes[0])) return;
    const PlacedBox base = seen_from_mover(entities.nodes[0]);
    std::array<const BoxTree::Node*, kFew> near;
    std::size_t count = 0;
    for (const std::uint32_t leaf : entities.leaves)
      if (are_near(whole, entities.nodes[leaf]) && are_near(seen_from_mover(entities.nodes[leaf]), blocks_.nodes[0]))
        near[count++] = &entities.nodes[leaf];
    for (std::size_t i = 0; i < blocks_.leaves.size() && count > 0; ++i) {
      const BoxTree::Node& leaf = blocks_.nodes[blocks_.leaves[i]];
      if (!are_near(base, leaf)) continue;
      const PlacedBox& block = placed_once(i, leaf);
      if (!are_near(block, entities.nodes[0])) continue;
      for (std::size_t j = 0; j < count; ++j)
        if (are_near(block, *near[j])) test(leaf.left, near[j]->left);
    }
  }

  template <typename Test>
  void descend(const BoxTree& tree, NodePairs& stack, Test& test) {
    stack.clear();
    const auto visit = [&](std::uint32_t b, std::uint32_t e) {
      if (are_near(placed_node(b), tree.nodes[e])) stack.emplace_back(b, e);
    };
    visit(0, 0);
    while (!stack.empty()) {
      const auto [b, e] = stack.back();
      stack.pop_back();
      const BoxTree::Node& block = blocks_.nodes[b];
      const BoxTree::Node& entity = tree.nodes[e];
      const bool block_is_leaf = block.right == BoxTree::kLeaf;
      const bool entity_is_leaf = entity.right == BoxTree::kLeaf;
      if (block_is_leaf && entity_is_leaf) {
        test(block.left, entity.left);
      } else if (entity_is_leaf || (!block_is_leaf && block.half.squaredNorm() > entity.half.squaredNorm())) {
        visit(block.right, e);
        visit(block.left, e);
      } else {
        visit(b, entity.right);
        visit(b, entity.left);
      }
    }
  }
  [[nodiscard]] PlacedBox placed_node(std::uint32_t node) {
    return node < kFew ? placed_once(node, blocks_.nodes[node]) : placed(blocks_.nodes[node]);
  }
  /// Boxes that are asked for again are placed when they first are.
  [[nodiscard]] const PlacedBox& placed_once(std::size_t slot, const BoxTree::Node& box) {
    const std::uint64_t bit = std::uint64_t{1} << slot;
    if ((is_placed_ & bit) == 0) boxes_[slot] = placed(box);
    is_placed_ |= bit;
    return boxes_[slot];
  }

  static constexpr std::size_t kFew = 64;
  const BoxTree& blocks_;
  const RelativeMotion& motion_;
  const Matrix3d R_abs_;  ///< of motion.now.R
  const bool are_few_;
  std::array<PlacedBox, kFew> boxes_;  ///< of the leaves, if they are few; else of the first nodes
  std::uint64_t is_placed_ = 0;        ///< a bit for each of these
};

}  // namespace verisim::exact
