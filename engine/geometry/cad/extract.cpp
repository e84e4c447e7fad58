// A shape of the kernel as a part.
#include <BRepBndLib.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <ShapeFix_Shape.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>

#include "engine/geometry/cad/entities.hpp"
#include "engine/geometry/cad/rounding.hpp"
#include "engine/geometry/cad/shapes.hpp"
#include "engine/geometry/cad/tessellation.hpp"

namespace verisim::cad {
namespace {

/// The shape with what the kernel can heal healed; notes say what was done.
TopoDS_Shape sound(const TopoDS_Shape& shape, std::vector<std::string>& notes) {
  TopoDS_Shape sound = shape;
  if (!BRepCheck_Analyzer(shape).IsValid()) {
    ShapeFix_Shape fix(shape);
    fix.Perform();
    const bool healed = BRepCheck_Analyzer(fix.Shape()).IsValid();
    notes.emplace_back(healed ? "the file's geometry failed the CAD kernel's check and was healed"
                              : "the file's geometry fails the CAD kernel's check and could not be healed");
    if (healed) sound = fix.Shape();
  }
  GProp_GProps properties;
  BRepGProp::VolumeProperties(sound, properties);
  if (properties.Mass() < 0) {
    sound.Reverse();
    notes.emplace_back("the file's solid was inside out and was turned");
  }
  return sound;
}

MassProperties mass_of(const TopoDS_Shape& shape, double unit) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties);
  MassProperties mass;
  const double volume_unit = unit * unit * unit;
  mass.volume = round_number(volume_unit * properties.Mass());
  const gp_Pnt c = properties.CentreOfMass();
  mass.centroid = round_point(unit * Vector3d(c.X(), c.Y(), c.Z()));
  const gp_Mat inertia = properties.MatrixOfInertia();
  // Products that vanish by symmetry come out as noise of the integration: all are rounded on one scale.
  const double scale =
      std::exp2(std::ceil(std::log2(inertia.Value(1, 1) + inertia.Value(2, 2) + inertia.Value(3, 3))) - 40);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double multiple = std::nearbyint(inertia.Value(i + 1, j + 1) / scale);
      mass.inertia(i, j) = multiple * scale * (volume_unit * unit * unit) + 0.0;
    }
  }
  return mass;
}

void tessellate(const TopoDS_Shape& shape, double unit, const Options& options) {
  double deflection = options.deflection / unit;
  if (options.deflection == 0) {
    Bnd_Box box;
    BRepBndLib::AddOptimal(shape, box, /*useTriangulation=*/Standard_False, /*useShapeTolerance=*/Standard_False);
    deflection = std::sqrt(box.SquareExtent()) / 2000;
  }
  BRepTools::Clean(shape);  // a BREP file may bring triangles of another deflection
  BRepMesh_IncrementalMesh(shape, deflection, /*isRelative=*/Standard_False, options.angular_deflection,
                           /*isInParallel=*/Standard_False);
}

/// All edges that have a length; those without are the poles of spheres and the tips of cones.
TopTools_IndexedMapOfShape edges_of(const TopoDS_Shape& shape) {
  TopTools_IndexedMapOfShape edges;
  for (TopExp_Explorer e(shape, TopAbs_EDGE); e.More(); e.Next()) {
    if (!BRep_Tool::Degenerated(TopoDS::Edge(e.Current()))) edges.Add(e.Current());
  }
  return edges;
}

void link_faces_and_edges(const TopTools_IndexedMapOfShape& faces, const TopTools_IndexedMapOfShape& edges,
                          Part& part) {
  for (Standard_Integer f = 1; f <= faces.Extent(); ++f) {
    TopTools_IndexedMapOfShape own;  // a seam is met twice
    TopExp::MapShapes(faces(f), TopAbs_EDGE, own);
    for (Standard_Integer i = 1; i <= own.Extent(); ++i) {
      const Standard_Integer e = edges.FindIndex(own(i));
      if (e == 0) continue;
      part.faces[static_cast<std::size_t>(f) - 1].edges.push_back(static_cast<std::uint32_t>(e - 1));
      part.edges[static_cast<std::size_t>(e) - 1].faces.push_back(static_cast<std::uint32_t>(f - 1));
    }
  }
}

}  // namespace

Part part_from(const NamedShape& named, const Options& options) {
  const double unit = options.scale / kMillimetresPerMetre;
  Part part;
  part.name = named.name;
  part.color = named.color;
  part.notes = named.notes;
  part.exact = true;
  const TopoDS_Shape shape = sound(named.shape, part.notes);
  part.mass = mass_of(shape, unit);
  tessellate(shape, unit, options);

  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  const TopTools_IndexedMapOfShape edges = edges_of(shape);
  for (Standard_Integer i = 1; i <= faces.Extent(); ++i) part.faces.push_back(face_from(TopoDS::Face(faces(i)), unit));
  for (Standard_Integer i = 1; i <= edges.Extent(); ++i) part.edges.push_back(edge_from(TopoDS::Edge(edges(i)), unit));
  link_faces_and_edges(faces, edges, part);
  for (const Face& face : part.faces) part.area += face.area;

  Tessellation tessellation = tessellation_of(faces, edges, unit);
  for (std::size_t i = 0; i < part.edges.size(); ++i) {
    for (const std::uint32_t v : tessellation.of_edge[i])
      part.edges[i].polyline.push_back(tessellation.mesh.vertices[v]);
  }
  part.mesh = std::move(tessellation.mesh);
  if (tessellation.faces_without_triangles > 0) {
    part.notes.push_back(fmt::format("{} of its {} faces could not be tessellated",
                                     tessellation.faces_without_triangles, part.faces.size()));
  }
  return part;
}

}  // namespace verisim::cad
