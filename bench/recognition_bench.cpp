// Constraint recognition and what follows it: a single pair and whole sets against a bare std::visit of the same run,
// table 7.1 over all choices of the published recognizers, restoration per contact, the blending comparator.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>

#include "bench/promise.hpp"
#include "bench/sorted_entities.hpp"
#include "engine/base/random.hpp"
#include "engine/constraint/blend.hpp"
#include "engine/constraint/constraint_link.hpp"
#include "engine/constraint/recognition.hpp"
#include "engine/constraint/recognition_table.hpp"
#include "engine/constraint/recognizers.hpp"
#include "tests/constraint/contacts.hpp"
#include "tests/constraint/parts.hpp"

namespace verisim::bench {
namespace {

/// 100 entities of all recognized types, in mixed order; about half of the round ones are holes.
std::vector<Entity> mixed(std::uint64_t seed) {
  const RandomStream r(seed, "recognition bench");
  std::vector<Entity> all;
  for (std::uint64_t i = 0; i < 100; ++i) {
    const bool hole = r.uniform(4 * i) < 0.5;
    const double radius = 0.05 + 0.01 * r.uniform(4 * i + 1);
    const std::array<Entity, 7> one = {test::plane(test::kZ),
                                       test::cylinder(radius, hole),
                                       test::cone(radius, 0.3, hole),
                                       test::sphere(radius, hole),
                                       test::torus(0.2, radius, hole),
                                       test::line(test::kX),
                                       test::circle(radius, hole ? Role::hole : Role::pin)};
    all.push_back(one[static_cast<std::size_t>(7 * r.uniform(4 * i + 2))]);
  }
  return all;
}

/// One side of a result as recognizers write it; nothing of what is never recognized.
template <typename Shape>
ConstraintSide side_of_any(const Bounded<Shape>& e) {
  if constexpr (requires { recognizing::side_of(e); }) {
    return recognizing::side_of(e);
  } else {
    return {};
  }
}

/// Dispatch and a full result by value, nothing recognized.
Constraint bare_visit(const Entity& a, const Entity& b) {
  return std::visit(
      [](const auto& x, const auto& y) {
        Constraint full;
        full.a = side_of_any(x);
        full.b = side_of_any(y);
        return full;
      },
      a, b);
}

template <typename Function>
void over_all_pairs(benchmark::State& state, const Function& recognize_pair) {
  const std::vector<Entity> a = mixed(1);
  const std::vector<Entity> b = mixed(2);
  for (auto _ : state) {
    for (const Entity& x : a) {
      for (const Entity& y : b) {
        const Constraint c = recognize_pair(x, y);
        benchmark::DoNotOptimize(c);
      }
    }
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(a.size() * b.size()));
}

/// Two sets of 100, pair by pair in mixed order: what dispatch costs when types cannot be foreseen.
void BM_BareVisit(benchmark::State& state) {
  over_all_pairs(state, bare_visit);
}
BENCHMARK(BM_BareVisit)->Unit(benchmark::kMicrosecond);

void BM_RecognizePairs(benchmark::State& state) {
  const Tolerances tolerances;
  over_all_pairs(state, [&](const Entity& a, const Entity& b) { return recognize_by<Recognizers>(a, b, tolerances); });
}
BENCHMARK(BM_RecognizePairs)->Unit(benchmark::kMicrosecond);

/// Nanoseconds of one call, over `calls` calls.
template <typename Function>
double ns_per_call(int calls, const Function& call) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  for (int i = 0; i < calls; ++i) call();
  return std::chrono::duration<double, std::nano>(Clock::now() - start).count() / calls;
}

/// The two ratios: one pair that fits, with its full result by value, and one of two sets of 100, both against
/// a bare visit of that pair. In turns; each keeps its least time, for what disturbs a measurement only lengthens it.
void BM_AgainstABareVisit(benchmark::State& state) {
  Entity hole = test::cylinder(0.075, /*hole=*/true);
  Entity pin = test::cylinder(0.070, /*hole=*/false);
  const Tolerances tolerances;
  const SortedSet<Entity> sorted_a(mixed(1));
  const SortedSet<Entity> sorted_b(mixed(2));
  std::vector<Match> matches(sorted_a.size() * sorted_b.size() + 1);
  const auto pair = [&](const auto& of_pair) {
    benchmark::DoNotOptimize(hole);
    benchmark::DoNotOptimize(pin);
    const Constraint c = of_pair(hole, pin);
    benchmark::DoNotOptimize(c);
  };
  const auto sets = [&] {
    benchmark::DoNotOptimize(match_sets<Recognizers>(sorted_a, sorted_b, tolerances, matches));
    benchmark::ClobberMemory();
  };
  const auto recognize_pair = [&](const Entity& a, const Entity& b) {
    return recognize_by<Recognizers>(a, b, tolerances);
  };
  double visit_ns = 1e9, pair_ns = 1e9, set_ns = 1e9;
  for (auto _ : state) {
    visit_ns = std::min(visit_ns, ns_per_call(10000, [&] { pair(bare_visit); }));
    pair_ns = std::min(pair_ns, ns_per_call(10000, [&] { pair(recognize_pair); }));
    set_ns = std::min(set_ns, ns_per_call(10, sets) / static_cast<double>(matches.size() - 1));
  }
  state.counters["visit_ns"] = visit_ns;
  state.counters["pair_ns"] = pair_ns;
  at_most(state, "pair_ratio", pair_ns / visit_ns, 1.2);
  state.counters["set_ns"] = set_ns;
  at_most(state, "set_ratio", set_ns / visit_ns, 0.3);
}
BENCHMARK(BM_AgainstABareVisit)->Iterations(300)->Unit(benchmark::kMicrosecond);

/// Dispatch alone: the smallest result there is.
void BM_VisitForAByte(benchmark::State& state) {
  const std::vector<Entity> a = mixed(1);
  const std::vector<Entity> b = mixed(2);
  for (auto _ : state) {
    for (const Entity& x : a) {
      for (const Entity& y : b) {
        const char c = std::visit(
            [](const auto& e, const auto& f) { return static_cast<char>(e.half_length < f.half_length); }, x, y);
        benchmark::DoNotOptimize(c);
      }
    }
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(a.size() * b.size()));
}
BENCHMARK(BM_VisitForAByte)->Unit(benchmark::kMicrosecond);

/// The same sets, sorted by type once, and all 10,000 pairs at once.
void BM_MatchSets(benchmark::State& state) {
  const std::vector<Entity> a = mixed(1);
  const std::vector<Entity> b = mixed(2);
  const SortedSet<Entity> sorted_a(a);
  const SortedSet<Entity> sorted_b(b);
  std::vector<Match> matches(a.size() * b.size() + 1);
  std::size_t found = 0;
  for (auto _ : state) {
    found = match_sets<Recognizers>(sorted_a, sorted_b, Tolerances(), matches);
    benchmark::DoNotOptimize(matches.data());
    benchmark::ClobberMemory();
  }
  matches.resize(found);
  std::ranges::sort(matches, {}, [](const Match& m) { return std::pair(m.a, m.b); });
  std::vector<Match> plain;
  for (std::uint16_t i = 0; i < a.size(); ++i) {
    for (std::uint16_t j = 0; j < b.size(); ++j) {
      const ConstraintKind kind = recognize(a[i], b[j]).kind;
      if (kind != ConstraintKind::none) plain.push_back({i, j, kind});
    }
  }
  if (plain.empty() || matches != plain) wrong(state, "whole sets and single pairs disagree");
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(a.size() * b.size()));
  state.counters["matches"] = static_cast<double>(found);
}
BENCHMARK(BM_MatchSets)->Unit(benchmark::kMicrosecond);

/// Table 7.1: bare visit and engine over one entity of each published type; and the regressions of this run.
void BM_Table71(benchmark::State& state) {
  RecognitionTable table;
  for (auto _ : state) table = smoke() ? measure_recognition_table(2, 0.05) : measure_recognition_table();
  state.counters["none_ns"] = table.rows.front().ns_per_pair;
  state.counters["all_ns"] = table.rows.back().ns_per_pair;
  state.counters["bare_visit_ns"] = table.bare_visit_ns;
  state.counters["ratio"] = table.rows.back().ns_per_pair / table.bare_visit_ns;
  state.counters["R2_constraints"] = table.fits.constraints.r_squared;
  state.counters["R2_specializations"] = table.fits.specializations.r_squared;
  state.counters["R2_symmetric"] = table.fits.symmetric.r_squared;
}
BENCHMARK(BM_Table71)->Iterations(1)->Unit(benchmark::kMillisecond);

/// Contacts as a query gives them: a ring of 390 around the pin, in runs of one pair of sets, `rims` in a hundred of
/// them at the rim (two constraints to compare).
test::Contacts ring_of_contacts(std::int64_t rims) {
  constexpr std::uint64_t kContacts = 390;
  const RandomStream r(3, "contacts");
  test::Contacts contacts;
  contacts.origin.setZero();
  for (std::uint64_t i = 0; i < kContacts; ++i) {
    const auto draw = [&](std::uint64_t k) { return 2 * r.uniform(8 * i + k) - 1; };
    Vector3d point = Vector3d(draw(0), draw(1), 0).normalized() * 0.075;
    point.z() = 0.1 * draw(2);
    const bool is_rim = static_cast<std::int64_t>((i / 10 * 37) % 100) < rims;
    contacts.add(point, {draw(3), draw(4), draw(5)}, is_rim ? test::block_set::rim : test::block_set::wall,
                 is_rim ? test::pin_set::edge : test::pin_set::side);
  }
  return contacts;
}

/// A frame of restoration: everything that `restore` adds to `off` but the copying of set ids. Argument: contacts at
/// the rim, per cent.
void BM_RestoreFrame(benchmark::State& state) {
  const EntitySets a = test::block_with_hole();
  const EntitySets b = test::pin();
  ConstraintLink link(a, b);
  const test::Contacts fresh = ring_of_contacts(state.range(0));
  test::Contacts contacts = fresh;
  std::int64_t frame = 0;
  for (auto _ : state) {
    contacts.fx = fresh.fx, contacts.fy = fresh.fy, contacts.fz = fresh.fz;
    link.begin_frame({{1e-6 * static_cast<double>(++frame % 1000), 0.0055, 0.3}, Quaterniond::Identity()});
    const RestoreResult result = link.restore_contacts(contacts.columns());
    benchmark::DoNotOptimize(result);
  }
  if (link.counts().misses() != (state.range(0) == 0 ? 1 : 2)) wrong(state, "the memo does not remember");
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(contacts.x.size()));
}
BENCHMARK(BM_RestoreFrame)->Arg(0)->Arg(10)->Arg(50)->Unit(benchmark::kMicrosecond);

/// Faas's constraint force. Argument: engaged constraints.
void BM_ConstraintForce(benchmark::State& state) {
  std::vector<Constraint> constraints;
  for (std::int64_t i = 0; i < state.range(0); ++i) {
    const Vector3d at(0.05 * static_cast<double>(i), 0, 0);
    constraints.push_back(recognize(test::cylinder(0.0120, true, 0.1, at), test::cylinder(0.0115, false, 0.1, at)));
  }
  std::vector<Engaged> engaged;
  engaged.reserve(constraints.size());
  for (const Constraint& c : constraints) engaged.push_back({&c, 0.9, 100});
  const Pose X = {{0.001, 0.002, 0.003}, rotation_from_vector({0.01, 0.02, 0.3})};
  ConstraintForce result;
  for (auto _ : state) {
    result = constraint_force(engaged, X, {0, 0, 0.05}, {});
    benchmark::DoNotOptimize(result);
  }
  state.counters["steps"] = result.steps;
}
BENCHMARK(BM_ConstraintForce)->Arg(1)->Arg(2)->Arg(8)->Unit(benchmark::kNanosecond);

}  // namespace
}  // namespace verisim::bench
