// Region merging, the last stage of a segmentation. Region growing takes one surface after the other and so errs in two
// ways: it divides one surface into several, and it finds surfaces in free forms by chance.
#pragma once

#include "engine/geometry/recover/regions.hpp"

namespace verisim::recover {

/// Merges regions into a larger curved surface beside them if all their triangles are loose inliers of it; likewise
/// free triangles. A strip of a tube, for instance, passes for a cylinder before the tube is found.
void merge_regions(Regions& regions);

/// Releases regions that are patches of a free form. Strips and patches of free forms pass for cylinders and tori by
/// chance. A small region is released if most of its border goes over smoothly into free triangles or other such
/// patches, and if a free triangle is reached through them. So are many small patches that touch nothing else.
void release_freeform_patches(Regions& regions);

}  // namespace verisim::recover
