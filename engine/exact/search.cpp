#include "engine/exact/search.hpp"

#include "engine/exact/border.hpp"
#include "engine/exact/hidden.hpp"

namespace verisim::exact {
namespace {

class Search {
 public:
  Search(const ExactBody& mover, const ExactBody& base, const SearchFrame& frame, RowList& rows, SearchCost& cost)
      : meeting_{mover, base, frame}, rows_(rows), cost_(cost) {}

  double run(NodePairs& stack);

 private:
  void meet(std::uint32_t run, std::uint32_t face);
  void meet_group(const PlacedFeature& placed, const CurveFromSurface& curve, std::uint32_t begin,
                  std::span<double> ahead, std::uint32_t face);
  [[nodiscard]] bool looks_away(const Run& run, const Vector3d& normal) const;
  [[nodiscard]] double lean_weight(std::uint32_t sample, const Vector3d& normal) const;
  [[nodiscard]] double lean_weight_in_mover(std::uint32_t sample, const Vector3d& n) const;
  [[nodiscard]] double touching_share(const PlacedFeature& placed, const Candidate& c, std::uint32_t count) const;
  [[nodiscard]] bool measure_candidate(const PlacedFeature& placed, std::uint32_t face, std::uint32_t count,
                                       Candidate& c);
  void add_end(const PlacedFeature& placed, const Candidate& best, std::span<const double> about, int side,
               std::uint32_t face);
  void add(const PlacedFeature& placed, const Candidate& c, std::uint32_t count, std::uint32_t face);

  const Meeting meeting_;
  RowList& rows_;
  SearchCost& cost_;
  double depth_max_ = 0;
};

/// Descends both trees; the order of the pairs does not depend on the poses.
double Search::run(NodePairs& stack) {
  const SearchFrame& f = meeting_.frame;
  const auto& runs = meeting_.mover.run_tree.nodes;
  const auto& faces = meeting_.base.face_tree.nodes;
  if (runs.empty() || faces.empty()) return 0;
  stack.clear();
  stack.emplace_back(0, 0);
  while (!stack.empty()) {
    const auto [g, s] = stack.back();
    stack.pop_back();
    const BoxTree::Node& run = runs[g];
    const BoxTree::Node& face = faces[s];
    const Vector3d reach = f.R.cwiseAbs() * run.half + face.half + Vector3d::Constant(f.margin);
    if (((f.R * run.center + f.p - face.center).cwiseAbs().array() > reach.array()).any()) continue;
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
  const SearchFrame& f = meeting_.frame;
  const Run& run = meeting_.mover.runs[r];
  const Feature& feature = meeting_.mover.features[run.feature];
  const PreciseSurface& surface = *meeting_.base.faces[face].surface;
  if (feature.against_round_only && !surface.is_convex()) return;
  if (surface.kind() == PreciseSurface::Kind::plane && looks_away(run, surface.axis())) return;
  const PlacedFeature placed{&feature, f.R * feature.origin + f.p, f.R * feature.x, f.R * feature.y};
  const CurveFromSurface curve = meeting_.seen_from(surface, placed, f.twist);
  const std::uint32_t count = run.end - run.begin;
  const double* c = &meeting_.mover.sample_c[run.begin];
  Sight sight;
  OfRun ahead;  // m, estimate of how near at the end of the step; kNever: out of reach
  bool any = false;
  meeting_.measure_all(curve, run, [&](std::uint32_t i, const Measure& m) {
    const double nearest = nearest_of(m, feature.half_width, feature.growth) - feature.radius_at(c[i]);
    sight.distance[i] = m.distance;
    sight.change[i] = m.change;
    ahead[i] = nearest < f.margin ? nearest + m.change : kNever;
    any = any || nearest < f.margin;
  });
  cost_.samples += count;
  if (!any) return;
  if (feature.own_face == kNoFace && count > 1) hide_beyond_an_edge(meeting_, placed, run, face, sight, ahead);
  for (std::uint32_t i = 0; i < count; i += feature.group) {
    const std::uint32_t size = std::min(feature.group, count - i);
    meet_group(placed, curve, run.begin + i, std::span(ahead).subspan(i, size), face);
  }
}

/// A row for that of a group's samples, of those that are near enough and that the face admits, which will be nearest
/// at the end of the step if nothing comes between. Where that one hardly holds, as a segment's end on a slope, the
/// firmest of those that will touch holds the rest. `ahead`: how near about; used up.
void Search::meet_group(const PlacedFeature& placed, const CurveFromSurface& curve, std::uint32_t begin,
                        std::span<double> ahead, std::uint32_t face) {
  const Meeting& m = meeting_;
  const auto count = static_cast<std::uint32_t>(ahead.size());
  std::array<double, kGroupMax> about;
  std::copy(ahead.begin(), ahead.end(), about.begin());
  Candidate best;
  Candidate firm;
  best.gap_ahead = kNever;
  firm.weight = 0;
  while (true) {
    const auto next = std::min_element(ahead.begin(), ahead.end());
    const bool is_firm = best.gap_ahead == kNever || best.weight >= m.frame.thresholds.firm;
    if (!(*next < (is_firm ? best.gap_ahead : std::max(best.gap_ahead, 0.0)))) break;
    Candidate c;
    c.group = begin;
    c.sample = begin + static_cast<std::uint32_t>(next - ahead.begin());
    *next = kNever;
    c.place = slide(curve, m.mover.sample_c[c.sample], m.mover.sample_s[c.sample], placed.feature->half_width,
                    placed.feature->growth);
    if (!measure_candidate(placed, face, count, c)) continue;
    if (c.gap_ahead < best.gap_ahead) best = c;
    if (c.gap_ahead < 0 && c.weight > firm.weight) firm = c;
  }
  if (best.gap_ahead == kNever) return;
  add(placed, best, count, face);
  if (best.weight < m.frame.thresholds.firm && firm.weight > best.weight) {
    firm.weight -= best.weight;
    add(placed, firm, count, face);
  }
  if (best.gap_ahead >= 0) return;
  for (const int side : {-1, 1}) add_end(placed, best, std::span(about).first(count), side, face);
}

/// Fills in what a candidate's sample and place say, as one that stands for `count` segments. False: there is no row.
bool Search::measure_candidate(const PlacedFeature& placed, std::uint32_t face, std::uint32_t count, Candidate& c) {
  const SearchFrame& f = meeting_.frame;
  ++cost_.slides;
  c.p = placed.point(c.place);
  c.at = meeting_.base.faces[face].surface->at(c.p);
  c.gap = c.at.distance - placed.feature->radius_at(c.place.c);
  if (c.gap >= f.margin || c.gap < -meeting_.base.options.spacing) return false;
  c.normal = c.at.normal;
  if (!admit(meeting_, placed, face, c) || c.gap >= f.margin) return false;
  c.gap_ahead = c.gap + c.normal.dot(meeting_.moved(c.p, f.twist));
  c.weight *= touching_share(placed, c, count) * lean_weight(c.sample, c.normal);
  return true;
}

/// Where a group lies flush and is pressed on, the nearest of its places is any of them: a row there alone lets the
/// body tip over it, and from one frame to the next the place changes. So its end on the given side has a row of one
/// segment if it may be nearer than the nearest at the end of the step: what stops a place by so much turns the bodies
/// by about as much over their size. If the face does not admit the end, the outermost segment's end that it does.
void Search::add_end(const PlacedFeature& placed, const Candidate& best, std::span<const double> about, int side,
                     std::uint32_t face) {
  const double half = placed.feature->half_width;
  const int count = static_cast<int>(about.size());
  const int here = static_cast<int>(best.sample - best.group);
  const auto is_flush = [&](double gap_ahead, double away) {
    return gap_ahead < best.gap_ahead * (1 - away / meeting_.frame.size);
  };
  for (int i = side > 0 ? count - 1 : 0; side * (i - here) >= 0; i -= side) {
    const double way = side * (2 * half * (i - here) - best.place.t) + half;  // in t, from the nearest place
    if (2 * way < half * count) return;                                       // a quarter of the group
    const double ahead = about[static_cast<std::size_t>(i)];
    if (ahead == kNever) continue;
    if (!is_flush(ahead, way / half * placed.feature->reach)) return;
    Candidate c;
    c.group = best.group;
    c.sample = best.group + static_cast<std::uint32_t>(i);
    c.place =
        place_at(placed.is_arc(), meeting_.mover.sample_c[c.sample], meeting_.mover.sample_s[c.sample], side * half);
    if (!measure_candidate(placed, face, 1, c)) continue;
    if (is_flush(c.gap_ahead, (c.p - best.p).norm())) add(placed, c, 1, face);
    return;
  }
}

/// How much of a group's length touches: the overlap at its nearest place is used up where the group, sloping, comes
/// out of the surface.
double Search::touching_share(const PlacedFeature& placed, const Candidate& c, std::uint32_t count) const {
  const double rise =
      std::abs(c.normal.dot(placed.tangent(c.place)) - placed.feature->growth) * 2 * placed.feature->half_width * count;
  const double overlap = meeting_.frame.thresholds.touching + std::max(0.0, -c.gap);
  return rise > overlap ? overlap / rise : 1;
}

double Search::lean_weight(std::uint32_t sample, const Vector3d& normal) const {
  return lean_weight_in_mover(sample, meeting_.frame.R.transpose() * normal);
}

/// @param n  the normal in the mover's coordinates
double Search::lean_weight_in_mover(std::uint32_t sample, const Vector3d& n) const {
  double lean = 0;
  for (std::uint32_t i = meeting_.mover.wedge_begin[sample]; i < meeting_.mover.wedge_begin[sample + 1]; ++i)
    lean = std::max(lean, -n.dot(meeting_.mover.wedges[i]));
  const SearchThresholds& fade = meeting_.frame.thresholds;
  return std::clamp((fade.lean_none - lean) / (fade.lean_none - fade.lean_free), 0.0, 1.0);
}

/// Does a plane look the wrong way for all of a run?
bool Search::looks_away(const Run& run, const Vector3d& normal) const {
  const Vector3d n = meeting_.frame.R.transpose() * normal;
  for (std::uint32_t i = run.begin; i < run.end; ++i)
    if (lean_weight_in_mover(i, n) > 0) return false;
  return true;
}

/// The row of a candidate that stands for `count` segments.
void Search::add(const PlacedFeature& placed, const Candidate& c, std::uint32_t count, std::uint32_t face) {
  const SearchFrame& f = meeting_.frame;
  const Feature& feature = *placed.feature;
  if (c.weight == 0) return;
  const double point = meeting_.mover.options.line_stiffness * meeting_.mover.options.point_length;
  const double stiffness = c.weight * (count * feature.stiffness + c.edge_share * point);
  const Vector3d normal = f.R_WB * c.normal;
  const Vector3d place = f.R_WB * (c.p - feature.radius_at(c.place.c) * c.normal) + f.p_WB;
  const auto faces = static_cast<std::uint32_t>(meeting_.base.faces.size());
  const std::uint32_t source = (c.group * faces + face) << 1 | static_cast<std::uint32_t>(f.mover_is_second);
  rows_.add({f.mover_is_second ? normal : Vector3d(-normal), place, c.gap, stiffness, source});
  depth_max_ = std::max(depth_max_, -c.gap);
  ++cost_.rows;
}

}  // namespace

double search(const ExactBody& mover, const ExactBody& base, const SearchFrame& frame, NodePairs& stack, RowList& rows,
              SearchCost& cost) {
  return Search(mover, base, frame, rows, cost).run(stack);
}

}  // namespace verisim::exact
