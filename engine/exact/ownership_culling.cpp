#include "engine/exact/ownership_culling.hpp"

#include <algorithm>

#include "engine/base/error.hpp"
#include "engine/exact/edge_ownership.hpp"

namespace verisim::exact {
namespace {

/// By how much the distance to the face across an edge exceeds that to this face, per sample. Positive: the face across
/// owns the sample.
struct DistanceLead {
  PerSample now;      ///< m, at the start of the step
  PerSample by_rule;  ///< m, as the sample's rule compares them
  PerSample other;    ///< m, the distance to the face across, the least that is expected of it
  std::array<OwnershipRule, kBlockSize> rule;
};

/// A convex edge of `face` whose other face owns the point p; null if there is none.
const ExactEdge* limiting_edge(const BodyPair& pair, const Vector3d& p, std::uint32_t face) {
  const SurfaceAt mine = pair.base.faces[face].surface->at(p);
  const Trim::Answer answer =
      pair.base.faces[face].trim->find(*pair.base.faces[face].surface, p - mine.distance * mine.normal);
  for (const std::uint32_t e : answer.edges) {
    const ExactEdge& edge = pair.base.edges[e];
    if (edge.convexity != Convexity::convex) continue;
    const SurfaceAt other = pair.base.faces[face_across(edge, face)].surface->at(p);
    if (edge.limits_face_at(face, p, other.distance) && !owns_point(pair, p, mine, other, false) &&
        !is_hidden(pair.base, face, answer.edges, e, p, other))
      return &edge;
  }
  return nullptr;
}

/// True if the edge passes near p and limits `face` there.
bool is_limited_by(const BodyPair& pair, const ExactEdge& edge, std::uint32_t face, const Vector3d& p) {
  const auto number = static_cast<std::uint32_t>(&edge - pair.base.edges.data());
  const Trim::Answer answer = pair.base.faces[face].trim->find(*pair.base.faces[face].surface, p);
  if (std::find(answer.edges.begin(), answer.edges.end(), number) == answer.edges.end()) return false;
  const SurfaceAt other = pair.base.faces[face_across(edge, face)].surface->at(p);
  return edge.limits_face_at(face, p, other.distance) && !is_hidden(pair.base, face, answer.edges, number, p, other);
}

DistanceLead lead_of(const BodyPair& pair, const AnalyticSurface& other, const AnalyticSurface& mine,
                     const PlacedFeature& placed, const SampleBlock& block, std::span<const Measure> measures) {
  const RelativeMotion& motion = pair.motion;
  DistanceLead lead;
  bool some_before = false;
  bool some_free = false;
  pair.measure_all(pair.seen_from(other, placed, motion.last_twist), block, [&](std::uint32_t i, const Measure& m) {
    lead.now[i] = m.distance - measures[i].distance;
    lead.rule[i] = ownership_rule(measures[i].distance, m.distance, motion.thresholds.coincident);
    lead.by_rule[i] = lead.now[i] + (lead.rule[i] == OwnershipRule::by_last_motion ? m.change : 0);
    const bool on_edge = measures[i].distance > -motion.thresholds.coincident;
    const bool moves = on_edge || lead.rule[i] == OwnershipRule::by_last_motion;
    lead.other[i] = m.distance + (moves ? std::min(0.0, m.change) : 0.0);
    some_before = some_before || lead.rule[i] == OwnershipRule::by_last_motion;
    some_free = some_free || lead.rule[i] == OwnershipRule::by_free_motion;
  });
  if (some_before) {
    pair.measure_all(pair.seen_from(mine, placed, motion.last_twist), block, [&](std::uint32_t i, const Measure& m) {
      if (lead.rule[i] == OwnershipRule::by_last_motion) lead.by_rule[i] -= m.change;
    });
  }
  if (some_free) {
    pair.measure_all(pair.seen_from(other, placed, motion.free_twist), block, [&](std::uint32_t i, const Measure& m) {
      if (lead.rule[i] != OwnershipRule::by_free_motion) return;
      lead.by_rule[i] += m.change - measures[i].change;
      lead.other[i] = std::min(lead.other[i], lead.now[i] + measures[i].distance + m.change);
    });
  }
  return lead;
}

}  // namespace

void cull_unowned_samples(const BodyPair& pair, const PlacedFeature& placed, const SampleBlock& block,
                          std::uint32_t face, std::span<const Measure> measures, std::span<double> gaps_ahead) {
  const std::uint32_t count = block.end - block.begin;
  VERISIM_ASSERT(gaps_ahead.size() >= count);
  const auto place = [&](std::uint32_t i) {
    return placed.point({0, pair.mover.sample_c[block.begin + i], pair.mover.sample_s[block.begin + i]});
  };
  std::uint32_t first = 0;
  while (first < count && gaps_ahead[first] == kOutOfReach) ++first;
  VERISIM_ASSERT(first < count);
  const ExactEdge* edge = limiting_edge(pair, place(first), face);
  if (edge == nullptr) return;
  const auto& faces = pair.base.faces;
  const DistanceLead lead =
      lead_of(pair, *faces[face_across(*edge, face)].surface, *faces[face].surface, placed, block, measures);
  // From a segment's middle to its end the lead changes by about half of its change to the next middle. The lead must
  // exceed twice that.
  const double enough = pair.motion.thresholds.lead_enough;
  const auto keeps_lead_towards = [&](std::uint32_t i, std::uint32_t next) {
    return lead.rule[next] == lead.rule[i] && lead.now[i] > enough * std::abs(lead.now[i] - lead.now[next]) &&
           lead.by_rule[i] > enough * std::abs(lead.by_rule[i] - lead.by_rule[next]);
  };
  const auto is_led = [&](std::uint32_t i) {
    return gaps_ahead[i] == kOutOfReach ||
           ((i == 0 || keeps_lead_towards(i, i - 1)) && (i + 1 == count || keeps_lead_towards(i, i + 1)));
  };
  const auto is_limited = [&](std::uint32_t i) {
    return gaps_ahead[i] == kOutOfReach || is_limited_by(pair, *edge, face, place(i));
  };
  const AnalyticSurface& across = *faces[face_across(*edge, face)].surface;
  const auto can_be_pushed = [&](std::uint32_t i) {
    return gaps_ahead[i] == kOutOfReach || lead.other[i] >= pair.motion.thresholds.coincident ||
           pair.normal_cone_weight(block.begin + i, across.at(place(i)).normal) >= 1;
  };
  const std::uint32_t group = placed.feature->group;
  for (std::uint32_t begin = first / group * group; begin < count; begin += group) {
    const std::uint32_t end = std::min(begin + group, count);
    bool is_unowned = is_limited(begin) && is_limited(end - 1);
    for (std::uint32_t i = begin; is_unowned && i < end; ++i) is_unowned = is_led(i) && can_be_pushed(i);
    if (is_unowned) std::fill(gaps_ahead.begin() + begin, gaps_ahead.begin() + end, kOutOfReach);
  }
}

}  // namespace verisim::exact
