#include "engine/geometry/recover/region_merging.hpp"

#include <algorithm>
#include <functional>
#include <numeric>

namespace verisim::recover {

namespace {

class RegionMerger {
 public:
  explicit RegionMerger(Regions& regions) : regions_(regions), last_tested_by_(regions.all.size(), kNone) {
    for (const FoundRegion& region : regions.all) areas_.push_back(regions.area_of(region.triangles));
  }

  void run() {
    std::vector<std::uint32_t> order(areas_.size());
    std::iota(order.begin(), order.end(), 0U);
    std::ranges::stable_sort(order, std::greater<>{}, [&](std::uint32_t r) { return areas_[r]; });
    for (const std::uint32_t r : order) {
      if (regions_.all[r].fit && !regions_.all[r].triangles.empty()) absorb_neighbors(r);
    }
  }

 private:
  void absorb_neighbors(std::uint32_t larger) {
    const std::vector<std::uint32_t>& triangles = regions_.all[larger].triangles;  // grows within the loop
    const InlierTest inliers = regions_.inlier_test(*regions_.all[larger].fit, triangles.front());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      for (const std::uint32_t t : regions_.mesh.neighbors[triangles[i]]) {
        if (t == kNone || regions_.region_of(t) == larger) continue;
        const std::uint32_t other = regions_.region_of(t);
        if (other == kNone) {
          if (is_small(t) && inliers.is_loose_inlier(t)) regions_.assign(larger, t);
        } else if (last_tested_by_[other] != larger && areas_[other] <= areas_[larger]) {
          last_tested_by_[other] = larger;
          if (fits(inliers, regions_.all[other])) regions_.merge(other, larger);
        }
      }
    }
    std::ranges::sort(regions_.all[larger].triangles);
  }

  [[nodiscard]] bool is_small(std::uint32_t t) const { return regions_.is_small(regions_.facets.of_triangle[t]); }

  [[nodiscard]] bool fits(const InlierTest& inliers, const FoundRegion& region) const {
    return std::ranges::all_of(
        region.triangles, [&](std::uint32_t t) { return (region.fit || is_small(t)) && inliers.is_loose_inlier(t); });
  }

  Regions& regions_;
  std::vector<double> areas_;
  std::vector<std::uint32_t> last_tested_by_;  // per region: the larger one that tested it last
};

class FreeformPatches {
 public:
  explicit FreeformPatches(Regions& regions) : regions_(regions) {
    for (const FoundRegion& region : regions.all)
      is_patch_.push_back(region.fit && !region.triangles.empty() &&
                          region.triangles.size() <= regions.thresholds.patch_triangles_max);
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
    changed = true;  // from free triangles inwards: patches that no free form reaches are surfaces
    while (changed) {
      changed = false;
      for (std::uint32_t r = 0; r < is_patch_.size(); ++r) {
        if (!is_patch_[r] || !is_beside_free(r)) continue;
        regions_.release(r);
        is_patch_[r] = false;
        changed = true;
      }
    }
    for (std::uint32_t r = 0; r < is_patch_.size(); ++r) {  // a free form that consists of patches alone
      if (is_patch_[r]) release_cluster(r);
    }
  }

 private:
  /// Releases the cluster of patches that are joined smoothly to this one, if they are many and small. Clears their
  /// marks in any case.
  void release_cluster(std::uint32_t first) {
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
    if (joined.size() < regions_.thresholds.cluster_min ||
        triangles >= regions_.thresholds.triangles_each_max * joined.size())
      return;
    for (const std::uint32_t r : joined) regions_.release(r);
  }

  /// Calls visit(triangle beside or kNone, length of the side [m], is it smooth) for every side of a region's border.
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
      if (beside != kNone) whole += length;  // open borders do not count
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
  std::vector<bool> is_patch_;  // per region
};

}  // namespace

void merge_regions(Regions& regions) {
  RegionMerger(regions).run();
}

void release_freeform_patches(Regions& regions) {
  FreeformPatches(regions).run();
}

}  // namespace verisim::recover
