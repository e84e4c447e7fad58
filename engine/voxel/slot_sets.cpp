#include "engine/voxel/slot_sets.hpp"

#include <algorithm>

#include "engine/base/error.hpp"
#include "engine/voxel/brick_mask.hpp"
#include "engine/voxel/parallel.hpp"

namespace verisim {
namespace {

/// A stored brick with the blocks of the 27 around it: the slot of any cell from -1 to 8.
class Neighbourhood {
 public:
  Neighbourhood(const Voxmap& map, std::size_t brick) {
    const auto nx = static_cast<std::ptrdiff_t>(map.bricks.x()), ny = static_cast<std::ptrdiff_t>(map.bricks.y());
    const std::ptrdiff_t count = nx * ny * map.bricks.z();
    std::size_t i = 0;
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x, ++i) {
          // The grid's border is outside, so no cell inside has neighbours beyond it; what is read there is not used.
          const std::ptrdiff_t there = static_cast<std::ptrdiff_t>(brick) + (z * ny + y) * nx + x;
          blocks_[i] = there < 0 || there >= count ? kOutsideBlock : map.brick_block[static_cast<std::size_t>(there)];
        }
  }
  [[nodiscard]] std::size_t slot(int x, int y, int z) const {
    if (((x | y | z) & ~7) == 0)
      return std::size_t{blocks_[13]} * kBrickCells + static_cast<std::size_t>(x + 8 * y + 64 * z);
    const int brick = ((z + 8) >> 3) * 9 + ((y + 8) >> 3) * 3 + ((x + 8) >> 3);
    return std::size_t{blocks_[static_cast<std::size_t>(brick)]} * kBrickCells +
           static_cast<std::size_t>((x & 7) + 8 * (y & 7) + 64 * (z & 7));
  }

 private:
  std::array<std::uint32_t, 27> blocks_;
};

struct Step {
  int x, y, z;
};

/// The 26 neighbours: by face, then by edge, then by corner; each group in the order of z, y, x.
constexpr std::array<std::size_t, 4> kClassEnd = {0, 6, 18, 26};
std::array<Step, 26> nearest_first() {
  std::array<Step, 26> steps{};
  std::size_t n = 0;
  for (int away = 1; away <= 3; ++away)
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x)
          if (x * x + y * y + z * z == away) steps[n++] = {x, y, z};
  return steps;
}

/// Each layer inherits from the one before, which is complete.
class Inheritance {
 public:
  Inheritance(const Voxmap& map, const FeatureSets& sets, std::vector<FeatureSetId>& of_slot)
      : map_(map), sets_(sets), of_slot_(of_slot) {}

  void inherit(std::size_t brick, Layer layer) {
    const Layer* const cells = map_.layers.data() + std::size_t{map_.brick_block[brick]} * kBrickCells;
    if (std::find(cells, cells + kBrickCells, layer) == cells + kBrickCells) return;
    const Neighbourhood around(map_, brick);
    for (int i = 0; i < kBrickCells; ++i)
      if (cells[i] == layer)
        of_slot_[around.slot(i % 8, i / 8 % 8, i / 64)] = inherited(around, {i % 8, i / 8 % 8, i / 64}, layer + 1);
  }

 private:
  [[nodiscard]] FeatureSetId inherited(const Neighbourhood& around, const Step& cell, int before) const {
    constexpr std::size_t kNowhere = static_cast<std::size_t>(-1);
    std::size_t next = 0, first = kNowhere;
    bool agree = true;
    for (std::size_t c = 1; c < kClassEnd.size() && first == kNowhere; ++c)
      for (; next < kClassEnd[c]; ++next) {
        const std::size_t slot = slot_of(around, cell, kSteps[next]);
        if (map_.layers[slot] != before) continue;
        if (first == kNowhere) first = slot;
        agree = agree && of_slot_[slot] == of_slot_[first];
      }
    if (first == kNowhere) return 0;
    return agree ? of_slot_[first] : largest_around(around, cell, before);
  }

  [[nodiscard]] FeatureSetId largest_around(const Neighbourhood& around, const Step& cell, int before) const {
    FeatureSetId largest = 0;
    for (const Step& step : kSteps) {
      const std::size_t slot = slot_of(around, cell, step);
      if (map_.layers[slot] == before && sets_[of_slot_[slot]].size() > sets_[largest].size()) largest = of_slot_[slot];
    }
    return largest;
  }

  [[nodiscard]] static std::size_t slot_of(const Neighbourhood& around, const Step& cell, const Step& step) {
    return around.slot(cell.x + step.x, cell.y + step.y, cell.z + step.z);
  }

  inline static const std::array<Step, 26> kSteps = nearest_first();
  const Voxmap& map_;
  const FeatureSets& sets_;
  std::vector<FeatureSetId>& of_slot_;
};

}  // namespace

std::vector<FeatureSetId> sets_by_slot(const Voxmap& map, const std::vector<FeatureSetId>& of_voxel,
                                       const FeatureSets& sets, unsigned threads) {
  VERISIM_ASSERT(of_voxel.size() == map.surface_count);
  VERISIM_ASSERT(std::ranges::all_of(of_voxel, [&](FeatureSetId id) { return id < sets.size(); }));
  std::vector<FeatureSetId> of_slot(map.layers.size(), 0);
  std::vector<std::size_t> stored;  // bricks
  for (std::size_t brick = 0; brick < map.brick_block.size(); ++brick)
    if (map.brick_block[brick] > kInsideBlock) stored.push_back(brick);
  for (const std::size_t brick : stored) {
    const std::uint32_t block = map.brick_block[brick];
    std::uint32_t number = map.first_surface[block][0];
    for_each_cell(map.surface_mask[block], [&](int x, int y, int z) {
      of_slot[std::size_t{block} * kBrickCells + static_cast<std::size_t>(x + 8 * y + 64 * z)] = of_voxel[number++];
    });
  }
  Inheritance inheritance(map, sets, of_slot);
  for (int depth = 1; depth <= kInheritedLayers; ++depth)
    for_each_chunk(stored.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) inheritance.inherit(stored[i], static_cast<Layer>(-depth));
    });
  return of_slot;
}

}  // namespace verisim
