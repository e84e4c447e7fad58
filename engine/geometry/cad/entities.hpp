// One face or edge of the kernel as an entity of ours.
#pragma once

#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>

#include "engine/geometry/entity.hpp"

namespace verisim::cad {

/// Surface, trimmed bounds and area; `edges` stays empty. @param unit  metres per kernel length
[[nodiscard]] Face face_from(const TopoDS_Face& face, double unit);

/// Curve, trimmed bounds and length; `polyline` and `faces` stay empty.
[[nodiscard]] Edge edge_from(const TopoDS_Edge& edge, double unit);

}  // namespace verisim::cad
