#include "engine/geometry/solid.hpp"

#include <cmath>
#include <span>

#include "engine/base/error.hpp"

namespace verisim {
namespace {

/// Name, number of children and meaning of the sizes of each kind.
struct KindInfo {
  const char* name;
  std::size_t children;
  std::vector<const char*> sizes;
};

const KindInfo& info_of(Solid::Kind kind) {
  static const std::vector<KindInfo> infos = {
      {"box", 0, {"x", "y", "z"}},
      {"cylinder", 0, {"radius", "height"}},
      {"cone", 0, {"radius1", "radius2", "height"}},
      {"sphere", 0, {"radius"}},
      {"tube", 0, {"outer", "inner", "height"}},
      {"torus", 0, {"ringRadius", "radius"}},
      {"difference", 2, {}},
      {"sum", 2, {}},
      {"intersection", 2, {}},
      {"placed", 1, {}},
  };
  return infos[static_cast<std::size_t>(kind)];
}

/// More than any scene written by hand has. Children can be reused, so a short script could describe 2^1000 of them.
constexpr std::size_t kNodesMax = 10000;

void check_sizes(const Solid& solid) {
  const KindInfo& info = info_of(solid.kind);
  if (solid.sizes.size() != info.sizes.size()) {
    fail(ErrorKind::input, "Solid.{}: {} sizes given but it has {}; give {}", info.name, solid.sizes.size(),
         info.sizes.size(), fmt::join(info.sizes, ", "));
  }
  for (std::size_t i = 0; i < solid.sizes.size(); ++i) {
    const double size = solid.sizes[i];
    const bool may_be_zero = solid.kind == Solid::Kind::cone && i < 2;
    if (std::isfinite(size) && (size > 0 || (may_be_zero && size == 0))) continue;
    fail(ErrorKind::input, "Solid.{}: {} is {} m; give a finite length above 0", info.name, info.sizes[i], size);
  }
}

void check_relations(const Solid& solid) {
  if (solid.kind == Solid::Kind::cone && solid.sizes[0] == 0 && solid.sizes[1] == 0) {
    fail(ErrorKind::input, "Solid.cone: radius1 and radius2 are both 0; give at least one a length above 0");
  }
  if (solid.kind == Solid::Kind::tube && solid.sizes[1] >= solid.sizes[0]) {
    fail(ErrorKind::input, "Solid.tube: inner is {} m and outer {} m; make inner the smaller one", solid.sizes[1],
         solid.sizes[0]);
  }
  if (solid.kind == Solid::Kind::torus && solid.sizes[1] >= solid.sizes[0]) {
    fail(ErrorKind::input, "Solid.torus: radius is {} m and ringRadius {} m; make radius the smaller one",
         solid.sizes[1], solid.sizes[0]);
  }
  if (solid.kind != Solid::Kind::placed) return;
  const Pose& placement = solid.placement;
  if (!placement.position.allFinite() || !placement.rotation.coeffs().allFinite()) {
    fail(ErrorKind::input, "a placed solid's position or rotation is not finite; give numbers");
  }
  if (std::abs(placement.rotation.norm() - 1) > 1e-9) {
    fail(ErrorKind::input, "a placed solid's quaternion has length {}; give one of length 1",
         placement.rotation.norm());
  }
}

void check_node(const Solid& solid, std::size_t& nodes) {
  if (++nodes > kNodesMax) {
    fail(ErrorKind::input, "a solid is made of more than {} primitives and operations; load it from a file", kNodesMax);
  }
  check_sizes(solid);
  check_relations(solid);
  const KindInfo& info = info_of(solid.kind);
  if (solid.children.size() != info.children) {
    fail(ErrorKind::input, "Solid.{}: {} solids given but it takes {}", info.name, solid.children.size(),
         info.children);
  }
  for (const auto& child : solid.children) {
    if (!child) fail(ErrorKind::input, "Solid.{}: a solid is missing; give {} of them", info.name, info.children);
    check_node(*child, nodes);
  }
}

/// q and -q are the same rotation. Chosen is the one whose last nonzero coefficient is positive.
Eigen::Vector4d canonical(const Quaterniond& q) {
  for (const double coefficient : {q.w(), q.z(), q.y(), q.x()}) {
    if (coefficient != 0) return coefficient < 0 ? Eigen::Vector4d(-q.coeffs()) : Eigen::Vector4d(q.coeffs());
  }
  return q.coeffs();
}

void append_numbers(std::string& text, std::span<const double> numbers) {
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    text +=
        fmt::format("{}{}", i == 0 ? "" : ",", numbers[i] + 0.0);  // -0 + 0 = 0; shortest text that reads back equal
  }
}

void append_text(std::string& text, const Solid& solid) {
  text += info_of(solid.kind).name;
  text += '(';
  append_numbers(text, solid.sizes);
  if (solid.kind == Solid::Kind::placed) {
    append_numbers(text, {solid.placement.position.data(), 3});
    text += ';';
    const Eigen::Vector4d rotation = canonical(solid.placement.rotation);
    append_numbers(text, {rotation.data(), 4});
    text += ';';
  }
  for (std::size_t i = 0; i < solid.children.size(); ++i) {
    VERISIM_ASSERT(solid.children[i] != nullptr);
    if (i > 0) text += ',';
    append_text(text, *solid.children[i]);
  }
  text += ')';
}

}  // namespace

std::string Solid::text() const {
  std::string text;
  append_text(text, *this);
  return text;
}

void check(const Solid& solid) {
  std::size_t nodes = 0;
  check_node(solid, nodes);
}

}  // namespace verisim
