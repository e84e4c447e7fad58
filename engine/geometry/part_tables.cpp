// A part as tables and back. One row per face and per edge; lists of varying length are one flat table and one of
// offsets: row i of a list is flat[offsets[i] .. offsets[i + 1]).
#include <algorithm>
#include <map>
#include <type_traits>

#include "engine/base/error.hpp"
#include "engine/geometry/entity_row.hpp"
#include "engine/geometry/part.hpp"

namespace verisim {
namespace {

/// Collects the tables of one part.
class Writer {
 public:
  /// `columns` is 0 for a table of one dimension.
  template <typename T>
  void add(const char* name, const std::vector<T>& values, std::size_t columns, const char* units, const char* text) {
    std::vector<std::size_t> shape = {columns == 0 ? values.size() : values.size() / columns};
    if (columns > 0) shape.push_back(columns);
    tables.push_back(NamedArray::from<T>(name, values, std::move(shape), units, text));
  }
  /// Rows of a type without padding (Vector3d, std::array).
  template <typename T, typename RowType>
  void add_rows(const char* name, const std::vector<RowType>& rows, const char* units, const char* text) {
    static_assert(sizeof(RowType) % sizeof(T) == 0);
    std::vector<T> flat(rows.size() * (sizeof(RowType) / sizeof(T)));
    if (!rows.empty()) std::memcpy(flat.data(), static_cast<const void*>(rows.data()), flat.size() * sizeof(T));
    add(name, flat, sizeof(RowType) / sizeof(T), units, text);
  }

  std::vector<NamedArray> tables;
};

void add_mesh(Writer& w, const TriangleMesh& mesh) {
  w.add_rows<double>("vertices", mesh.vertices, "m", "Corners of the triangles, part coordinates");
  w.add_rows<std::uint32_t>("triangles", mesh.triangles, "1", "Vertex indices, counter-clockwise seen from outside");
  w.add("face_of_triangle", mesh.face_of_triangle, 0, "1", "B-rep face of each triangle, 4294967295 for none");
}

void add_faces(Writer& w, const std::vector<Face>& faces) {
  std::vector<std::uint8_t> kinds;
  std::vector<std::uint8_t> holes;
  std::vector<EntityRow> rows;
  std::vector<std::array<double, 4>> bounds;
  std::vector<double> areas;
  std::vector<std::uint32_t> edges;
  std::vector<std::uint32_t> offsets = {0};
  for (const Face& face : faces) {
    kinds.push_back(static_cast<std::uint8_t>(face.surface.index()));
    holes.push_back(is_hole(face.surface) ? 1 : 0);
    rows.push_back(row_of(face.surface));
    bounds.push_back({face.u_range[0], face.u_range[1], face.v_range[0], face.v_range[1]});
    areas.push_back(face.area);
    edges.insert(edges.end(), face.edges.begin(), face.edges.end());
    offsets.push_back(static_cast<std::uint32_t>(edges.size()));
  }
  w.add("face_kind", kinds, 0, "1", "0 plane, 1 cylinder, 2 cone, 3 sphere, 4 torus, 5 other");
  w.add("face_hole", holes, 0, "1", "1 where the material is outside the radius");
  w.add_rows<double>("face_surface", rows, "m",
                     "Point or centre, direction or normal (unit), x axis (unit), radius or major radius, minor radius "
                     "(torus) or half angle (cone, rad)");
  w.add_rows<double>("face_bounds", bounds, "m", "Trimmed u and v: from, to, from, to; angles in rad");
  w.add("face_area", areas, 0, "m^2", "Exact area");
  w.add("face_edges", edges, 0, "1", "Edges of all faces, one after the other");
  w.add("face_edge_offsets", offsets, 0, "1", "Where each face's edges begin; the last is the total");
}

void add_edges(Writer& w, const std::vector<Edge>& edges) {
  std::vector<std::uint8_t> kinds;
  std::vector<EntityRow> rows;
  std::vector<std::array<double, 2>> bounds;
  std::vector<double> lengths;
  std::vector<Vector3d> points;
  std::vector<std::uint32_t> faces;
  std::vector<std::uint32_t> point_offsets = {0};
  std::vector<std::uint32_t> face_offsets = {0};
  for (const Edge& edge : edges) {
    kinds.push_back(static_cast<std::uint8_t>(edge.curve.index()));
    rows.push_back(row_of(edge.curve));
    bounds.push_back(edge.t_range);
    lengths.push_back(edge.length);
    points.insert(points.end(), edge.polyline.begin(), edge.polyline.end());
    faces.insert(faces.end(), edge.faces.begin(), edge.faces.end());
    point_offsets.push_back(static_cast<std::uint32_t>(points.size()));
    face_offsets.push_back(static_cast<std::uint32_t>(faces.size()));
  }
  w.add("edge_kind", kinds, 0, "1", "0 line, 1 circle, 2 ellipse, 3 other");
  w.add_rows<double>(
      "edge_curve", rows, "m",
      "Point or centre, direction or normal (unit), x axis (unit), radius or major radius, minor radius");
  w.add_rows<double>("edge_bounds", bounds, "m", "Trimmed t: from, to; angles in rad");
  w.add("edge_length", lengths, 0, "m", "Exact length");
  w.add_rows<double>("edge_points", points, "m", "Polylines of all edges, one after the other");
  w.add("edge_point_offsets", point_offsets, 0, "1", "Where each edge's polyline begins; the last is the total");
  w.add("edge_faces", faces, 0, "1", "The one or two faces of all edges, one after the other");
  w.add("edge_face_offsets", face_offsets, 0, "1", "Where each edge's faces begin; the last is the total");
}

std::vector<std::uint8_t> bytes_of(const std::vector<std::string>& lines) {
  std::vector<std::uint8_t> bytes;
  for (const std::string& line : lines) {
    bytes.insert(bytes.end(), line.begin(), line.end());
    bytes.push_back('\n');
  }
  return bytes;
}

/// Reads the tables of one part; whatever does not fit is a damaged run file.
class Reader {
 public:
  Reader(const std::string& part, const std::vector<NamedArray>& tables) : part_(part) {
    for (const NamedArray& table : tables) tables_[table.name] = &table;
  }
  template <typename T>
  [[nodiscard]] std::vector<T> values(const char* name) const {
    const auto found = tables_.find(name);
    if (found == tables_.end()) damaged(name, "is missing");
    return found->second->as<T>();
  }
  template <typename T, typename RowType>
  [[nodiscard]] std::vector<RowType> rows(const char* name) const {
    const std::vector<T> flat = values<T>(name);
    constexpr std::size_t columns = sizeof(RowType) / sizeof(T);
    if (flat.size() % columns != 0) damaged(name, "has an incomplete row");
    std::vector<RowType> rows(flat.size() / columns);
    if (!rows.empty()) std::memcpy(static_cast<void*>(rows.data()), flat.data(), flat.size() * sizeof(T));
    return rows;
  }
  /// A table with exactly `count` rows.
  template <typename T, typename RowType = T>
  [[nodiscard]] std::vector<RowType> rows(const char* name, std::size_t count) const {
    std::vector<RowType> all = rows<T, RowType>(name);
    if (all.size() != count) damaged(name, fmt::format("has {} rows instead of {}", all.size(), count));
    return all;
  }
  /// `count` lists out of a flat table and its offsets.
  template <typename T, typename RowType = T>
  [[nodiscard]] std::vector<std::vector<RowType>> lists(const char* name, const char* offsets_name,
                                                        std::size_t count) const {
    const std::vector<RowType> flat = rows<T, RowType>(name);
    const auto offsets = rows<std::uint32_t>(offsets_name, count + 1);
    if (!std::is_sorted(offsets.begin(), offsets.end()) || offsets.front() != 0 || offsets.back() != flat.size()) {
      damaged(offsets_name, "does not divide its table");
    }
    std::vector<std::vector<RowType>> lists(count);
    for (std::size_t i = 0; i < count; ++i) lists[i].assign(flat.begin() + offsets[i], flat.begin() + offsets[i + 1]);
    return lists;
  }
  void require_below(const char* name, std::span<const std::uint32_t> indices, std::size_t limit) const {
    for (const std::uint32_t index : indices) {
      if (index >= limit) damaged(name, fmt::format("points at row {} of {}", index, limit));
    }
  }
  void require_kind(const char* name, std::uint8_t kind, std::size_t kinds) const {
    if (kind >= kinds) damaged(name, fmt::format("has kind {}, of {}", kind, kinds));
  }
  [[noreturn]] void damaged(const char* name, const std::string& what) const {
    fail(ErrorKind::input, "part '{}': table '{}' {}; the file that holds it is damaged", part_, name, what);
  }

 private:
  std::string part_;
  std::map<std::string, const NamedArray*> tables_;
};

TriangleMesh read_mesh(const Reader& r, std::size_t face_count) {
  TriangleMesh mesh;
  mesh.vertices = r.rows<double, Vector3d>("vertices");
  mesh.triangles = r.rows<std::uint32_t, std::array<std::uint32_t, 3>>("triangles");
  for (const auto& triangle : mesh.triangles) r.require_below("triangles", triangle, mesh.vertices.size());
  mesh.face_of_triangle = r.values<std::uint32_t>("face_of_triangle");
  if (!mesh.face_of_triangle.empty() && mesh.face_of_triangle.size() != mesh.triangles.size()) {
    r.damaged("face_of_triangle", "has not one row per triangle");
  }
  for (const std::uint32_t face : mesh.face_of_triangle) {
    if (face != kNoFace) r.require_below("face_of_triangle", {&face, 1}, face_count);
  }
  return mesh;
}

std::vector<Face> read_faces(const Reader& r, std::size_t edge_count) {
  const auto kinds = r.values<std::uint8_t>("face_kind");
  const std::size_t n = kinds.size();
  const auto holes = r.rows<std::uint8_t>("face_hole", n);
  const auto rows = r.rows<double, EntityRow>("face_surface", n);
  const auto bounds = r.rows<double, std::array<double, 4>>("face_bounds", n);
  const auto areas = r.rows<double>("face_area", n);
  const auto edges = r.lists<std::uint32_t>("face_edges", "face_edge_offsets", n);
  std::vector<Face> faces(n);
  for (std::size_t i = 0; i < n; ++i) {
    r.require_kind("face_kind", kinds[i], kSurfaceNames.size());
    r.require_below("face_edges", edges[i], edge_count);
    faces[i].surface = surface_from(kinds[i], rows[i], holes[i] != 0);
    faces[i].u_range = {bounds[i][0], bounds[i][1]};
    faces[i].v_range = {bounds[i][2], bounds[i][3]};
    faces[i].area = areas[i];
    faces[i].edges = edges[i];
  }
  return faces;
}

std::vector<Edge> read_edges(const Reader& r, std::size_t face_count) {
  const auto kinds = r.values<std::uint8_t>("edge_kind");
  const std::size_t n = kinds.size();
  const auto rows = r.rows<double, EntityRow>("edge_curve", n);
  const auto bounds = r.rows<double, std::array<double, 2>>("edge_bounds", n);
  const auto lengths = r.rows<double>("edge_length", n);
  const auto polylines = r.lists<double, Vector3d>("edge_points", "edge_point_offsets", n);
  const auto faces = r.lists<std::uint32_t>("edge_faces", "edge_face_offsets", n);
  std::vector<Edge> edges(n);
  for (std::size_t i = 0; i < n; ++i) {
    r.require_kind("edge_kind", kinds[i], kCurveNames.size());
    r.require_below("edge_faces", faces[i], face_count);
    edges[i] = {curve_from(kinds[i], rows[i]), bounds[i], lengths[i], polylines[i], faces[i]};
  }
  return edges;
}

std::vector<std::string> lines_of(const std::vector<std::uint8_t>& bytes) {
  std::vector<std::string> lines;
  for (auto begin = bytes.begin(); begin != bytes.end();) {
    const auto end = std::find(begin, bytes.end(), '\n');
    lines.emplace_back(begin, end);
    begin = end == bytes.end() ? end : end + 1;
  }
  return lines;
}

}  // namespace

std::vector<NamedArray> to_tables(const Part& part) {
  VERISIM_ASSERT(is_whole(part.mesh));
  Writer w;
  add_mesh(w, part.mesh);
  add_faces(w, part.faces);
  add_edges(w, part.edges);
  std::vector<double> mass = {part.mass.volume};
  mass.insert(mass.end(), part.mass.centroid.data(), part.mass.centroid.data() + 3);
  mass.insert(mass.end(), part.mass.inertia.data(), part.mass.inertia.data() + 9);
  w.add("mass", mass, 0, "m^3, m, m^5", "Volume, centroid (3), inertia about the centroid per unit density (9)");
  w.add("area", std::vector<double>{part.area}, 0, "m^2", "Area of the whole surface");
  w.add("color", std::vector<float>(part.color.begin(), part.color.end()), 0, "1", "Red, green, blue, opacity");
  const std::vector<std::uint8_t> flags = {std::uint8_t{part.watertight}, std::uint8_t{part.exact}};
  w.add("flags", flags, 0, "1", "Watertight; from exact geometry");
  w.add("notes", bytes_of(part.notes), 0, "1", "What was repaired or is doubtful: UTF-8, one sentence a line");
  return std::move(w.tables);
}

Part from_tables(const std::string& name, const std::vector<NamedArray>& tables) {
  const Reader r(name, tables);
  const std::size_t face_count = r.values<std::uint8_t>("face_kind").size();
  const std::size_t edge_count = r.values<std::uint8_t>("edge_kind").size();
  Part part;
  part.name = name;
  part.mesh = read_mesh(r, face_count);
  part.faces = read_faces(r, edge_count);
  part.edges = read_edges(r, face_count);
  const auto mass = r.rows<double>("mass", 13);
  part.mass.volume = mass[0];
  std::copy_n(mass.begin() + 1, 3, part.mass.centroid.data());
  std::copy_n(mass.begin() + 4, 9, part.mass.inertia.data());
  part.area = r.rows<double>("area", 1)[0];
  const auto color = r.rows<float>("color", 4);
  std::copy(color.begin(), color.end(), part.color.begin());
  const auto flags = r.rows<std::uint8_t>("flags", 2);
  part.watertight = flags[0] != 0;
  part.exact = flags[1] != 0;
  part.notes = lines_of(r.values<std::uint8_t>("notes"));
  return part;
}

}  // namespace verisim
