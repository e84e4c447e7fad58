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

/// By which motion the one of two faces at a convex edge is told that decides at a place. Free: the one that will be
/// passed last. A place that lies on one of them slides along that one and does not stumble over the other; what it
/// would do without contact says nothing there, but how it moved before does.
enum class Rule : std::uint8_t { as_is, as_free, as_before };
Rule rule_of(double a, double b) {
  if (a >= 0 && b >= 0) return Rule::as_free;
  return std::max(a, b) >= 0 && std::min(a, b) > -kFlush ? Rule::as_before : Rule::as_is;
}

/// One number for each sample of a run.
using OfRun = std::array<double, kRun>;

/// A run against one face, at its segments' middles.
struct Sight {
  OfRun distance, change;  ///< m, as in Measure
};

/// By how much the face across an edge is farther away than this one, which then does not decide.
struct Lead {
  OfRun now, by_rule;  ///< m
  std::array<Rule, kRun> rule;
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
  void hide_beyond_an_edge(const PlacedFeature& placed, const Run& run, std::uint32_t face, const Sight& sight,
                           std::span<double> ahead) const;
  [[nodiscard]] Lead lead_of(const PreciseSurface& other, const PreciseSurface& mine, const PlacedFeature& placed,
                             const Run& run, const Sight& sight) const;
  [[nodiscard]] const ExactEdge* hiding_edge(const Vector3d& p, std::uint32_t face) const;
  [[nodiscard]] bool is_hidden_by(const ExactEdge& edge, std::uint32_t face, const Vector3d& p, double distance) const;
  template <typename F>
  void measure_all(const CurveFromSurface& curve, const Run& run, F&& f) const;
  void meet_group(const PlacedFeature& placed, const CurveFromSurface& curve, std::uint32_t begin,
                  std::span<double> ahead, std::uint32_t face);
  [[nodiscard]] CurveFromSurface seen_from(const PreciseSurface& surface, const PlacedFeature& placed,
                                           const Twist& twist) const {
    return exact::seen_from(surface, placed.origin, placed.x, placed.y, placed.is_arc(), f_.dt * twist.linear,
                            f_.dt * twist.angular);
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
  [[nodiscard]] bool looks_away(const Run& run, const Vector3d& normal) const;
  [[nodiscard]] double lean_weight(std::uint32_t sample, const Vector3d& normal) const;
  [[nodiscard]] double lean_weight_in_mover(std::uint32_t sample, const Vector3d& n) const;
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

/// Calls f(i, its measure) for every sample of the run.
template <typename F>
void Search::measure_all(const CurveFromSurface& curve, const Run& run, F&& f) const {
  const double* c = &mover_.sample_c[run.begin];
  const double* s = &mover_.sample_s[run.begin];
  const std::uint32_t count = run.end - run.begin;
  with_measure(curve, [&](auto&& measure_at) {
    for (std::uint32_t i = 0; i < count; ++i) f(i, measure_at(c[i], s[i]));
  });
}

void Search::meet(std::uint32_t r, std::uint32_t face) {
  const Run& run = mover_.runs[r];
  const Feature& feature = mover_.features[run.feature];
  const PreciseSurface& surface = *base_.faces[face].surface;
  if (feature.against_round_only && !surface.is_convex()) return;
  if (surface.kind() == PreciseSurface::Kind::plane && looks_away(run, surface.axis())) return;
  const PlacedFeature placed{&feature, f_.R * feature.origin + f_.p, f_.R * feature.x, f_.R * feature.y};
  const CurveFromSurface curve = seen_from(surface, placed, f_.twist);
  const std::uint32_t count = run.end - run.begin;
  Sight sight;
  OfRun ahead;  // m, estimate of how near at the end of the step; kNever: out of reach
  bool any = false;
  measure_all(curve, run, [&](std::uint32_t i, const Measure& m) {
    const double nearest = nearest_of(m, feature.half_width) - feature.radius;
    sight.distance[i] = m.distance;
    sight.change[i] = m.change;
    ahead[i] = nearest < f_.margin ? nearest + m.change : kNever;
    any = any || nearest < f_.margin;
  });
  cost_.samples += count;
  if (!any) return;
  if (feature.own_face == kNoFace && count > 1) hide_beyond_an_edge(placed, run, face, sight, ahead);
  for (std::uint32_t i = 0; i < count; i += feature.group) {
    const std::uint32_t size = std::min(feature.group, count - i);
    meet_group(placed, curve, run.begin + i, std::span(ahead).subspan(i, size), face);
  }
}

/// A convex edge of the face beyond which a place near the face lies, if there is one.
const ExactEdge* Search::hiding_edge(const Vector3d& p, std::uint32_t face) const {
  const SurfaceAt mine = base_.faces[face].surface->at(p);
  const Trim::Answer answer = base_.faces[face].trim->find(*base_.faces[face].surface, p - mine.distance * mine.normal);
  for (const std::uint32_t e : answer.edges) {
    const ExactEdge& edge = base_.edges[e];
    if (edge.fold != Fold::convex) continue;
    const SurfaceAt other = base_.faces[across(edge, face)].surface->at(p);
    if (edge.speaks_for(p, other.distance) && !decides(p, mine, other, false)) return &edge;
  }
  return nullptr;
}

/// Is the edge one of those near a place of the face, and does it speak for it?
bool Search::is_hidden_by(const ExactEdge& edge, std::uint32_t face, const Vector3d& p, double distance) const {
  const auto number = static_cast<std::uint32_t>(&edge - base_.edges.data());
  const Trim::Answer answer = base_.faces[face].trim->find(*base_.faces[face].surface, p);
  return std::find(answer.edges.begin(), answer.edges.end(), number) != answer.edges.end() &&
         edge.speaks_for(p, distance);
}

Lead Search::lead_of(const PreciseSurface& other, const PreciseSurface& mine, const PlacedFeature& placed,
                     const Run& run, const Sight& sight) const {
  Lead lead;
  bool some_before = false;
  bool some_free = false;
  measure_all(seen_from(other, placed, f_.before), run, [&](std::uint32_t i, const Measure& m) {
    lead.now[i] = m.distance - sight.distance[i];
    lead.rule[i] = rule_of(sight.distance[i], m.distance);
    lead.by_rule[i] = lead.now[i] + (lead.rule[i] == Rule::as_before ? m.change : 0);
    some_before = some_before || lead.rule[i] == Rule::as_before;
    some_free = some_free || lead.rule[i] == Rule::as_free;
  });
  if (some_before) {
    measure_all(seen_from(mine, placed, f_.before), run, [&](std::uint32_t i, const Measure& m) {
      if (lead.rule[i] == Rule::as_before) lead.by_rule[i] -= m.change;
    });
  }
  if (some_free) {
    measure_all(seen_from(other, placed, f_.twist), run, [&](std::uint32_t i, const Measure& m) {
      if (lead.rule[i] == Rule::as_free) lead.by_rule[i] += m.change - sight.change[i];
    });
  }
  return lead;
}

/// Takes out the samples that the face across a convex edge hides, a group at a time: what `admit` would find of them
/// one by one. Where two bodies lie flush these are most of those that are near. @pre one of them is near
void Search::hide_beyond_an_edge(const PlacedFeature& placed, const Run& run, std::uint32_t face, const Sight& sight,
                                 std::span<double> ahead) const {
  const std::uint32_t count = run.end - run.begin;
  const auto place = [&](std::uint32_t i) {
    return placed.point({0, mover_.sample_c[run.begin + i], mover_.sample_s[run.begin + i]});
  };
  std::uint32_t first = 0;
  while (ahead[first] == kNever) ++first;
  const ExactEdge* edge = hiding_edge(place(first), face);
  if (edge == nullptr) return;
  const Lead lead = lead_of(*base_.faces[across(*edge, face)].surface, *base_.faces[face].surface, placed, run, sight);
  // From a segment's middle to its end the lead changes by half of what it does to the next middle: twice that is
  // asked.
  const auto leads_to = [&](std::uint32_t i, std::uint32_t next) {
    return lead.rule[next] == lead.rule[i] && lead.now[i] > std::abs(lead.now[i] - lead.now[next]) &&
           lead.by_rule[i] > std::abs(lead.by_rule[i] - lead.by_rule[next]);
  };
  const auto leads = [&](std::uint32_t i) {
    return ahead[i] == kNever || ((i == 0 || leads_to(i, i - 1)) && (i + 1 == count || leads_to(i, i + 1)));
  };
  const auto speaks = [&](std::uint32_t i) {
    return ahead[i] == kNever || is_hidden_by(*edge, face, place(i), sight.distance[i] + lead.now[i]);
  };
  const std::uint32_t group = placed.feature->group;
  for (std::uint32_t begin = first / group * group; begin < count; begin += group) {
    const std::uint32_t end = std::min(begin + group, count);
    bool is_hidden = speaks(begin) && speaks(end - 1);
    for (std::uint32_t i = begin; is_hidden && i < end; ++i) is_hidden = leads(i);
    if (is_hidden) std::fill(ahead.begin() + begin, ahead.begin() + end, kNever);
  }
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
  return slide(seen_from(surface, placed, f_.twist), mover_.sample_c[sample], mover_.sample_s[sample],
               placed.feature->half_width);
}

/// Where two faces meet in a convex edge: is `mine` the one that decides at this place?
bool Search::decides(const Vector3d& p, const SurfaceAt& mine, const SurfaceAt& other, bool first) const {
  double a = mine.distance;
  double b = other.distance;
  const Rule rule = rule_of(a, b);
  if (rule != Rule::as_is) {
    const Vector3d way = moved(p, rule == Rule::as_free ? f_.twist : f_.before);
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
    if (edge.fold == Fold::smooth) continue;
    const SurfaceAt there = base_.faces[other].surface->at(c.p);
    if (!edge.speaks_for(c.p, there.distance)) continue;
    if (edge.fold == Fold::concave) {
      // Behind the face across: where the wall there is thin, a place outside of the body on its far side.
      if (there.distance < -f_.margin) return false;
      continue;
    }
    if (decides(c.p, c.at, there, face < other)) continue;
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
  return lean_weight_in_mover(sample, f_.R.transpose() * normal);
}

/// @param n  the normal in the mover's coordinates
double Search::lean_weight_in_mover(std::uint32_t sample, const Vector3d& n) const {
  double lean = 0;
  for (std::uint32_t i = mover_.wedge_begin[sample]; i < mover_.wedge_begin[sample + 1]; ++i)
    lean = std::max(lean, -n.dot(mover_.wedges[i]));
  return std::clamp((kLeanNone - lean) / (kLeanNone - kLeanFree), 0.0, 1.0);
}

/// Does a plane look the wrong way for all of a run?
bool Search::looks_away(const Run& run, const Vector3d& normal) const {
  const Vector3d n = f_.R.transpose() * normal;
  for (std::uint32_t i = run.begin; i < run.end; ++i)
    if (lean_weight_in_mover(i, n) > 0) return false;
  return true;
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
