#include "engine/ruler/ruler.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/ruler/solid_depth.hpp"

namespace verisim::ruler {
namespace {

const NamedArray* table(const PartData& part, const char* name) {
  const auto found =
      std::find_if(part.tables.begin(), part.tables.end(), [&](const NamedArray& t) { return t.name == name; });
  return found == part.tables.end() ? nullptr : &*found;
}

template <typename T, typename Row>
std::vector<Row> rows_of(const PartData& part, const char* name) {
  const NamedArray* found = table(part, name);
  if (found == nullptr)
    fail(ErrorKind::input, "part '{}' has no table '{}'; what holds it is damaged", part.name, name);
  const std::vector<T> flat = found->as<T>();
  std::vector<Row> rows(flat.size() / 3);
  for (std::size_t i = 0; i < rows.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) rows[i][static_cast<Eigen::Index>(k)] = flat[3 * i + k];
  return rows;
}

FacedTriangles triangles_of(const PartData& part) {
  FacedTriangles result;
  auto vertices = rows_of<double, Vector3d>(part, "vertices");
  const auto rows = rows_of<std::uint32_t, Eigen::Matrix<std::uint32_t, 3, 1>>(part, "triangles");
  std::vector<std::array<std::uint32_t, 3>> triangles;
  triangles.reserve(rows.size());
  for (const auto& row : rows) {
    if (row.maxCoeff() >= vertices.size())
      fail(ErrorKind::input, "part '{}': a triangle has a corner that there is not; what holds it is damaged",
           part.name);
    triangles.push_back({row[0], row[1], row[2]});
  }
  result.vertices = std::move(vertices);
  result.triangles = std::move(triangles);
  return result;
}

/// Of a row of face_surface: point, direction, x axis, radius, second size.
std::optional<Divider> divider_of(std::uint8_t kind, const double* row) {
  Divider d{.point = {row[0], row[1], row[2]}, .axis = {row[3], row[4], row[5]}, .radius = row[9]};
  switch (kind) {
    case 0:
      d.kind = Divider::Kind::plane;
      return d;
    case 1:
      d.kind = Divider::Kind::cylinder;
      return d;
    case 2:
      d.kind = Divider::Kind::cone;
      d.sine = pinned::sin(row[10]);
      d.cosine = pinned::cos(row[10]);
      d.point -= row[9] * d.cosine / d.sine * d.axis;
      return d;
    case 3:
      d.kind = Divider::Kind::sphere;
      return d;
    case 4:
      d.kind = Divider::Kind::torus;
      d.ring = row[9];
      d.radius = row[10];
      return d;
    default:
      return {};
  }
}

/// The surfaces of the triangles' faces, where the tables have some.
void add_faces(const PartData& part, FacedTriangles& faced) {
  const NamedArray* of_triangle = table(part, "face_of_triangle");
  const NamedArray* kinds = table(part, "face_kind");
  const NamedArray* rows = table(part, "face_surface");
  if (of_triangle == nullptr || kinds == nullptr || rows == nullptr || kinds->count() == 0) return;
  const auto kind = kinds->as<std::uint8_t>();
  const auto row = rows->as<double>();
  constexpr std::size_t kColumns = 11;
  faced.face_of_triangle = of_triangle->as<std::uint32_t>();
  const auto is_damaged = [&](std::uint32_t face) { return face != kNoFace && face >= kind.size(); };
  if (row.size() != kColumns * kind.size() || faced.face_of_triangle.size() != faced.triangles.size() ||
      std::any_of(faced.face_of_triangle.begin(), faced.face_of_triangle.end(), is_damaged))
    fail(ErrorKind::input, "part '{}': the tables of its faces do not fit together; what holds it is damaged",
         part.name);
  for (std::size_t i = 0; i < kind.size(); ++i) faced.faces.push_back(divider_of(kind[i], row.data() + kColumns * i));
}

bool is_closed(const PartData& part) {
  const NamedArray* flags = table(part, "flags");
  return flags != nullptr && flags->count() > 0 && flags->as<std::uint8_t>().front() != 0;
}

}  // namespace

Shape::Shape(const std::vector<PartData>& parts) {
  for (const PartData& part : parts) {
    Piece piece{};
    piece.name = part.name;
    if (!part.solid.empty()) piece.solid.emplace(part.solid);
    if (is_closed(part)) {
      piece.faced = triangles_of(part);
      piece.mesh.emplace(piece.faced.vertices, piece.faced.triangles);
      add_faces(part, piece.faced);
    }
    pieces_.push_back(std::move(piece));
  }
}

void Shape::lift() {
  constexpr double kTolerance = 5e-7;  // m: as well as overlaps of triangles are known
  for (Piece& piece : pieces_) {
    if (piece.surface || piece.faced.faces.empty()) continue;
    Lifted lifted = ruler::lifted(std::move(piece.faced), kTolerance);
    piece.surface_off = lifted.off;
    piece.surface.emplace(std::move(lifted.triangles.vertices), std::move(lifted.triangles.triangles));
  }
}

bool has_surfaces(const Shape& a, const Shape& b) {
  const auto is_solid = [](const Shape::Piece& piece) { return piece.solid.has_value(); };
  const auto has_some = [](const Shape::Piece& piece) { return piece.surface || !piece.faced.faces.empty(); };
  for (const auto& [one, other] : {std::pair{&a, &b}, {&b, &a}})
    for (const Shape::Piece& piece : one->pieces_)
      if (has_some(piece) && !(is_solid(piece) && std::all_of(other->pieces_.begin(), other->pieces_.end(), is_solid)))
        return true;
  return false;
}

std::string why_not(const Shape& a, const Shape& b) {
  for (const auto& [one, other] : {std::pair{&a, &b}, {&b, &a}}) {
    const bool other_is_solid = std::all_of(other->pieces_.begin(), other->pieces_.end(),
                                            [](const Shape::Piece& piece) { return piece.solid.has_value(); });
    for (const Shape::Piece& piece : one->pieces_)
      if (!piece.mesh && !(piece.solid && other_is_solid))
        return "'" + piece.name + "' is not closed, so that nothing says where its inside is; close it";
  }
  return {};
}

double largest_move(const Shape& a, const Pose& X_BA, const Pose& Y_BA) {
  VERISIM_ASSERT(is_placement(X_BA));
  VERISIM_ASSERT(is_placement(Y_BA));
  const double chord = 2 * (Y_BA.rotation * X_BA.rotation.conjugate()).vec().norm();  // of a point at 1 m
  double most = 0;
  const auto add = [&](const Vector3d& middle, double radius) {
    most = std::max(most, (Y_BA * middle - X_BA * middle).norm() + chord * radius);
  };
  for (const Shape::Piece& piece : a.pieces_) {
    if (piece.solid) add(piece.solid->middle(), piece.solid->radius());
    if (piece.mesh) add(piece.mesh->bounds().center(), 0.5 * piece.mesh->bounds().diagonal().norm());
  }
  return most;
}

/// Pairs of parts, one after the other; the deepest counts.
struct Measurer {
  const Pose& X_WA;
  const Pose& X_WB;
  const Accuracy& accuracy;
  bool by_surfaces = false;
  Overlap worst{};
  double limit = 0;  ///< no pair so far is deeper

  /// @param off [m] what the triangles are off from their surfaces
  void take(const Depth& depth, const Pose& X_W, Source source, double off = 0) {
    limit = std::max(limit, depth.depth + depth.bound + off);
    if (depth.depth - off > worst.depth) {
      worst.depth = depth.depth - off;
      worst.place_W = X_W * depth.place;
    }
    worst.source = std::max(worst.source, source);
  }
  void measure_triangles(const Shape::Piece& first, const Shape::Piece& second, const Pose& X_BA) {
    VERISIM_ASSERT(first.mesh && second.mesh);
    const bool lifted_a = by_surfaces && first.surface, lifted_b = by_surfaces && second.surface;
    const Triangles& a = lifted_a ? *first.surface : *first.mesh;
    const Triangles& b = lifted_b ? *second.surface : *second.mesh;
    const double off = (lifted_a ? first.surface_off : 0) + (lifted_b ? second.surface_off : 0);
    const Source source = by_surfaces ? Source::surfaces : Source::triangles;
    take(depth_in(a, X_BA, b, accuracy), X_WB, source, off);
    take(depth_in(b, X_BA.inverse(), a, accuracy), X_WA, source, off);
  }
  void measure(const Shape& a, const Shape& b) {
    const Pose X_BA = X_WB.inverse() * X_WA;
    for (const Shape::Piece& first : a.pieces_)
      for (const Shape::Piece& second : b.pieces_) {
        if (first.solid && second.solid) {
          const Csg placed = first.solid->placed(X_BA);
          take(depth_in(placed, *second.solid, accuracy), X_WB, Source::solids);
          take(depth_in(*second.solid, placed, accuracy), X_WB, Source::solids);
        } else {
          measure_triangles(first, second, X_BA);
        }
      }
    worst.bound = std::max(0.0, limit - worst.depth);
  }
};

Overlap overlap(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB, const Accuracy& accuracy) {
  VERISIM_ASSERT(why_not(a, b).empty());
  VERISIM_ASSERT(is_placement(X_WA));
  VERISIM_ASSERT(is_placement(X_WB));
  Measurer measurer{X_WA, X_WB, accuracy};
  measurer.measure(a, b);
  return measurer.worst;
}

Overlap overlap_of_surfaces(const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB,
                            const Accuracy& accuracy) {
  VERISIM_ASSERT(why_not(a, b).empty());
  VERISIM_ASSERT(has_surfaces(a, b));
  VERISIM_ASSERT(is_placement(X_WA));
  VERISIM_ASSERT(is_placement(X_WB));
  Measurer measurer{X_WA, X_WB, accuracy, /*by_surfaces=*/true};
  measurer.measure(a, b);
  return measurer.worst;
}

}  // namespace verisim::ruler
