// Solids from primitives and booleans of them.
#include <BRepAlgoAPI_Common.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepAlgoAPI_Fuse.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRep_Builder.hxx>
#include <ShapeUpgrade_UnifySameDomain.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Compound.hxx>
#include <gp_Quaternion.hxx>

#include "engine/geometry/cad/shapes.hpp"

namespace verisim::cad {
namespace {

gp_Ax2 base_at(double height) {
  return {gp_Pnt(0, 0, -0.5 * height), gp::DZ()};
}

TopoDS_Shape cylinder(double radius, double height) {
  return BRepPrimAPI_MakeCylinder(base_at(height), radius, height).Shape();
}

TopoDS_Shape cone(double radius1, double radius2, double height) {
  if (radius1 == radius2) return cylinder(radius1, height);  // the kernel refuses a cone that is none
  return BRepPrimAPI_MakeCone(base_at(height), radius1, radius2, height).Shape();
}

TopoDS_Shape boolean(Solid::Kind kind, const TopoDS_Shape& a, const TopoDS_Shape& b) {
  const auto checked = [](BRepAlgoAPI_BooleanOperation&& operation) {
    if (!operation.IsDone() || operation.HasErrors()) {
      fail(ErrorKind::input, "the CAD kernel cannot combine two of the solids; move one of them by a little");
    }
    return operation.Shape();
  };
  if (kind == Solid::Kind::difference) return checked(BRepAlgoAPI_Cut(a, b));
  if (kind == Solid::Kind::sum) return checked(BRepAlgoAPI_Fuse(a, b));
  return checked(BRepAlgoAPI_Common(a, b));
}

TopoDS_Shape placed(const TopoDS_Shape& shape, const Pose& placement) {
  const Vector3d p = kMillimetresPerMetre * placement.position;
  const Quaterniond& q = placement.rotation;
  gp_Trsf transformation;
  transformation.SetTransformation(gp_Quaternion(q.x(), q.y(), q.z(), q.w()), gp_Vec(p.x(), p.y(), p.z()));
  return shape.Moved(TopLoc_Location(transformation));
}

TopoDS_Shape raw_shape(const Solid& solid) {
  std::vector<double> mm = solid.sizes;
  for (double& size : mm) size *= kMillimetresPerMetre;
  const auto child = [&](std::size_t i) { return raw_shape(*solid.children[i]); };
  switch (solid.kind) {
    case Solid::Kind::box:
      return BRepPrimAPI_MakeBox(gp_Pnt(-0.5 * mm[0], -0.5 * mm[1], -0.5 * mm[2]), mm[0], mm[1], mm[2]).Shape();
    case Solid::Kind::cylinder:
      return cylinder(mm[0], mm[1]);
    case Solid::Kind::cone:
      return cone(mm[0], mm[1], mm[2]);
    case Solid::Kind::sphere:
      return BRepPrimAPI_MakeSphere(mm[0]).Shape();
    case Solid::Kind::tube:
      return boolean(Solid::Kind::difference, cylinder(mm[0], mm[2]), cylinder(mm[1], mm[2]));
    case Solid::Kind::torus:
      return BRepPrimAPI_MakeTorus(mm[0], mm[1]).Shape();
    case Solid::Kind::placed:
      return placed(child(0), solid.placement);
    case Solid::Kind::difference:
    case Solid::Kind::sum:
    case Solid::Kind::intersection:
      return boolean(solid.kind, child(0), child(1));
  }
  VERISIM_ASSERT(!"a solid of unknown kind");
  return {};
}

/// The one solid, or a compound of several (a block cut in two).
TopoDS_Shape solids_of(const TopoDS_Shape& shape) {
  std::vector<TopoDS_Shape> solids;
  for (TopExp_Explorer e(shape, TopAbs_SOLID); e.More(); e.Next()) solids.push_back(e.Current());
  if (solids.empty())
    fail(ErrorKind::input, "nothing is left of the solid; check the places and sizes of what is cut away");
  if (solids.size() == 1) return solids.front();
  TopoDS_Compound compound;
  const BRep_Builder builder;
  builder.MakeCompound(compound);
  for (const TopoDS_Shape& solid : solids) builder.Add(compound, solid);
  return compound;
}

}  // namespace

TopoDS_Shape shape_from(const Solid& solid) {
  ShapeUpgrade_UnifySameDomain unify(solids_of(raw_shape(solid)), /*UnifyEdges=*/Standard_True,
                                     /*UnifyFaces=*/Standard_True,
                                     /*ConcatBSplines=*/Standard_False);
  unify.Build();
  return solids_of(unify.Shape());
}

Part build(const Solid& solid, const Options& options) {
  NamedShape named;
  named.name = "solid";
  named.shape = shape_from(solid);
  return part_from(named, options);
}

}  // namespace verisim::cad
