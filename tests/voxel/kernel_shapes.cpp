#include "tests/voxel/kernel_shapes.hpp"

#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Vertex.hxx>
#include <limits>

#include "engine/base/error.hpp"
#include "engine/geometry/cad/shapes.hpp"

/// The kernel never frees what its STEP reader holds; leak checks are for this project's memory.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libTK";
}

namespace verisim::test {

namespace {

constexpr double kUnit = 1 / cad::kMillimetresPerMetre;

KernelPart from_shape(const TopoDS_Shape& shape, const std::string& name) {
  KernelPart result;
  result.part = cad::part_from({shape, name, {}, {}}, {.path = name, .angular_deflection = 0.1});
  result.part.watertight = true;
  TopTools_IndexedMapOfShape faces, edges;
  TopExp::MapShapes(shape, TopAbs_FACE, faces);
  for (int i = 1; i <= faces.Extent(); ++i) result.entities.push_back(faces(i));
  for (TopExp_Explorer e(shape, TopAbs_EDGE); e.More(); e.Next()) {
    if (!BRep_Tool::Degenerated(TopoDS::Edge(e.Current()))) edges.Add(e.Current());
  }
  for (int i = 1; i <= edges.Extent(); ++i) result.entities.push_back(edges(i));
  for (const TopoDS_Shape& entity : result.entities) {
    constexpr double kGap = 1e-3;  // mm
    Bnd_Box box;                   // the quick one is too small around some faces on tori
    BRepBndLib::AddOptimal(entity, box, /*useTriangulation=*/Standard_False);
    box.Enlarge(kGap);
    result.boxes.push_back(box);
  }
  VERISIM_ASSERT(result.entities.size() == result.part.faces.size() + result.part.edges.size());
  return result;
}

}  // namespace

KernelPart kernel_part_of(const Solid& solid) {
  return from_shape(cad::shape_from(solid), "solid");
}

KernelPart kernel_part_of_file(const std::string& path, int index) {
  STEPControl_Reader reader;
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) fail(ErrorKind::input, "{}: cannot be read", path);
  reader.TransferRoots();
  TopExp_Explorer solids(reader.OneShape(), TopAbs_SOLID);
  for (int i = 0; i < index && solids.More(); ++i) solids.Next();
  if (!solids.More()) fail(ErrorKind::input, "{}: has no solid {}", path, index);
  return from_shape(solids.Current(), path);
}

namespace {

/// The kernel's search for the distance of a box misses some tori that it finds from a point: does the entity's point
/// nearest to the box's centre, or to one of its corners, lie in the box?
bool has_witness(const TopoDS_Shape& entity, const Vector3d& center, double half_side) {
  for (int i = 0; i < 9; ++i) {
    const auto side = [&](int bit) { return i == 8 ? 0 : (i >> bit & 1) != 0 ? half_side : -half_side; };
    const Vector3d from = (center + Vector3d(side(0), side(1), side(2))) / kUnit;
    const TopoDS_Vertex vertex = BRepBuilderAPI_MakeVertex(gp_Pnt(from.x(), from.y(), from.z()));
    BRepExtrema_DistShapeShape nearest(vertex, entity);
    for (int k = 1; k <= nearest.NbSolution(); ++k) {
      const gp_Pnt at = nearest.PointOnShape2(k);
      const Vector3d arm = kUnit * Vector3d(at.X(), at.Y(), at.Z()) - center;
      if (arm.cwiseAbs().maxCoeff() <= half_side) return true;
    }
  }
  return false;
}

}  // namespace

double kernel_distance(const KernelPart& part, std::size_t number, const Vector3d& center, double half_side) {
  const Vector3d low = (center - Vector3d::Constant(half_side)) / kUnit;
  const Vector3d high = (center + Vector3d::Constant(half_side)) / kUnit;
  Bnd_Box voxel;
  voxel.Update(low.x(), low.y(), low.z(), high.x(), high.y(), high.z());
  if (part.boxes[number].IsOut(voxel)) return std::numeric_limits<double>::infinity();
  const gp_Pnt low_corner(low.x(), low.y(), low.z()), high_corner(high.x(), high.y(), high.z());
  BRepExtrema_DistShapeShape distance(BRepPrimAPI_MakeBox(low_corner, high_corner).Solid(), part.entities[number]);
  VERISIM_ASSERT(distance.IsDone());
  const double found = kUnit * distance.Value();
  const bool is_far = found > 4 * half_side;
  return found > 0 && !is_far && has_witness(part.entities[number], center, half_side) ? 0 : found;
}

}  // namespace verisim::test
