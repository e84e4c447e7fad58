#include "engine/exact/search.hpp"

#include "engine/exact/slide.hpp"

namespace verisim::exact {
namespace {

// A contact whose normal leans away from all that the mover can touch with fades out between these sines.
constexpr double kLeanFree = 0.42;  // 25 degrees
constexpr double kLeanNone = 0.64;  // 40 degrees
// A ball that a curve carries is the body's boundary where it touches the face it belongs to; elsewhere it is within
// the body. Contacts fade out between these distances of their place from the face: a segment's end, where the nearest
// place lies in the next segment, shall not stand for it.
constexpr double kOwnFree = 1e-7;  // m
constexpr double kOwnNone = 1e-6;
// A segment that slopes towards the surface touches with a part of its length only.
constexpr double kTouching = 1e-6;  // m: what is as near as this counts as touching
constexpr double kFlush = 1e-7;     // m: what lies in a face's plane overlaps it by less
constexpr double kNever = std::numeric_limits<double>::infinity();

/// A feature in the coordinates of the base.
struct PlacedFeature {
  const Feature* feature;
  Vector3d origin, x, y;
  [[nodiscard]] bool is_arc() const { return feature->kind == Feature::Kind::arc; }
  [[nodiscard]] Vector3d point(const Place& at) const { return origin + at.c * x + at.s * y; }
  [[nodiscard]] Vector3d tangent(const Place& at) const { return is_arc() ? Vector3d(at.c * y - at.s * x) : x; }
};

/// A row in the making.
struct Candidate {
  std::uint32_t group = 0;  ///< its first sample
  std::uint32_t sample = 0;
  Place place{};
  Vector3d p;  ///< m, the place on the curve
  SurfaceAt at{};
  double gap = 0;
  double gap_ahead = 0;  ///< m, at the end of the step if nothing came between
  Vector3d normal;
  double edge_share = 0;  ///< 0: against a face, up to 1: against the middle of an edge's fold
  double weight = 1;      ///< less where the place is not the mover's boundary
};

std::uint32_t across(const ExactEdge& edge, std::uint32_t face) {
  return edge.faces[0] == face ? edge.faces[1] : edge.faces[0];
}

/// On which side of a smooth edge a point lies: true if beyond it, seen from the face.
bool is_beyond(const ExactEdge& edge, std::uint32_t face, const Vector3d& p) {
  const ExactEdge::Mark* nearest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const ExactEdge::Mark& mark : edge.marks) {
    const double distance = (mark.point - p).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    nearest = &mark;
  }
  return nearest != nullptr && nearest->out_of[edge.faces[0] == face ? 0 : 1].dot(p - nearest->point) > 0;
}

/// Does a point of a face's surface belong to the face?
bool is_on_face(const ExactBody& body, std::uint32_t face, const Vector3d& foot) {
  const Trim::Answer answer = body.faces[face].trim->find(*body.faces[face].surface, foot);
  if (answer.where != Trim::Where::border) return answer.where == Trim::Where::inside;
  for (const std::uint32_t e : answer.edges) {
    const ExactEdge& edge = body.edges[e];
    if (edge.fold == Fold::smooth) {
      if (is_beyond(edge, face, foot)) return false;
    } else {
      const double distance = body.faces[across(edge, face)].surface->at(foot).distance;
      if (!edge.speaks_for(foot, distance)) continue;
      if (edge.fold == Fold::convex ? distance > 0 : distance < 0) return false;
    }
  }
  return true;
}

class Search {
 public:
  Search(const ExactBody& mover, const ExactBody& base, const SearchFrame& frame, RowList& rows, SearchCost& cost)
      : mover_(mover), base_(base), f_(frame), rows_(rows), cost_(cost) {}

  double run(NodePairs& stack);

 private:
  void meet(std::uint32_t run, std::uint32_t face);
  void meet_group(const PlacedFeature& placed, const CurveFromSurface& curve, std::uint32_t begin,
                  std::span<double> ahead, std::uint32_t face);
  [[nodiscard]] CurveFromSurface seen_from(const PreciseSurface& surface, const PlacedFeature& placed) const {
    return exact::seen_from(surface, placed.origin, placed.x, placed.y, placed.is_arc(), f_.dt * f_.twist.linear,
                            f_.dt * f_.twist.angular);
  }
  [[nodiscard]] Vector3d moved(const Vector3d& p, const Twist& twist) const {
    return f_.dt * (twist.linear + twist.angular.cross(p));
  }
  [[nodiscard]] Place slide_to(const PreciseSurface& surface, const PlacedFeature& placed, std::uint32_t sample) const;
  [[nodiscard]] bool admit(const PlacedFeature& placed, std::uint32_t face, Candidate& c) const;
  [[nodiscard]] bool cross_edge(const PlacedFeature& placed, std::uint32_t face, std::uint32_t other,
                                Candidate& c) const;
  [[nodiscard]] bool is_outermost(const Candidate& c, std::uint32_t face, std::uint32_t other) const;
  [[nodiscard]] bool decides(const Vector3d& p, const SurfaceAt& mine, const SurfaceAt& other, bool first) const;
  [[nodiscard]] double lean_weight(std::uint32_t sample, const Vector3d& normal) const;
  [[nodiscard]] static double touching_share(const PlacedFeature& placed, const Candidate& c, std::uint32_t count);
  void add(const Candidate& c, const Feature& feature, double weight, std::uint32_t count, std::uint32_t face);

  const ExactBody& mover_;
  const ExactBody& base_;
  const SearchFrame& f_;
  RowList& rows_;
  SearchCost& cost_;
  double depth_max_ = 0;
};

/// Descends both trees; the order of the pairs does not depend on the poses.
double Search::run(NodePairs& stack) {
  const auto& runs = mover_.run_tree.nodes;
  const auto& faces = base_.face_tree.nodes;
  if (runs.empty() || faces.empty()) return 0;
  stack.clear();
  stack.emplace_back(0, 0);
  while (!stack.empty()) {
    const auto [g, s] = stack.back();
    stack.pop_back();
    const BoxTree::Node& run = runs[g];
    const BoxTree::Node& face = faces[s];
    const Vector3d reach = f_.R.cwiseAbs() * run.half + face.half + Vector3d::Constant(f_.margin);
    if (((f_.R * run.center + f_.p - face.center).cwiseAbs().array() > reach.array()).any()) continue;
    const bool run_is_leaf = run.right == BoxTree::kLeaf;
    const bool face_is_leaf = face.right == BoxTree::kLeaf;
    if (run_is_leaf && face_is_leaf) {
      meet(run.left, face.left);
    } else if (face_is_leaf || (!run_is_leaf && run.half.squaredNorm() > face.half.squaredNorm())) {
      stack.emplace_back(run.right, s);
      stack.emplace_back(run.left, s);
    } else {
      stack.emplace_back(g, face.right);
      stack.emplace_back(g, face.left);
    }
  }
  return depth_max_;
}

void Search::meet(std::uint32_t r, std::uint32_t face) {
  const Run& run = mover_.runs[r];
  const Feature& feature = mover_.features[run.feature];
  const PreciseSurface& surface = *base_.faces[face].surface;
  if (feature.against_round_only && !surface.is_convex()) return;
  const PlacedFeature placed{&feature, f_.R * feature.origin + f_.p, f_.R * feature.x, f_.R * feature.y};
  const CurveFromSurface curve = seen_from(surface, placed);
  const std::uint32_t count = run.end - run.begin;
  std::array<double, kRun> nearest;
  std::array<double, kRun> ahead;
  const double* c = &mover_.sample_c[run.begin];
  const double* s = &mover_.sample_s[run.begin];
  with_measure(curve, [&](auto&& measure_at) {
    for (std::uint32_t i = 0; i < count; ++i) {
      const Measure m = measure_at(c[i], s[i]);
      nearest[i] = nearest_of(m, feature.half_width) - feature.radius;
      ahead[i] = nearest[i] + m.change;
    }
  });
  for (std::uint32_t i = 0; i < count; ++i)
    if (!(nearest[i] < f_.margin)) ahead[i] = kNever;
  cost_.samples += count;
  for (std::uint32_t i = 0; i < count; i += feature.group)
    meet_group(placed, curve, run.begin + i, std::span(ahead).subspan(i, std::min(feature.group, count - i)), face);
}

/// One row for that of a group's samples, of those that are near enough and that the face admits, which will be nearest
/// at the end of the step. `ahead`: how near about; used up.
void Search::meet_group(const PlacedFeature& placed, const CurveFromSurface& curve, std::uint32_t begin,
                        std::span<double> ahead, std::uint32_t face) {
  const Feature& feature = *placed.feature;
  const PreciseSurface& surface = *base_.faces[face].surface;
  Candidate best;
  best.gap_ahead = kNever;
  while (true) {
    const auto next = std::min_element(ahead.begin(), ahead.end());
    if (!(*next < best.gap_ahead)) break;
    Candidate c;
    c.group = begin;
    c.sample = begin + static_cast<std::uint32_t>(next - ahead.begin());
    *next = kNever;
    ++cost_.slides;
    c.place = slide(curve, mover_.sample_c[c.sample], mover_.sample_s[c.sample], feature.half_width);
    c.p = placed.point(c.place);
    c.at = surface.at(c.p);
    c.gap = c.at.distance - feature.radius;
    if (c.gap >= f_.margin || c.gap < -base_.options.spacing) continue;
    c.normal = c.at.normal;
    if (!admit(placed, face, c) || c.gap >= f_.margin) continue;
    c.gap_ahead = c.gap + c.normal.dot(moved(c.p, f_.twist));
    if (c.gap_ahead < best.gap_ahead) best = c;
  }
  if (best.gap_ahead == kNever) return;
  const auto count = static_cast<std::uint32_t>(ahead.size());
  const double share = touching_share(placed, best, count);
  add(best, feature, best.weight * share * lean_weight(best.sample, best.normal), count, face);
}

/// How much of a group's length touches: the overlap at its nearest place is used up where the group, sloping, comes
/// out of the surface.
double Search::touching_share(const PlacedFeature& placed, const Candidate& c, std::uint32_t count) {
  const double rise = std::abs(c.normal.dot(placed.tangent(c.place))) * 2 * placed.feature->half_width * count;
  const double overlap = kTouching + std::max(0.0, -c.gap);
  return rise > overlap ? overlap / rise : 1;
}

Place Search::slide_to(const PreciseSurface& surface, const PlacedFeature& placed, std::uint32_t sample) const {
  return slide(seen_from(surface, placed), mover_.sample_c[sample], mover_.sample_s[sample],
               placed.feature->half_width);
}

/// Where two faces meet in a convex edge: is `mine` the one that decides at this place?
bool Search::decides(const Vector3d& p, const SurfaceAt& mine, const SurfaceAt& other, bool first) const {
  double a = mine.distance;
  double b = other.distance;
  // Free: the one that will be passed last. A place that lies on one of them slides along that one and does not stumble
  // over the other; what it would do without contact says nothing there.
  const bool is_free = a >= 0 && b >= 0;
  if (is_free || (std::max(a, b) >= 0 && std::min(a, b) > -kFlush)) {
    const Vector3d way = moved(p, is_free ? f_.twist : f_.before);
    a += mine.normal.dot(way);
    b += other.normal.dot(way);
  }
  return a > b || (a == b && first);
}

bool Search::admit(const PlacedFeature& placed, std::uint32_t face, Candidate& c) const {
  const Feature& feature = *placed.feature;
  const Vector3d foot = c.p - c.at.distance * c.at.normal;
  if (feature.own_face != kNoFace) {
    const Vector3d touching = f_.R.transpose() * (c.p - feature.radius * c.at.normal - f_.p);
    const double within = std::abs(mover_.faces[feature.own_face].surface->at(touching).distance);
    c.weight = std::min(1.0, (kOwnNone - within) / (kOwnNone - kOwnFree));
    return c.weight > 0 && is_on_face(base_, face, foot) && is_on_face(mover_, feature.own_face, touching);
  }
  const Trim::Answer answer = base_.faces[face].trim->find(*base_.faces[face].surface, foot);
  if (answer.where == Trim::Where::outside) return false;
  for (const std::uint32_t e : answer.edges) {
    const ExactEdge& edge = base_.edges[e];
    const std::uint32_t other = across(edge, face);
    if (edge.fold == Fold::smooth && is_beyond(edge, face, foot)) return false;
    if (edge.fold != Fold::convex) continue;
    const SurfaceAt there = base_.faces[other].surface->at(c.p);
    if (!edge.speaks_for(c.p, there.distance) || decides(c.p, c.at, there, face < other)) continue;
    return face < other && cross_edge(placed, face, other, c);
  }
  return true;
}

/// Looks for the place where the sample's segment crosses the edge between two faces: there both distances are equal,
/// and the contact's normal lies across both curves. Changes `c` to it and returns true if there is one.
bool Search::cross_edge(const PlacedFeature& placed, std::uint32_t face, std::uint32_t other, Candidate& c) const {
  const PreciseSurface& a = *base_.faces[face].surface;
  const PreciseSurface& b = *base_.faces[other].surface;
  if (placed.feature->half_width == 0) return false;
  const Place near_b = slide_to(b, placed, c.sample);
  const Vector3d p_b = placed.point(near_b);
  double t_a = c.place.t;  // here b decides
  double t_b = near_b.t;   // here a must
  double d_a = c.at.distance - b.at(c.p).distance;
  double d_b = a.at(p_b).distance - b.at(p_b).distance;
  if (!(d_a < 0 && d_b > 0)) return false;
  SurfaceAt other_at{};
  constexpr int kStepsMax = 6;
  for (int i = 0; i < kStepsMax; ++i) {  // false position, with the Illinois rule
    const double t = t_a + (t_b - t_a) * (d_a / (d_a - d_b));
    c.place = place_at(placed.is_arc(), mover_.sample_c[c.sample], mover_.sample_s[c.sample], t);
    c.p = placed.point(c.place);
    c.at = a.at(c.p);
    other_at = b.at(c.p);
    const double d = c.at.distance - other_at.distance;
    if (std::abs(d) < 1e-12) break;
    if (d < 0) {
      t_a = t;
      d_a = d;
      d_b *= 0.5;
    } else {
      t_b = t;
      d_b = d;
      d_a *= 0.5;
    }
  }
  // The share of either normal that leaves no slope along the segment.
  const Vector3d tangent = placed.tangent(c.place);
  const double slope_a = c.at.normal.dot(tangent);
  const double slope_b = other_at.normal.dot(tangent);
  if (slope_a * slope_b >= 0) return false;
  const double share = slope_b / (slope_b - slope_a);  // of a
  const Vector3d mixed = share * c.at.normal + (1 - share) * other_at.normal;
  const double length = mixed.norm();
  if (length < 0.1) return false;
  c.normal = mixed / length;
  c.gap = c.at.distance / length;
  c.edge_share = 4 * share * (1 - share);
  return c.gap > -base_.options.spacing && is_outermost(c, face, other) && is_outermost(c, other, face);
}

/// Is the candidate's place, on the edge between two faces, within `face` and not beyond a third face next to it?
bool Search::is_outermost(const Candidate& c, std::uint32_t face, std::uint32_t other) const {
  const PreciseSurface& surface = *base_.faces[face].surface;
  const Trim::Answer answer = base_.faces[face].trim->find(surface, c.p - c.at.distance * surface.at(c.p).normal);
  for (const std::uint32_t e : answer.edges) {
    const ExactEdge& edge = base_.edges[e];
    const std::uint32_t third = across(edge, face);
    if (edge.fold != Fold::convex || third == other) continue;
    const double distance = base_.faces[third].surface->at(c.p).distance;
    if (distance > c.at.distance && edge.speaks_for(c.p, distance)) return false;
  }
  return answer.where != Trim::Where::outside;
}

double Search::lean_weight(std::uint32_t sample, const Vector3d& normal) const {
  const Vector3d n = f_.R.transpose() * normal;
  double lean = 0;
  for (std::uint32_t i = mover_.wedge_begin[sample]; i < mover_.wedge_begin[sample + 1]; ++i)
    lean = std::max(lean, -n.dot(mover_.wedges[i]));
  return std::clamp((kLeanNone - lean) / (kLeanNone - kLeanFree), 0.0, 1.0);
}

void Search::add(const Candidate& c, const Feature& feature, double weight, std::uint32_t count, std::uint32_t face) {
  if (weight == 0) return;
  const double point = mover_.options.line_stiffness * mover_.options.point_length;
  const double stiffness = weight * (count * feature.stiffness + c.edge_share * point);
  const Vector3d normal = f_.R_WB * c.normal;
  const Vector3d place = f_.R_WB * (c.p - feature.radius * c.normal) + f_.p_WB;
  const auto faces = static_cast<std::uint32_t>(base_.faces.size());
  const std::uint32_t source = (c.group * faces + face) << 1 | static_cast<std::uint32_t>(f_.mover_is_second);
  rows_.add({f_.mover_is_second ? normal : Vector3d(-normal), place, c.gap, stiffness, source});
  depth_max_ = std::max(depth_max_, -c.gap);
  ++cost_.rows;
}

}  // namespace

double search(const ExactBody& mover, const ExactBody& base, const SearchFrame& frame, NodePairs& stack, RowList& rows,
              SearchCost& cost) {
  return Search(mover, base, frame, rows, cost).run(stack);
}

}  // namespace verisim::exact
