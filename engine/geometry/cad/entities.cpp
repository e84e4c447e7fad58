// From the kernel's surfaces and curves to those of entity.hpp. Three things differ:
// - the kernel's local coordinates may be left-handed (after a mirror); ours are right-handed: u changes its sign;
// - a kernel face is reversed or not against its surface's own normal; ours says where the material is;
// - the kernel's cone has v along its slant and may narrow; ours has v along the axis, towards growing radius.
#include "engine/geometry/cad/entities.hpp"

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepGProp.hxx>
#include <BRepTools.hxx>
#include <GProp_GProps.hxx>
#include <gp_Circ.hxx>
#include <gp_Cone.hxx>
#include <gp_Cylinder.hxx>
#include <gp_Elips.hxx>
#include <gp_Lin.hxx>
#include <gp_Pln.hxx>
#include <gp_Sphere.hxx>
#include <gp_Torus.hxx>

#include "engine/geometry/cad/rounding.hpp"

namespace verisim::cad {
namespace {

using Range = std::array<double, 2>;

Vector3d vector(const gp_XYZ& v) {
  return {v.X(), v.Y(), v.Z()};
}
Vector3d vector(const gp_Dir& v) {
  return vector(v.XYZ());
}

Range lengths(double from, double to) {
  return {round_coordinate(from), round_coordinate(to)};
}
Range angles(double from, double to) {
  return {round_angle(from), round_angle(to)};
}
Range mirrored(const Range& r) {
  return {-r[1], -r[0]};
}

/// The kernel's data of a face's surface and bounds.
struct Source {
  gp_Ax3 axes;
  bool reversed;  ///< the material's outward normal is against the surface's own (du x dv)
  Range u;        ///< kernel parameters
  Range v;
  double unit;

  [[nodiscard]] Vector3d point() const { return round_point(unit * vector(axes.Location().XYZ())); }
  [[nodiscard]] Vector3d direction() const { return round_direction(vector(axes.Direction())); }
  [[nodiscard]] Vector3d x_axis() const { return round_x_axis(vector(axes.XDirection()), direction()); }
  /// Around `direction` in the right-handed sense.
  [[nodiscard]] Range u_angles() const { return axes.Direct() ? angles(u[0], u[1]) : mirrored(angles(u[0], u[1])); }
  /// du x dv of a round surface points away from its axis or centre where the axes are right-handed.
  [[nodiscard]] bool hole() const { return reversed == axes.Direct(); }
};

void set_plane(Face& face, const Source& s) {
  const gp_Dir natural = s.axes.XDirection().Crossed(s.axes.YDirection());
  const Vector3d normal = round_direction(s.reversed ? Vector3d(-vector(natural)) : vector(natural));
  face.surface = Plane{s.point(), normal, round_x_axis(vector(s.axes.XDirection()), normal)};
  face.u_range = lengths(s.unit * s.u[0], s.unit * s.u[1]);
  const Range v = lengths(s.unit * s.v[0], s.unit * s.v[1]);
  face.v_range = s.reversed ? mirrored(v) : v;  // y = normal x x_axis turns with the normal
}

void set_cylinder(Face& face, const Source& s, double radius) {
  face.surface = Cylinder{s.point(), s.direction(), s.x_axis(), round_number(s.unit * radius), s.hole()};
  face.u_range = s.u_angles();
  face.v_range = lengths(s.unit * s.v[0], s.unit * s.v[1]);
}

/// The kernel's cone: p(u, v) = P + (R + v sin a)(cos u X + sin u Y) + v cos a Z, a in (-pi/2, pi/2).
void set_cone(Face& face, const Source& s, double radius, double semi_angle) {
  const double sine = std::sin(semi_angle);
  const double cosine = std::cos(semi_angle);
  // Beyond its apex the kernel's radius is negative: the same cone, seen from the apex, opening the other way.
  const bool beyond_apex = radius + 0.5 * (s.v[0] + s.v[1]) * sine < 0;
  const bool narrows = (semi_angle < 0) != beyond_apex;
  const double apex_height = -radius * cosine / sine;  // along Z
  Cone cone;
  const Vector3d z = s.direction();
  cone.direction = narrows ? Vector3d(-z) : z;
  cone.half_angle = round_angle(std::abs(semi_angle));
  cone.radius = beyond_apex ? 0 : round_number(s.unit * radius);
  cone.point = s.point();
  if (beyond_apex)
    cone.point = round_point(s.unit * (vector(s.axes.Location().XYZ()) + apex_height * vector(s.axes.Direction())));
  cone.x_axis = beyond_apex ? Vector3d(-s.x_axis()) : s.x_axis();
  cone.hole = s.hole();  // du and the radius both turn round at the apex: du x dv still points away from the axis
  face.surface = cone;
  const double origin = beyond_apex ? apex_height : 0;
  const Range v = lengths(s.unit * (s.v[0] * cosine - origin), s.unit * (s.v[1] * cosine - origin));
  face.v_range = narrows ? mirrored(v) : v;
  face.u_range = narrows ? mirrored(s.u_angles()) : s.u_angles();
}

void set_sphere(Face& face, const Source& s, double radius) {
  face.surface = Sphere{s.point(), s.direction(), s.x_axis(), round_number(s.unit * radius), s.hole()};
  face.u_range = s.u_angles();
  face.v_range = angles(s.v[0], s.v[1]);
}

void set_torus(Face& face, const Source& s, double major, double minor) {
  // A tube wider than its ring passes the axis; there du x dv points into the tube.
  const bool beyond_axis = major + minor * std::cos(0.5 * (s.v[0] + s.v[1])) < 0;
  const bool hole = s.hole() != beyond_axis;
  face.surface =
      Torus{s.point(), s.direction(), s.x_axis(), round_number(s.unit * major), round_number(s.unit * minor), hole};
  face.u_range = s.u_angles();
  face.v_range = angles(s.v[0], s.v[1]);
}

double area_of_face(const TopoDS_Face& face) {
  GProp_GProps properties;
  BRepGProp::SurfaceProperties(face, properties);
  return properties.Mass();
}

double length_of(const TopoDS_Edge& edge) {
  GProp_GProps properties;
  BRepGProp::LinearProperties(edge, properties);
  return properties.Mass();
}

}  // namespace

Face face_from(const TopoDS_Face& shape, double unit) {
  Face face;
  face.area = round_number(unit * unit * area_of_face(shape));
  const BRepAdaptor_Surface surface(shape, /*R=*/Standard_False);
  Source s{gp_Ax3(), shape.Orientation() == TopAbs_REVERSED, {}, {}, unit};
  BRepTools::UVBounds(shape, s.u[0], s.u[1], s.v[0], s.v[1]);
  switch (surface.GetType()) {
    case GeomAbs_Plane:
      s.axes = surface.Plane().Position();
      set_plane(face, s);
      break;
    case GeomAbs_Cylinder:
      s.axes = surface.Cylinder().Position();
      set_cylinder(face, s, surface.Cylinder().Radius());
      break;
    case GeomAbs_Cone:
      s.axes = surface.Cone().Position();
      set_cone(face, s, surface.Cone().RefRadius(), surface.Cone().SemiAngle());
      break;
    case GeomAbs_Sphere:
      s.axes = surface.Sphere().Position();
      set_sphere(face, s, surface.Sphere().Radius());
      break;
    case GeomAbs_Torus:
      s.axes = surface.Torus().Position();
      set_torus(face, s, surface.Torus().MajorRadius(), surface.Torus().MinorRadius());
      break;
    case GeomAbs_BezierSurface:
    case GeomAbs_BSplineSurface:
    case GeomAbs_SurfaceOfRevolution:
    case GeomAbs_SurfaceOfExtrusion:
    case GeomAbs_OffsetSurface:
    case GeomAbs_OtherSurface:
      face.surface = OtherSurface{};
  }
  return face;
}

Edge edge_from(const TopoDS_Edge& shape, double unit) {
  Edge edge;
  edge.length = round_number(unit * length_of(shape));
  const BRepAdaptor_Curve curve(shape);
  const auto set_axes = [&](const gp_Ax2& axes, auto& c) {
    c.center = round_point(unit * vector(axes.Location().XYZ()));
    c.normal = round_direction(vector(axes.Direction()));
    c.x_axis = round_x_axis(vector(axes.XDirection()), c.normal);
  };
  const double from = curve.FirstParameter();
  const double to = curve.LastParameter();
  switch (curve.GetType()) {
    case GeomAbs_Line:
      edge.curve = Line{round_point(unit * vector(curve.Line().Location().XYZ())),
                        round_direction(vector(curve.Line().Direction()))};
      edge.t_range = lengths(unit * from, unit * to);
      break;
    case GeomAbs_Circle: {
      Circle circle;
      set_axes(curve.Circle().Position(), circle);
      circle.radius = round_number(unit * curve.Circle().Radius());
      edge.curve = circle;
      edge.t_range = angles(from, to);
      break;
    }
    case GeomAbs_Ellipse: {
      Ellipse ellipse;
      set_axes(curve.Ellipse().Position(), ellipse);
      ellipse.major_radius = round_number(unit * curve.Ellipse().MajorRadius());
      ellipse.minor_radius = round_number(unit * curve.Ellipse().MinorRadius());
      edge.curve = ellipse;
      edge.t_range = angles(from, to);
      break;
    }
    case GeomAbs_Hyperbola:
    case GeomAbs_Parabola:
    case GeomAbs_BezierCurve:
    case GeomAbs_BSplineCurve:
    case GeomAbs_OffsetCurve:
    case GeomAbs_OtherCurve:
      edge.curve = OtherCurve{};
  }
  return edge;
}

}  // namespace verisim::cad
