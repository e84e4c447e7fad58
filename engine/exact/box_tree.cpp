#include "engine/exact/box_tree.hpp"

#include <algorithm>
#include <numeric>

namespace verisim::exact {
namespace {

struct Builder {
  std::span<const Bounds> items;
  std::vector<BoxTree::Node>& nodes;

  /// Builds the subtree of `numbers` and returns its root.
  std::uint32_t build(std::span<std::uint32_t> numbers) {
    Bounds all;
    for (const std::uint32_t i : numbers) {
      all.include(items[i].min);
      all.include(items[i].max);
    }
    const auto root = static_cast<std::uint32_t>(nodes.size());
    nodes.push_back({all.center(), 0.5 * all.size(), numbers.front(), BoxTree::kLeaf});
    if (numbers.size() == 1) return root;
    int axis = 0;
    all.size().maxCoeff(&axis);
    std::sort(numbers.begin(), numbers.end(), [&](std::uint32_t i, std::uint32_t j) {
      const double a = items[i].min[axis] + items[i].max[axis];
      const double b = items[j].min[axis] + items[j].max[axis];
      return a != b ? a < b : i < j;
    });
    const std::uint32_t left = build(numbers.first(numbers.size() / 2));
    const std::uint32_t right = build(numbers.subspan(numbers.size() / 2));
    nodes[root].left = left;
    nodes[root].right = right;
    return root;
  }
};

}  // namespace

BoxTree::BoxTree(std::span<const Bounds> items) {
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t i = 0; i < items.size(); ++i) {
    if ((items[i].min.array() <= items[i].max.array()).all()) numbers.push_back(i);
  }
  if (!numbers.empty()) Builder{items, nodes}.build(numbers);
  for (std::uint32_t i = 0; i < nodes.size(); ++i)
    if (nodes[i].right == kLeaf) leaves.push_back(i);
  std::sort(leaves.begin(), leaves.end(),
            [&](std::uint32_t i, std::uint32_t j) { return nodes[i].left < nodes[j].left; });
}

}  // namespace verisim::exact
