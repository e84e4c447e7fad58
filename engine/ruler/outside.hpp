// What lies outside of a solid, near a place, as a union of cells: each the common part of sides of dividers. A point
// of the solid is as deep as the nearest cell is far, and a cell of planes and of the insides of round surfaces is
// convex, so that the distance to it is a convex function of the point. Private to this folder.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/ruler/csg.hpp"

namespace verisim::ruler {

/// On which sides of the dividers near the place (bits) a point has to be.
struct Cell {
  std::uint64_t below = 0, above = 0;
  [[nodiscard]] bool is_within(const Cell& other) const {
    return (other.below & ~below) == 0 && (other.above & ~above) == 0;
  }
};

class OutsideCells {
 public:
  explicit OutsideCells(const Csg& solid) : solid_(solid) {}

  /// @param sides of the dividers near the place: 0, both are. Of cells beyond the capacity, and where more than 64
  /// dividers are near, some are left out: what is there can only be farther.
  void find(std::span<const std::int8_t> sides) {
    cells_.clear();
    dividers_.clear();
    bits_.assign(sides.size(), 0);
    for (std::uint32_t i = 0; i < sides.size(); ++i) {
      if (sides[i] != 0) continue;
      if (dividers_.size() == 64) return;
      bits_[i] = static_cast<std::uint8_t>(dividers_.size());
      dividers_.push_back(i);
    }
    const auto& nodes = solid_.nodes();
    sides_.resize(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) sides_[i] = side_of(nodes[i], sides);
    expand(static_cast<std::uint32_t>(nodes.size() - 1), true, cells_);
  }
  [[nodiscard]] std::span<const Cell> cells() const { return cells_; }

  /// For each divider that bounds the cell: `act(divider, sign)`; the cell is where sign * value <= 0.
  template <typename Act>
  void each(const Cell& cell, const Act& act) const {
    for (std::uint64_t rest = cell.below; rest != 0; rest &= rest - 1) act(dividers_[low(rest)], 1.0);
    for (std::uint64_t rest = cell.above; rest != 0; rest &= rest - 1) act(dividers_[low(rest)], -1.0);
  }

 private:
  using Operation = Csg::Operation;
  static constexpr std::size_t kCellsMax = 64;

  static std::size_t low(std::uint64_t bits) { return static_cast<std::size_t>(std::countr_zero(bits)); }
  std::int8_t side_of(const Csg::Node& node, std::span<const std::int8_t> sides) const {
    switch (node.operation) {
      case Operation::divider:
        return sides[node.first];
      case Operation::complement:
        return static_cast<std::int8_t>(-sides_[node.first]);
      case Operation::least:
        return std::min(sides_[node.first], sides_[node.second]);
      case Operation::greatest:
        break;
    }
    return std::max(sides_[node.first], sides_[node.second]);
  }

  /// Adds a cell unless another one holds all of it.
  static void add(const Cell& cell, std::vector<Cell>& cells) {
    if ((cell.below & cell.above) != 0 || cells.size() >= kCellsMax) return;
    for (const Cell& other : cells)
      if (cell.is_within(other)) return;
    std::erase_if(cells, [&](const Cell& other) { return other.is_within(cell); });
    cells.push_back(cell);
  }
  /// The cells in which the node's value is above 0, or below.
  void expand(std::uint32_t index, bool above, std::vector<Cell>& cells) const {
    const Csg::Node& node = solid_.nodes()[index];
    if (sides_[index] != 0) {
      if ((sides_[index] > 0) == above) add({}, cells);
      return;
    }
    if (node.operation == Operation::divider) {
      const std::uint64_t bit = std::uint64_t{1} << bits_[node.first];
      add(above ? Cell{0, bit} : Cell{bit, 0}, cells);
      return;
    }
    if (node.operation == Operation::complement) return expand(node.first, !above, cells);
    if ((node.operation == Operation::greatest) == above) {  // either will do
      expand(node.first, above, cells);
      expand(node.second, above, cells);
      return;
    }
    std::vector<Cell> first, second;
    expand(node.first, above, first);
    expand(node.second, above, second);
    for (const Cell& a : first)
      for (const Cell& b : second) add({a.below | b.below, a.above | b.above}, cells);
  }

  const Csg& solid_;
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> dividers_;
  std::vector<std::uint8_t> bits_;  ///< of dividers that are near
  std::vector<std::int8_t> sides_;  ///< of nodes
};

}  // namespace verisim::ruler
