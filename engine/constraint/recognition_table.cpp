#include "engine/constraint/recognition_table.hpp"

#include <algorithm>
#include <bit>
#include <chrono>
#include <limits>
#include <utility>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/constraint/recognition.hpp"
#include "engine/constraint/recognizers.hpp"

namespace verisim {
namespace {

/// The published engine's types.
using FiveTypes = std::variant<Bounded<Circle>, Bounded<Cylinder>, Bounded<Cone>, Bounded<Plane>, Bounded<Sphere>>;
constexpr std::size_t kTypes = std::variant_size_v<FiveTypes>;
using Set = std::array<FiveTypes, kTypes>;

/// The list of those recognizers whose bit is on.
template <unsigned mask, unsigned bit, typename List, typename... Recognizer>
struct Chosen {
  using type = List;
};
template <unsigned mask, unsigned bit, typename List, typename First, typename... Rest>
struct Chosen<mask, bit, List, First, Rest...>
    : Chosen<mask, bit + 1, std::conditional_t<(mask >> bit & 1U) != 0, typename List::template With<First>, List>,
             Rest...> {};
template <unsigned mask>
using Published = typename Chosen<mask, 0, RecognizerList<>, CylinderCylinder, ConeCone, PlanePlane, SphereSphere,
                                  CircleCylinder, SphereCylinder>::type;
constexpr unsigned kSymmetricBits = 0b001111;
constexpr unsigned kMasks = 64;

/// The compiler may not assume anything about the memory behind p: results have to be written, inputs read again.
void keep(const void* p) {
  asm volatile("" : : "g"(p) : "memory");
}

/// A part with holes or one with pins; each pin fits its hole, and the sphere is the cylinder's ball too.
Set one_of_each(bool hole) {
  const double radius = hole ? 0.075 : 0.070;
  const Vector3d o = Vector3d::Zero();
  const Vector3d x = Vector3d::UnitX();
  const Vector3d z = Vector3d::UnitZ();
  const auto bounded = [](const Surface& surface) {
    Face face;
    face.surface = surface;
    face.u_range = face.v_range = {-0.1, 0.1};
    return entity_of(face);
  };
  const Face cylinder{Cylinder{o, z, x, radius, hole}, {}, {}, 0, {}};
  Edge rim;
  rim.curve = Circle{o, z, x, radius};
  rim.t_range = {0, pinned::kFullTurn};
  rim.faces = {0};
  return {std::get<Bounded<Circle>>(entity_of(rim, {&cylinder, 1})),
          std::get<Bounded<Cylinder>>(bounded(cylinder.surface)),
          std::get<Bounded<Cone>>(bounded(Cone{o, z, x, radius, 0.3, hole})),
          std::get<Bounded<Plane>>(bounded(Plane{o, hole ? z : Vector3d(-z), x})),
          std::get<Bounded<Sphere>>(bounded(Sphere{o, z, x, radius, hole}))};
}

using Pass = void (*)(const Set&, const Set&, const Tolerances&);

template <typename List>
void recognize_all(const Set& first, const Set& second, const Tolerances& tolerances) {
  for (const FiveTypes& a : first) {
    for (const FiveTypes& b : second) {
      const Constraint c = recognize_by<List>(a, b, tolerances);
      keep(&c);
    }
  }
}

/// What dispatch and the result cost by themselves: std::visit, a full Constraint by value.
void visit_all(const Set& first, const Set& second, const Tolerances& /*tolerances*/) {
  for (const FiveTypes& a : first) {
    for (const FiveTypes& b : second) {
      const Constraint c = std::visit(
          [](const auto& bounded_a, const auto& bounded_b) {
            Constraint full;
            full.a = recognizing::side_of(bounded_a);
            full.b = recognizing::side_of(bounded_b);
            return full;
          },
          a, b);
      keep(&c);
    }
  }
}

template <std::size_t... mask>
constexpr std::array<Pass, sizeof...(mask)> passes(std::index_sequence<mask...>) {
  return {&recognize_all<Published<mask>>...};
}

template <unsigned mask>
bool agrees(const Set& first, const Set& second) {
  for (const FiveTypes& a : first) {
    for (const FiveTypes& b : second) {
      const Constraint chosen = recognize_by<Published<mask>>(a, b, Tolerances());
      const Entity whole_a = std::visit([](const auto& e) { return Entity(e); }, a);
      const Entity whole_b = std::visit([](const auto& e) { return Entity(e); }, b);
      const Constraint all = recognize_by<Published<kMasks - 1>>(a, b, Tolerances());
      if (all.kind != ConstraintKind::none && all.kind != recognize(whole_a, whole_b).kind) return false;
      if (chosen.kind != ConstraintKind::none && chosen.kind != all.kind) return false;
    }
  }
  return true;
}

template <std::size_t... mask>
bool all_agree(const Set& first, const Set& second, std::index_sequence<mask...>) {
  return (agrees<mask>(first, second) && ...);
}

double ns_per_pair(Pass pass, const Set& first, const Set& second, int repeats) {
  using Clock = std::chrono::steady_clock;
  const Tolerances tolerances;
  const auto start = Clock::now();
  for (int i = 0; i < repeats; ++i) {
    pass(first, second, tolerances);
    keep(&first);
  }
  const std::chrono::duration<double, std::nano> took = Clock::now() - start;
  return took.count() / repeats / (kTypes * kTypes);
}

std::vector<double> column(std::span<const RecognitionRow> rows, double (*value)(const RecognitionRow&)) {
  std::vector<double> values;
  values.reserve(rows.size());
  for (const RecognitionRow& row : rows) values.push_back(value(row));
  return values;
}

int bits(unsigned mask) {
  return std::popcount(mask);
}

}  // namespace

std::span<const RecognitionRow> published_recognition_rows() {
  static constexpr std::array<RecognitionRow, 20> kRows = {{
      {0, 0, 27.928}, {0, 0, 27.813},  {0, 1, 30.9023}, {0, 2, 32.3186}, {0, 3, 32.4213},
      {0, 4, 34.646}, {0, 4, 34.4224}, {1, 0, 28.3047}, {1, 0, 28.3356}, {1, 1, 31.0053},
      {1, 2, 31.108}, {1, 2, 31.0936}, {1, 3, 34.3989}, {1, 3, 34.6075}, {1, 4, 34.4081},
      {1, 4, 34.337}, {2, 3, 33.6412}, {2, 3, 33.2519}, {2, 4, 34.9714}, {2, 4, 37.4733},
  }};
  return kRows;
}

RecognitionFits fit(std::span<const RecognitionRow> rows) {
  const auto time = column(rows, [](const RecognitionRow& r) { return r.ns_per_pair; });
  const auto constraints = column(rows, [](const RecognitionRow& r) { return double(r.constraints()); });
  const auto specializations = column(rows, [](const RecognitionRow& r) { return double(r.specializations()); });
  const auto symmetric = column(rows, [](const RecognitionRow& r) { return double(r.symmetric); });
  return {fit_line(constraints, time), fit_line(specializations, time), fit_line(symmetric, time)};
}

const std::array<const char*, 6>& recognizer_names() {
  static constexpr std::array<const char*, 6> kNames = {"cylinder-cylinder", "cone-cone",       "plane-plane",
                                                        "sphere-sphere",     "circle-cylinder", "sphere-cylinder"};
  return kNames;
}

RecognitionTable measure_recognition_table(int rounds, double ms_per_row) {
  VERISIM_ASSERT(rounds > 0);
  VERISIM_ASSERT(is_positive(ms_per_row));
  static constexpr auto kPasses = passes(std::make_index_sequence<kMasks>());
  const Set holes = one_of_each(true);
  const Set pins = one_of_each(false);
  VERISIM_ASSERT(all_agree(holes, pins, std::make_index_sequence<kMasks>()));

  RecognitionTable table;
  table.bare_visit_ns = std::numeric_limits<double>::infinity();
  for (unsigned mask = 0; mask < kMasks; ++mask) {
    table.rows.push_back({bits(mask & ~kSymmetricBits), bits(mask & kSymmetricBits), table.bare_visit_ns});
  }
  constexpr int kFirstGuess = 200;
  const double first = ns_per_pair(&visit_all, holes, pins, kFirstGuess);
  const int repeats = std::max(1, static_cast<int>(1e6 * ms_per_row / (first * kTypes * kTypes)));
  for (int round = 0; round < rounds; ++round) {
    table.bare_visit_ns = std::min(table.bare_visit_ns, ns_per_pair(&visit_all, holes, pins, repeats));
    for (unsigned mask = 0; mask < kMasks; ++mask) {
      double& least = table.rows[mask].ns_per_pair;
      least = std::min(least, ns_per_pair(kPasses[mask], holes, pins, repeats));
    }
  }
  table.fits = fit(table.rows);
  return table;
}

}  // namespace verisim
