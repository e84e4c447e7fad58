#include "engine/geometry/cad/tessellation.hpp"

#include <BRep_Tool.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>

#include "engine/geometry/cad/rounding.hpp"

namespace verisim::cad {
namespace {

class Builder {
 public:
  Builder(const TopTools_IndexedMapOfShape& edges, double unit) : edges_(edges), unit_(unit) {
    result.of_edge.resize(static_cast<std::size_t>(edges.Extent()));
  }

  void add(const TopoDS_Face& face, std::uint32_t face_index) {
    TopLoc_Location location;
    const Handle(Poly_Triangulation) triangulation = BRep_Tool::Triangulation(face, location);
    if (triangulation.IsNull() || triangulation->NbTriangles() == 0) {
      ++result.faces_without_triangles;
      return;
    }
    positions_.clear();
    for (Standard_Integer i = 1; i <= triangulation->NbNodes(); ++i) {
      const gp_Pnt p = triangulation->Node(i).Transformed(location.Transformation());
      positions_.push_back(round_point(unit_ * Vector3d(p.X(), p.Y(), p.Z())));
    }
    number_.assign(positions_.size(), kUnknown);
    for (TopExp_Explorer e(face, TopAbs_EDGE); e.More(); e.Next())
      number_edge(TopoDS::Edge(e.Current()), triangulation, location);
    for (std::size_t node = 0; node < number_.size(); ++node) {
      if (number_[node] == kUnknown) number_[node] = new_vertex(node);
    }
    add_triangles(*triangulation, face.Orientation() == TopAbs_REVERSED, face_index);
  }

  Tessellation result;

 private:
  static constexpr std::uint32_t kUnknown = kNoFace;

  std::uint32_t new_vertex(std::size_t node) {
    result.mesh.vertices.push_back(positions_[node]);
    return static_cast<std::uint32_t>(result.mesh.vertices.size() - 1);
  }

  std::uint32_t corner(const TopoDS_Vertex& vertex, std::size_t node) {
    const Standard_Integer index = corners_.Add(vertex);
    if (static_cast<std::size_t>(index) > number_of_corner_.size()) number_of_corner_.push_back(new_vertex(node));
    return number_of_corner_[static_cast<std::size_t>(index) - 1];
  }

  /// Numbers the face's nodes along one of its edges: as the first face that met the edge did, or newly.
  void number_edge(const TopoDS_Edge& edge, const Handle(Poly_Triangulation) & triangulation,
                   const TopLoc_Location& location) {
    const Handle(Poly_PolygonOnTriangulation) polygon =
        BRep_Tool::PolygonOnTriangulation(edge, triangulation, location);
    const TopoDS_Vertex first = TopExp::FirstVertex(edge);
    const TopoDS_Vertex last = TopExp::LastVertex(edge);
    if (polygon.IsNull() || first.IsNull() || last.IsNull()) return;
    const Standard_Integer index = edges_.FindIndex(edge);
    std::vector<std::uint32_t> degenerate;  // an edge without length (a pole): all its nodes are one corner
    std::vector<std::uint32_t>& chain = index == 0 ? degenerate : result.of_edge[static_cast<std::size_t>(index) - 1];
    const Standard_Integer n = polygon->NbNodes();
    const bool is_new = chain.empty();
    if (!is_new && chain.size() != static_cast<std::size_t>(n))
      return;  // nodes stay the face's own; the mesh is then open
    for (Standard_Integer i = 1; i <= n; ++i) {
      const auto node = static_cast<std::size_t>(polygon->Node(i)) - 1;
      if (is_new) chain.push_back(number_of(i, n, node, index == 0, first, last));
      number_[node] = chain[static_cast<std::size_t>(i) - 1];
    }
  }

  std::uint32_t number_of(Standard_Integer i, Standard_Integer n, std::size_t node, bool is_degenerate,
                          const TopoDS_Vertex& first, const TopoDS_Vertex& last) {
    if (i == 1 || is_degenerate) return corner(first, node);
    if (i == n) return corner(last, node);
    return new_vertex(node);
  }

  void add_triangles(const Poly_Triangulation& triangulation, bool reversed, std::uint32_t face_index) {
    for (Standard_Integer t = 1; t <= triangulation.NbTriangles(); ++t) {
      Standard_Integer a = 0;
      Standard_Integer b = 0;
      Standard_Integer c = 0;
      triangulation.Triangle(t).Get(a, b, c);
      if (reversed) std::swap(b, c);
      const std::array<std::uint32_t, 3> triangle = {number(a), number(b), number(c)};
      if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0])
        continue;  // at a pole
      result.mesh.triangles.push_back(triangle);
      result.mesh.face_of_triangle.push_back(face_index);
    }
  }

  [[nodiscard]] std::uint32_t number(Standard_Integer node) const {
    return number_[static_cast<std::size_t>(node) - 1];
  }

  const TopTools_IndexedMapOfShape& edges_;
  double unit_;
  TopTools_IndexedMapOfShape corners_;
  std::vector<std::uint32_t> number_of_corner_;
  std::vector<Vector3d> positions_;    // of the present face's nodes
  std::vector<std::uint32_t> number_;  // and their vertices
};

}  // namespace

Tessellation tessellation_of(const TopTools_IndexedMapOfShape& faces, const TopTools_IndexedMapOfShape& edges,
                             double unit) {
  Builder builder(edges, unit);
  for (Standard_Integer i = 1; i <= faces.Extent(); ++i)
    builder.add(TopoDS::Face(faces(i)), static_cast<std::uint32_t>(i - 1));
  return std::move(builder.result);
}

}  // namespace verisim::cad
