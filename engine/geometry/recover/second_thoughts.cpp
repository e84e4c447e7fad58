#include "engine/geometry/recover/second_thoughts.hpp"

#include <algorithm>
#include <functional>
#include <numeric>

namespace verisim::recover {

namespace {

constexpr std::size_t kPatch = 200;   // triangles at most
constexpr std::size_t kCrowd = 12;    // patches side by side with nothing else around them …
constexpr std::size_t kFewEach = 30;  // … and fewer triangles than this, each

class Giving {
 public:
  explicit Giving(Regions& regions) : regions_(regions), asked_by_(regions.all.size(), kNone) {
    for (const TakenRegion& region : regions.all) areas_.push_back(regions.area_of(region.triangles));
  }

  void run() {
    std::vector<std::uint32_t> order(areas_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::stable_sort(order, std::greater<>{}, [&](std::uint32_t r) { return areas_[r]; });
    for (const std::uint32_t r : order) {
      if (regions_.all[r].fit && !regions_.all[r].triangles.empty()) give_to(r);
    }
  }

 private:
  void give_to(std::uint32_t larger) {
    const std::vector<std::uint32_t>& triangles = regions_.all[larger].triangles;  // it grows
    const Piece piece = regions_.piece_of(*regions_.all[larger].fit, triangles.front());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      for (const std::uint32_t t : regions_.mesh.neighbors[triangles[i]]) {
        if (t == kNone || regions_.region_of(t) == larger) continue;
        const std::uint32_t other = regions_.region_of(t);
        if (other == kNone) {
          if (is_small(t) && piece.is_possible(t)) regions_.add(larger, t);
        } else if (asked_by_[other] != larger && areas_[other] <= areas_[larger]) {
          asked_by_[other] = larger;
          if (fits(piece, regions_.all[other])) regions_.merge(other, larger);
        }
      }
    }
    std::ranges::sort(regions_.all[larger].triangles);
  }

  [[nodiscard]] bool is_small(std::uint32_t t) const { return regions_.is_small(regions_.facets.of_triangle[t]); }

  [[nodiscard]] bool fits(const Piece& piece, const TakenRegion& region) const {
    return std::ranges::all_of(region.triangles,
                               [&](std::uint32_t t) { return (region.fit || is_small(t)) && piece.is_possible(t); });
  }

  Regions& regions_;
  std::vector<double> areas_;
  std::vector<std::uint32_t> asked_by_;  // regions: by which larger one last
};

class Patches {
 public:
  explicit Patches(Regions& regions) : regions_(regions) {
    for (const TakenRegion& region : regions.all)
      is_patch_.push_back(region.fit && !region.triangles.empty() && region.triangles.size() <= kPatch);
  }

  void run() {
    bool changed = true;
    while (changed) {
      changed = false;
      for (std::uint32_t r = 0; r < is_patch_.size(); ++r) {
        if (!is_patch_[r] || is_among_patches(r)) continue;
        is_patch_[r] = false;
        changed = true;
      }
    }
    changed = true;  // from what is free inwards: patches that no free form reaches are surfaces
    while (changed) {
      changed = false;
      for (std::uint32_t r = 0; r < is_patch_.size(); ++r) {
        if (!is_patch_[r] || !is_beside_free(r)) continue;
        regions_.release(r);
        is_patch_[r] = false;
        changed = true;
      }
    }
    for (std::uint32_t r = 0; r < is_patch_.size(); ++r) {  // a free form that is nothing but patches
      if (is_patch_[r]) release_crowd(r);
    }
  }

 private:
  /// All patches that are joined smoothly to this one, if they are many and small; they are none any more in any case.
  void release_crowd(std::uint32_t first) {
    std::vector<std::uint32_t> joined = {first};
    std::size_t triangles = 0;
    is_patch_[first] = false;
    for (std::size_t i = 0; i < joined.size(); ++i) {
      triangles += regions_.all[joined[i]].triangles.size();
      for_each_side(joined[i], [&](std::uint32_t beside, double /*length*/, bool is_smooth) {
        if (!is_smooth || regions_.is_free(beside) || !is_patch_[regions_.region_of(beside)]) return;
        joined.push_back(regions_.region_of(beside));
        is_patch_[joined.back()] = false;
      });
    }
    if (joined.size() < kCrowd || triangles >= kFewEach * joined.size()) return;
    for (const std::uint32_t r : joined) regions_.release(r);
  }

  /// Calls `visit(triangle beside or kNone, length of the side, is it smooth)` around a region.
  template <typename Visit>
  void for_each_side(std::uint32_t region, Visit visit) const {
    for (const std::uint32_t t : regions_.all[region].triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t beside = regions_.mesh.neighbors[t][i];
        if (beside != kNone && regions_.region_of(beside) == region) continue;
        const double length = (regions_.mesh.corner(t, (i + 1) % 3) - regions_.mesh.corner(t, i)).norm();
        visit(beside, length, beside != kNone && regions_.is_smooth(t, beside));
      }
    }
  }

  [[nodiscard]] bool is_among_patches(std::uint32_t region) const {
    double smooth = 0, whole = 0;
    for_each_side(region, [&](std::uint32_t beside, double length, bool is_smooth) {
      if (beside != kNone) whole += length;  // an open end says nothing
      if (is_smooth && (regions_.is_free(beside) || is_patch_[regions_.region_of(beside)])) smooth += length;
    });
    return smooth > regions_.thresholds.mostly_smooth * whole;
  }

  [[nodiscard]] bool is_beside_free(std::uint32_t region) const {
    bool found = false;
    for_each_side(region, [&](std::uint32_t beside, double /*length*/, bool is_smooth) {
      found |= is_smooth && regions_.is_free(beside);
    });
    return found;
  }

  Regions& regions_;
  std::vector<bool> is_patch_;  // regions that may be
};

}  // namespace

void give_to_larger(Regions& regions) {
  Giving(regions).run();
}

void release_patches(Regions& regions) {
  Patches(regions).run();
}

}  // namespace verisim::recover
