// What exact contacts call a precise surface is the project's one analytic surface, in the coordinates of its body [m].
#pragma once

#include "engine/geometry/analytic_surface.hpp"

namespace verisim::exact {

using PreciseSurface = AnalyticSurface;

}  // namespace verisim::exact
