// What a search that takes one surface after the other gets wrong, put right at its end.
#pragma once

#include "engine/geometry/recover/regions.hpp"

namespace verisim::recover {

/// A strip of a tube can pass for a cylinder before the tube is found: a region whose triangles all can be pieces of a
/// larger round surface beside it goes to that, free ones likewise.
void give_to_larger(Regions& regions);

/// Of a free form strips and patches pass for cylinders and tori by chance. They are freed: small ones that go over
/// smoothly, around most of their border, into what is free or such a patch again; so are many that touch nothing else.
void release_patches(Regions& regions);

}  // namespace verisim::recover
