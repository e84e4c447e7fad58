#include "engine/exact/hidden.hpp"

#include <algorithm>

#include "engine/base/error.hpp"
#include "engine/exact/border.hpp"

namespace verisim::exact {
namespace {

/// By how much the face across an edge is farther away than this one, which then does not decide.
struct Lead {
  OfRun now, by_rule;  ///< m
  std::array<Rule, kRun> rule;
};

/// A convex edge of the face beyond which a place near the face lies, if there is one.
const ExactEdge* hiding_edge(const Meeting& meeting, const Vector3d& p, std::uint32_t face) {
  const SurfaceAt mine = meeting.base.faces[face].surface->at(p);
  const Trim::Answer answer =
      meeting.base.faces[face].trim->find(*meeting.base.faces[face].surface, p - mine.distance * mine.normal);
  for (const std::uint32_t e : answer.edges) {
    const ExactEdge& edge = meeting.base.edges[e];
    if (edge.fold != Fold::convex) continue;
    const SurfaceAt other = meeting.base.faces[across(edge, face)].surface->at(p);
    if (edge.speaks_for(face, p, other.distance) && !decides(meeting, p, mine, other, false)) return &edge;
  }
  return nullptr;
}

/// Is the edge one of those near a place of the face, and does it speak for it?
bool is_hidden_by(const Meeting& meeting, const ExactEdge& edge, std::uint32_t face, const Vector3d& p,
                  double distance) {
  const auto number = static_cast<std::uint32_t>(&edge - meeting.base.edges.data());
  const Trim::Answer answer = meeting.base.faces[face].trim->find(*meeting.base.faces[face].surface, p);
  return std::find(answer.edges.begin(), answer.edges.end(), number) != answer.edges.end() &&
         edge.speaks_for(face, p, distance);
}

Lead lead_of(const Meeting& meeting, const PreciseSurface& other, const PreciseSurface& mine,
             const PlacedFeature& placed, const Run& run, const Sight& sight) {
  const SearchFrame& f = meeting.frame;
  Lead lead;
  bool some_before = false;
  bool some_free = false;
  meeting.measure_all(meeting.seen_from(other, placed, f.before), run, [&](std::uint32_t i, const Measure& m) {
    lead.now[i] = m.distance - sight.distance[i];
    lead.rule[i] = rule_of(sight.distance[i], m.distance, f.thresholds.flush);
    lead.by_rule[i] = lead.now[i] + (lead.rule[i] == Rule::as_before ? m.change : 0);
    some_before = some_before || lead.rule[i] == Rule::as_before;
    some_free = some_free || lead.rule[i] == Rule::as_free;
  });
  if (some_before) {
    meeting.measure_all(meeting.seen_from(mine, placed, f.before), run, [&](std::uint32_t i, const Measure& m) {
      if (lead.rule[i] == Rule::as_before) lead.by_rule[i] -= m.change;
    });
  }
  if (some_free) {
    meeting.measure_all(meeting.seen_from(other, placed, f.twist), run, [&](std::uint32_t i, const Measure& m) {
      if (lead.rule[i] == Rule::as_free) lead.by_rule[i] += m.change - sight.change[i];
    });
  }
  return lead;
}

}  // namespace

void hide_beyond_an_edge(const Meeting& meeting, const PlacedFeature& placed, const Run& run, std::uint32_t face,
                         const Sight& sight, std::span<double> ahead) {
  const std::uint32_t count = run.end - run.begin;
  const auto place = [&](std::uint32_t i) {
    return placed.point({0, meeting.mover.sample_c[run.begin + i], meeting.mover.sample_s[run.begin + i]});
  };
  std::uint32_t first = 0;
  while (first < count && ahead[first] == kNever) ++first;
  VERISIM_ASSERT(first < count);
  const ExactEdge* edge = hiding_edge(meeting, place(first), face);
  if (edge == nullptr) return;
  const auto& faces = meeting.base.faces;
  const Lead lead = lead_of(meeting, *faces[across(*edge, face)].surface, *faces[face].surface, placed, run, sight);
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
    return ahead[i] == kNever || is_hidden_by(meeting, *edge, face, place(i), sight.distance[i] + lead.now[i]);
  };
  const std::uint32_t group = placed.feature->group;
  for (std::uint32_t begin = first / group * group; begin < count; begin += group) {
    const std::uint32_t end = std::min(begin + group, count);
    bool is_hidden = speaks(begin) && speaks(end - 1);
    for (std::uint32_t i = begin; is_hidden && i < end; ++i) is_hidden = leads(i);
    if (is_hidden) std::fill(ahead.begin() + begin, ahead.begin() + end, kNever);
  }
}

}  // namespace verisim::exact
