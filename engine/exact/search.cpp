#include "engine/exact/search.hpp"

#include "engine/exact/feature_maker.hpp"
#include "engine/exact/slide.hpp"

namespace verisim::exact {
namespace {

// A contact whose normal leans away from all that the mover can touch with fades out between these sines.
constexpr double kLeanFree = 0.42;  // 25 degrees
constexpr double kLeanNone = 0.64;  // 40 degrees

/// A row in the making.
struct Candidate {
  Slid slid;
  double gap = 0;
  Vector3d normal;
  double edge_share = 0;  ///< 0: against a face, up to 1: against the middle of an edge's fold
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
    } else if (edge.speaks_for(foot)) {
      const double distance = body.faces[across(edge, face)].surface->at(foot).distance;
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
  void meet(std::uint32_t group, std::uint32_t face);
  [[nodiscard]] bool admit(const PlacedFeature& placed, const Sample& sample, std::uint32_t face, Candidate& c) const;
  [[nodiscard]] bool cross_edge(const PlacedFeature& placed, const Sample& sample, std::uint32_t face,
                                std::uint32_t other, Candidate& c) const;
  [[nodiscard]] bool decides(const Slid& slid, const SurfaceAt& mine, const SurfaceAt& other, bool first) const;
  [[nodiscard]] double lean_weight(const Sample& sample, const Vector3d& normal) const;
  void add(const Candidate& c, const Feature& feature, double weight, std::uint32_t group, std::uint32_t face);

  const ExactBody& mover_;
  const ExactBody& base_;
  const SearchFrame& f_;
  RowList& rows_;
  SearchCost& cost_;
  double depth_max_ = 0;
};

/// Descends both trees; the order of the pairs does not depend on the poses.
double Search::run(NodePairs& stack) {
  const auto& groups = mover_.group_tree.nodes;
  const auto& faces = base_.face_tree.nodes;
  if (groups.empty() || faces.empty()) return 0;
  stack.clear();
  stack.emplace_back(0, 0);
  while (!stack.empty()) {
    const auto [g, s] = stack.back();
    stack.pop_back();
    const BoxTree::Node& group = groups[g];
    const BoxTree::Node& face = faces[s];
    const Vector3d reach = f_.R.cwiseAbs() * group.half + face.half + Vector3d::Constant(f_.margin);
    if (((f_.R * group.center + f_.p - face.center).cwiseAbs().array() > reach.array()).any()) continue;
    const bool group_is_leaf = group.right == BoxTree::kLeaf;
    const bool face_is_leaf = face.right == BoxTree::kLeaf;
    if (group_is_leaf && face_is_leaf) {
      meet(group.left, face.left);
    } else if (face_is_leaf || (!group_is_leaf && group.half.squaredNorm() > face.half.squaredNorm())) {
      stack.emplace_back(group.right, s);
      stack.emplace_back(group.left, s);
    } else {
      stack.emplace_back(g, face.right);
      stack.emplace_back(g, face.left);
    }
  }
  return depth_max_;
}

/// One row for a group's nearest sample that the face admits, if it is near enough.
void Search::meet(std::uint32_t g, std::uint32_t face) {
  const Group& group = mover_.groups[g];
  const Feature& feature = mover_.features[group.feature];
  const PreciseSurface& surface = *base_.faces[face].surface;
  if (feature.against_round_only && !surface.is_convex()) return;
  ++cost_.groups;
  const PlacedFeature placed{&feature, f_.R * feature.origin + f_.p, f_.R * feature.x, f_.R * feature.y};
  Candidate best;
  best.gap = f_.margin;
  const Sample* best_sample = nullptr;
  for (std::uint32_t i = group.begin; i < group.end; ++i) {
    const Sample& sample = mover_.samples[i];
    Candidate c;
    evaluate(placed, sample, surface, 0, c.slid);
    if (c.slid.at.distance - feature.radius - feature.reach > best.gap) continue;  // nothing on the segment is nearer
    ++cost_.samples;
    slide(placed, sample, surface, c.slid);
    c.gap = c.slid.at.distance - feature.radius;
    if (c.gap >= best.gap || c.gap < -base_.options.spacing) continue;
    c.normal = c.slid.at.normal;
    if (!admit(placed, sample, face, c) || c.gap >= best.gap) continue;
    best = c;
    best_sample = &sample;
  }
  if (best_sample == nullptr) return;
  add(best, feature, lean_weight(*best_sample, best.normal), g, face);
}

/// Where two faces meet in a convex edge: is `mine` the one that decides at this place?
bool Search::decides(const Slid& slid, const SurfaceAt& mine, const SurfaceAt& other, bool first) const {
  double a = mine.distance;
  double b = other.distance;
  if (a >= 0 && b >= 0) {  // free: the one that will be passed last
    const Vector3d moved = f_.dt * (f_.v + f_.omega.cross(slid.p));
    a += mine.normal.dot(moved);
    b += other.normal.dot(moved);
  }
  return a > b || (a == b && first);
}

bool Search::admit(const PlacedFeature& placed, const Sample& sample, std::uint32_t face, Candidate& c) const {
  const Feature& feature = *placed.feature;
  const Vector3d foot = c.slid.p - c.slid.at.distance * c.slid.at.normal;
  if (feature.own_face != kNoFace) {
    const Vector3d touching = c.slid.p - feature.radius * c.slid.at.normal;
    return is_on_face(base_, face, foot) && is_on_face(mover_, feature.own_face, f_.R.transpose() * (touching - f_.p));
  }
  const Trim::Answer answer = base_.faces[face].trim->find(*base_.faces[face].surface, foot);
  if (answer.where == Trim::Where::outside) return false;
  for (const std::uint32_t e : answer.edges) {
    const ExactEdge& edge = base_.edges[e];
    const std::uint32_t other = across(edge, face);
    if (edge.fold == Fold::smooth && is_beyond(edge, face, foot)) return false;
    if (edge.fold != Fold::convex || !edge.speaks_for(c.slid.p)) continue;
    const SurfaceAt there = base_.faces[other].surface->at(c.slid.p);
    if (decides(c.slid, c.slid.at, there, face < other)) continue;
    return face < other && cross_edge(placed, sample, face, other, c);
  }
  return true;
}

/// Looks for the place where the sample's segment crosses the edge between two faces: there both distances are equal,
/// and the contact's normal lies across both curves. Changes `c` to it and returns true if there is one.
bool Search::cross_edge(const PlacedFeature& placed, const Sample& sample, std::uint32_t face, std::uint32_t other,
                        Candidate& c) const {
  const PreciseSurface& a = *base_.faces[face].surface;
  const PreciseSurface& b = *base_.faces[other].surface;
  if (placed.feature->half_width == 0) return false;
  Slid at_b;
  evaluate(placed, sample, b, 0, at_b);
  slide(placed, sample, b, at_b);
  double t_a = c.slid.t;  // here b decides
  double t_b = at_b.t;    // here a must
  double d_a = c.slid.at.distance - b.at(c.slid.p).distance;
  double d_b = a.at(at_b.p).distance - at_b.at.distance;
  if (!(d_a < 0 && d_b > 0)) return false;
  Slid slid;
  SurfaceAt other_at{};
  constexpr int kStepsMax = 6;
  for (int i = 0; i < kStepsMax; ++i) {  // false position, with the Illinois rule
    const double t = t_a + (t_b - t_a) * (d_a / (d_a - d_b));
    evaluate(placed, sample, a, t, slid);
    other_at = b.at(slid.p);
    const double d = slid.at.distance - other_at.distance;
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
  const double slope_a = slid.slope;
  const double slope_b = other_at.normal.dot(slid.tangent);
  if (slope_a * slope_b >= 0) return false;
  const double share = slope_b / (slope_b - slope_a);  // of a
  const Vector3d mixed = share * slid.at.normal + (1 - share) * other_at.normal;
  const double length = mixed.norm();
  if (length < 0.1) return false;
  c.slid = slid;
  c.normal = mixed / length;
  c.gap = slid.at.distance / length;
  c.edge_share = 4 * share * (1 - share);
  return c.gap > -base_.options.spacing;
}

double Search::lean_weight(const Sample& sample, const Vector3d& normal) const {
  const Vector3d n = f_.R.transpose() * normal;
  double lean = 0;
  for (std::uint32_t i = sample.wedge_begin; i < sample.wedge_end; ++i) lean = std::max(lean, -n.dot(mover_.wedges[i]));
  return std::clamp((kLeanNone - lean) / (kLeanNone - kLeanFree), 0.0, 1.0);
}

void Search::add(const Candidate& c, const Feature& feature, double weight, std::uint32_t group, std::uint32_t face) {
  if (weight == 0) return;
  const Group& g = mover_.groups[group];
  const double point = mover_.options.line_stiffness * mover_.options.point_length;
  const double stiffness = weight * ((g.end - g.begin) * feature.stiffness + c.edge_share * point);
  const Vector3d normal = f_.X_WB.rotation * c.normal;
  const Vector3d place = f_.X_WB * Vector3d(c.slid.p - feature.radius * c.normal);
  const auto faces = static_cast<std::uint32_t>(base_.faces.size());
  const std::uint32_t source = (group * faces + face) << 1 | static_cast<std::uint32_t>(f_.mover_is_second);
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
