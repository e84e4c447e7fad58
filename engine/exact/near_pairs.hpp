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
        R_abs_(motion.R.cwiseAbs()),
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
    return {motion_.R * box.center + motion_.p, R_abs_ * box.half};
  }
  [[nodiscard]] bool are_near(const PlacedBox& block, const BoxTree::Node& entity) const {
    for (int i = 0; i < 3; ++i)  // most are apart along the first
      if (std::abs(block.center[i] - entity.center[i]) > block.half[i] + entity.half[i] + motion_.margin) return false;
    return true;
  }

  /// The box around all blocks, as it is, and around an entity that along the mover's axes: of a tilted mover the box
  /// along the base's axes is much larger.
  [[nodiscard]] bool is_near_mover(const BoxTree::Node& entity) const {
    const BoxTree::Node& whole = blocks_.nodes[0];
    const Vector3d center = motion_.R.transpose() * (entity.center - motion_.p);
    const Vector3d half = R_abs_.transpose() * entity.half;
    for (int i = 0; i < 3; ++i)
      if (std::abs(center[i] - whole.center[i]) > whole.half[i] + half[i] + motion_.margin) return false;
    return true;
  }

  /// Of small bodies all that is near the other as a whole is compared with each other: a tree of a dozen items has
  /// twice as many nodes, and most of them are near.
  template <typename Test>
  void compare_all(const BoxTree& entities, Test& test) {
    const PlacedBox whole = placed(blocks_.nodes[0]);
    if (!are_near(whole, entities.nodes[0])) return;
    if (!are_leaves_placed_)
      for (std::size_t i = 0; i < blocks_.leaves.size(); ++i) boxes_[i] = placed(blocks_.nodes[blocks_.leaves[i]]);
    are_leaves_placed_ = true;
    std::array<const BoxTree::Node*, kFew> near;
    std::size_t count = 0;
    for (const std::uint32_t leaf : entities.leaves)
      if (are_near(whole, entities.nodes[leaf]) && is_near_mover(entities.nodes[leaf]))
        near[count++] = &entities.nodes[leaf];
    for (std::size_t i = 0; i < blocks_.leaves.size(); ++i) {
      if (!are_near(boxes_[i], entities.nodes[0])) continue;
      for (std::size_t j = 0; j < count; ++j)
        if (are_near(boxes_[i], *near[j])) test(blocks_.nodes[blocks_.leaves[i]].left, near[j]->left);
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
  /// Those of the first nodes are placed once, when they are first met.
  [[nodiscard]] PlacedBox placed_node(std::uint32_t node) {
    if (node >= kFew) return placed(blocks_.nodes[node]);
    const std::uint64_t bit = std::uint64_t{1} << node;
    if ((is_placed_ & bit) == 0) boxes_[node] = placed(blocks_.nodes[node]);
    is_placed_ |= bit;
    return boxes_[node];
  }

  static constexpr std::size_t kFew = 64;
  const BoxTree& blocks_;
  const RelativeMotion& motion_;
  const Matrix3d R_abs_;  ///< of motion.R
  const bool are_few_;
  std::array<PlacedBox, kFew> boxes_;  ///< of the leaves, if they are few; else of the first nodes
  bool are_leaves_placed_ = false;
  std::uint64_t is_placed_ = 0;  ///< a bit for each of the first nodes
};

}  // namespace verisim::exact
