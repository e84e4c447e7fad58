#include "engine/ruler/csg.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>

#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim::ruler {

namespace {

/// In four parts: all of the plane of `middle` within the radius of its origin.
void add_disc(std::vector<Face>& faces, Face middle, double radius) {
  constexpr int kParts = 4;
  middle.z = middle.x.cross(middle.y);
  middle.is_polar = true;
  middle.v_low = 0;
  middle.v_high = radius;
  for (int i = 0; i < kParts; ++i) {
    middle.u_low = i * pinned::kFullTurn / kParts;
    middle.u_high = (i + 1) * pinned::kFullTurn / kParts;
    faces.push_back(middle);
  }
}

/// The circle in which a round divider crosses a plane that its axis stands upright on.
struct Circle {
  Vector3d middle;
  double radius;  ///< 0: there is none
};

Circle circle_on(const Face& face, const Divider& round) {
  const double height = face.z.dot(round.point - face.origin);
  const Vector3d middle = round.point - height * face.z;
  if (round.kind == Divider::Kind::sphere)
    return {middle, std::sqrt(std::max(0.0, round.radius * round.radius - height * height))};
  if (round.kind == Divider::Kind::plane || round.axis.cross(face.z).norm() > 1e-9) return {middle, 0};
  if (round.kind == Divider::Kind::cylinder) return {middle, round.radius};
  if (round.kind == Divider::Kind::cone)
    return {middle, std::max(0.0, -height * round.axis.dot(face.z)) * round.sine / round.cosine};
  return {middle, std::abs(height) < round.radius ? round.ring + round.radius : 0};
}

}  // namespace

/// Recursive descent over "difference(box(1,1,1),placed(0,0,0;0,0,0,1;cylinder(0.1,2)))".
class CsgReader {
 public:
  CsgReader(std::string_view text, Csg& csg) : text_(text), rest_(text), csg_(csg) {}

  void read() {
    solid(Pose{}, 0);
    if (!rest_.empty()) wrong("more behind its end");
  }

 private:
  using Operation = Csg::Operation;
  static constexpr int kDepthMax = 20'000;

  [[noreturn]] void wrong(const char* what) const {
    fail(ErrorKind::input, "the text of a solid has {} at character {}; it is not one that verisim wrote", what,
         text_.size() - rest_.size() + 1);
  }
  bool take(char c) {
    if (rest_.empty() || rest_.front() != c) return false;
    rest_.remove_prefix(1);
    return true;
  }
  void need(char c) {
    if (!take(c)) wrong("something unexpected");
  }
  std::string_view word() {
    const std::size_t n = std::min(rest_.find('('), rest_.size());
    const std::string_view found = rest_.substr(0, n);
    rest_.remove_prefix(n);
    need('(');
    return found;
  }
  double number() {
    double value = 0;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    if (error != std::errc{} || !std::isfinite(value)) wrong("no number");
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return value;
  }
  template <std::size_t n>
  std::array<double, n> numbers() {
    std::array<double, n> values{};
    for (std::size_t i = 0; i < n; ++i) {
      if (i > 0) need(',');
      values[i] = number();
    }
    return values;
  }

  std::uint32_t add(Operation operation, std::uint32_t first, std::uint32_t second = 0) {
    csg_.nodes_.push_back({operation, first, second});
    return static_cast<std::uint32_t>(csg_.nodes_.size() - 1);
  }
  /// The node of a divider. Surfaces that coincide are one divider: where two primitives touch, what lies between them
  /// is then no surface of their sum.
  std::uint32_t divide(const Divider& divider, std::uint32_t& index) {
    std::vector<Divider>& all = csg_.dividers_;
    bool opposite = false;
    const auto known =
        std::find_if(all.begin(), all.end(), [&](const Divider& d) { return is_same(d, divider, opposite); });
    const bool is_new = known == all.end();
    index = static_cast<std::uint32_t>(known - all.begin());
    if (is_new) all.push_back(divider);
    const std::uint32_t node = add(Operation::divider, index);
    return !is_new && opposite ? add(Operation::complement, node) : node;
  }
  std::uint32_t common(std::initializer_list<std::uint32_t> nodes) {
    std::uint32_t result = *nodes.begin();
    for (auto next = nodes.begin() + 1; next != nodes.end(); ++next) result = add(Operation::greatest, result, *next);
    return result;
  }

  /// A plane across `z` at `at`, with a rectangle of half sizes a, b on it.
  std::uint32_t flat(const Pose& X, const Vector3d& at, const Vector3d& x, const Vector3d& y, double a, double b) {
    const Vector3d normal = x.cross(y);
    std::uint32_t index = 0;
    const std::uint32_t node =
        divide({.kind = Divider::Kind::plane, .point = X * at, .axis = X.rotation * normal}, index);
    if (a > 0 && b > 0)
      csg_.faces_.push_back({index, X * at, X.rotation * x, X.rotation * y, X.rotation * normal, -a, a, -b, b});
    return node;
  }
  std::uint32_t round(const Pose& X, const Divider& divider, double v_low, double v_high, bool is_upside_down = false) {
    Divider at_place = ruler::placed(divider, X);
    std::uint32_t index = 0;
    const std::uint32_t node = divide(at_place, index);
    const Vector3d y = is_upside_down ? Vector3d(-Vector3d::UnitY()) : Vector3d(Vector3d::UnitY());
    constexpr int kParts = 4;
    for (int i = 0; i < kParts; ++i)
      csg_.faces_.push_back({index, at_place.point, X.rotation * Vector3d::UnitX(), X.rotation * y, at_place.axis,
                             i * pinned::kFullTurn / kParts, (i + 1) * pinned::kFullTurn / kParts, v_low, v_high});
    return node;
  }
  std::uint32_t disc(const Pose& X, double z, double radius) {
    const Vector3d y = z > 0 ? Vector3d(Vector3d::UnitY()) : Vector3d(-Vector3d::UnitY());
    const std::uint32_t node = flat(X, {0, 0, z}, Vector3d::UnitX(), y, 0, 0);
    const Face middle{.divider = csg_.nodes_[index_below(node)].first,
                      .origin = X * Vector3d(0, 0, z),
                      .x = X.rotation * Vector3d::UnitX(),
                      .y = X.rotation * y};
    if (radius > 0) add_disc(csg_.faces_, middle, radius);  // an apex has no disc
    return node;
  }
  /// A divider's own node: itself, or what a complement is of.
  [[nodiscard]] std::uint32_t index_below(std::uint32_t node) const {
    return csg_.nodes_[node].operation == Operation::complement ? csg_.nodes_[node].first : node;
  }
  std::uint32_t cylinder_side(const Pose& X, double radius, double height) {
    return round(X, {.kind = Divider::Kind::cylinder, .radius = radius}, -0.5 * height, 0.5 * height);
  }

  std::uint32_t box(const Pose& X) {
    const auto [a, b, c] = numbers<3>();
    const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
    const double u = 0.5 * a, v = 0.5 * b, w = 0.5 * c;
    return common({flat(X, u * x, y, z, v, w), flat(X, -u * x, z, y, w, v), flat(X, v * y, z, x, w, u),
                   flat(X, -v * y, x, z, u, w), flat(X, w * z, x, y, u, v), flat(X, -w * z, y, x, v, u)});
  }
  std::uint32_t cylinder(const Pose& X) {
    const auto [radius, height] = numbers<2>();
    return common({cylinder_side(X, radius, height), disc(X, 0.5 * height, radius), disc(X, -0.5 * height, radius)});
  }
  std::uint32_t tube(const Pose& X) {
    const auto [outer, inner, height] = numbers<3>();
    const std::uint32_t hole = add(Operation::complement, cylinder_side(X, inner, height));
    return common({cylinder_side(X, outer, height), hole, disc(X, 0.5 * height, outer), disc(X, -0.5 * height, outer)});
  }
  std::uint32_t cone(const Pose& X) {
    const auto [radius1, radius2, height] = numbers<3>();
    std::uint32_t side = 0;
    if (radius1 == radius2) {
      side = cylinder_side(X, radius1, height);
    } else {
      const double slope = (radius2 - radius1) / height;  // of the radius along z
      const double slant = std::sqrt(1 + slope * slope);
      const double up = slope > 0 ? 1 : -1;
      const Divider surface{.kind = Divider::Kind::cone,
                            .point = {0, 0, -0.5 * height - radius1 / slope},
                            .axis = {0, 0, up},
                            .sine = std::abs(slope) / slant,
                            .cosine = 1 / slant};
      const double least = std::min(radius1, radius2), greatest = std::max(radius1, radius2);
      side = round(X, surface, least / surface.sine, greatest / surface.sine, up < 0);
    }
    std::uint32_t result = side;
    for (const auto& [z, radius] : {std::pair{-0.5 * height, radius1}, {0.5 * height, radius2}}) {
      // Where the radius is 0 the plane through the apex cuts off the cone's other half.
      result = add(Operation::greatest, result, disc(X, z, radius));
    }
    return result;
  }
  std::uint32_t sphere(const Pose& X) {
    const double radius = number();
    return round(X, {.kind = Divider::Kind::sphere, .radius = radius}, -0.25 * pinned::kFullTurn,
                 0.25 * pinned::kFullTurn);
  }
  std::uint32_t torus(const Pose& X) {
    const auto [ring, radius] = numbers<2>();
    const Divider at_place = ruler::placed({.kind = Divider::Kind::torus, .radius = radius, .ring = ring}, X);
    std::uint32_t index = 0;
    const std::uint32_t node = divide(at_place, index);
    constexpr double kQuarter = 0.25 * pinned::kFullTurn;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        csg_.faces_.push_back({index, at_place.point, X.rotation * Vector3d::UnitX(), X.rotation * Vector3d::UnitY(),
                               at_place.axis, i * kQuarter, (i + 1) * kQuarter, j * kQuarter, (j + 1) * kQuarter});
    return node;
  }
  Pose placement() {
    Pose X;
    const auto p = numbers<3>();
    need(';');
    const auto q = numbers<4>();
    need(';');
    X.position = {p[0], p[1], p[2]};
    X.rotation.coeffs() = Eigen::Vector4d(q[0], q[1], q[2], q[3]);
    if (!(std::abs(X.rotation.norm() - 1) < 1e-6)) wrong("no rotation");
    X.rotation.normalize();
    return X;
  }

  std::uint32_t solid(const Pose& X, int depth) {
    if (depth > kDepthMax) wrong("too many solids within each other");
    const std::string_view kind = word();
    std::uint32_t node = 0;
    if (kind == "box")
      node = box(X);
    else if (kind == "cylinder")
      node = cylinder(X);
    else if (kind == "cone")
      node = cone(X);
    else if (kind == "sphere")
      node = sphere(X);
    else if (kind == "tube")
      node = tube(X);
    else if (kind == "torus")
      node = torus(X);
    else if (kind == "placed") {
      const Pose inner = placement();
      node = solid(X * inner, depth + 1);
    } else if (kind == "difference" || kind == "sum" || kind == "intersection") {
      const std::uint32_t first = solid(X, depth + 1);
      need(',');
      std::uint32_t second = solid(X, depth + 1);
      if (kind == "difference") second = add(Operation::complement, second);
      node = add(kind == "sum" ? Operation::least : Operation::greatest, first, second);
    } else {
      wrong("an unknown word");
    }
    need(')');
    return node;
  }

  std::string_view text_, rest_;
  Csg& csg_;
};

namespace {

/// A ball around a face, round ones taken as whole turns.
struct Ball {
  Vector3d middle;
  double radius;
};

Ball around(const Face& face, const Divider& divider) {
  const double v = 0.5 * (face.v_low + face.v_high), half = 0.5 * (face.v_high - face.v_low);
  switch (divider.kind) {
    case Divider::Kind::plane:
      return {face.origin, face.is_polar ? face.v_high : hypotenuse(face.u_high, face.v_high)};
    case Divider::Kind::sphere:
      return {face.origin, divider.radius};
    case Divider::Kind::cylinder:
      return {face.origin + v * face.z, hypotenuse(divider.radius, half)};
    case Divider::Kind::torus:
      return {face.origin, divider.ring + divider.radius};
    case Divider::Kind::cone:
      return {face.origin + v * divider.cosine * face.z, hypotenuse(face.v_high * divider.sine, half * divider.cosine)};
  }
  return {};
}

}  // namespace

Csg::Csg(std::string_view text) {
  CsgReader(text, *this).read();
  find_senses();
  add_discs();
  for (const Face& face : faces_) middle_ += face.origin / static_cast<double>(faces_.size());
  for (const Face& face : faces_) {
    const Ball ball = around(face, dividers_[face.divider]);
    radius_ = std::max(radius_, (ball.middle - middle_).norm() + ball.radius);
  }
}

double Csg::value(std::span<const double> values) const {
  VERISIM_ASSERT(values.size() == dividers_.size());
  thread_local std::vector<double> at;  // of the nodes
  at.resize(nodes_.size());
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Node& node = nodes_[i];
    switch (node.operation) {
      case Operation::divider:
        at[i] = values[node.first];
        break;
      case Operation::complement:
        at[i] = -at[node.first];
        break;
      case Operation::least:
        at[i] = std::min(at[node.first], at[node.second]);
        break;
      case Operation::greatest:
        at[i] = std::max(at[node.first], at[node.second]);
        break;
    }
  }
  return at.back();
}

int Csg::side(std::span<const std::int8_t> sides) const {
  VERISIM_ASSERT(sides.size() == dividers_.size());
  thread_local std::vector<std::int8_t> at;  // of the nodes
  at.resize(nodes_.size());
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const Node& node = nodes_[i];
    switch (node.operation) {
      case Operation::divider:
        at[i] = sides[node.first];
        break;
      case Operation::complement:
        at[i] = static_cast<std::int8_t>(-at[node.first]);
        break;
      case Operation::least:
        at[i] = std::min(at[node.first], at[node.second]);
        break;
      case Operation::greatest:
        at[i] = std::max(at[node.first], at[node.second]);
        break;
    }
  }
  return at.back();
}

/// Around holes and posts a plane is searched in polar coordinates, in which their rims are straight.
void Csg::add_discs() {
  constexpr double kSame = 1e-11, kBeyond = 1.5;  // how far around a rim
  const std::size_t count = faces_.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (dividers_[faces_[i].divider].kind != Divider::Kind::plane || faces_[i].is_polar) continue;
    std::vector<Circle> circles;
    for (const Divider& divider : dividers_) {
      const Circle circle = circle_on(faces_[i], divider);
      const Vector3d from = circle.middle - faces_[i].origin;
      const bool is_beside = std::abs(from.dot(faces_[i].x)) > faces_[i].u_high + circle.radius ||
                             std::abs(from.dot(faces_[i].y)) > faces_[i].v_high + circle.radius;
      if (circle.radius == 0 || is_beside) continue;
      const auto known = std::find_if(circles.begin(), circles.end(),
                                      [&](const Circle& c) { return (c.middle - circle.middle).norm() < kSame; });
      if (known == circles.end())
        circles.push_back(circle);
      else
        known->radius = std::max(known->radius, circle.radius);
    }
    for (const Circle& circle : circles) {
      const auto is_it = [&](const Face& face) {
        return face.is_polar && face.divider == faces_[i].divider && (face.origin - circle.middle).norm() < kSame;
      };
      if (std::none_of(faces_.begin(), faces_.end(), is_it)) {
        Face middle = faces_[i];
        middle.origin = circle.middle;
        middle.discs.clear();
        add_disc(faces_, middle, 0);
      }
      faces_[i].discs.push_back(
          static_cast<std::uint32_t>(std::find_if(faces_.begin(), faces_.end(), is_it) - faces_.begin()));
      for (Face& face : faces_)
        if (is_it(face)) face.v_high = std::max(face.v_high, kBeyond * circle.radius);
    }
  }
}

void Csg::find_senses() {
  std::vector<std::uint8_t> sense_of_node(nodes_.size(), 0), sense(dividers_.size(), 0);  // 1: as it is, 2: opposite
  sense_of_node.back() = 1;
  for (std::size_t i = nodes_.size(); i-- > 0;) {
    const Node& node = nodes_[i];
    const std::uint8_t here = sense_of_node[i];
    if (node.operation == Operation::divider) {
      sense[node.first] |= here;
    } else if (node.operation == Operation::complement) {
      sense_of_node[node.first] = static_cast<std::uint8_t>(here ^ 3U);
    } else {
      sense_of_node[node.first] = sense_of_node[node.second] = here;
    }
  }
  for (std::uint32_t i = 0; i < sense.size(); ++i)
    if (sense[i] == 3) of_both_senses_.push_back(i);
}

Csg Csg::placed(const Pose& X) const {
  Csg result = *this;
  result.middle_ = X * middle_;
  for (Divider& divider : result.dividers_) divider = ruler::placed(divider, X);
  for (Face& face : result.faces_) {
    face.origin = X * face.origin;
    face.x = X.rotation * face.x;
    face.y = X.rotation * face.y;
    face.z = X.rotation * face.z;
  }
  return result;
}

}  // namespace verisim::ruler
