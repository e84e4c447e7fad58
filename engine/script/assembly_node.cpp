#include "engine/script/assembly_node.hpp"

#include <iterator>
#include <type_traits>
#include <utility>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim::script {
namespace {

struct Leaf {
  const Node* node;
  double scale;  ///< of all groups above it and of its own
  Pose pose;
};

class Gatherer {
 public:
  void visit(const Node& node, double scale, const Pose& pose, int depth) {
    if (++visited_ > kNodesMax)
      fail(ErrorKind::input, "the object has more than {} nodes; build it from fewer", kNodesMax);
    if (depth > kNodeDepthMax)
      fail(ErrorKind::input, "the object's groups are nested more than {} deep; flatten them", kNodeDepthMax);
    if (node.kind != Node::Kind::group) {
      leaves.push_back({&node, scale * node.file_scale, pose});
      return;
    }
    // pose * (scale * (inner.pose * (inner.scale * x))): a similarity again.
    const Pose combined = pose * Pose{scale * node.pose.position, node.pose.rotation};
    for (const auto& child : node.children) visit(*child, scale * node.scale, combined, depth + 1);
  }
  std::vector<Leaf> leaves;

 private:
  int visited_ = 0;
};

bool same(const Pose& a, const Pose& b) {
  return a.position == b.position && a.rotation.coeffs() == b.rotation.coeffs();
}

/// `one_placement`: the leaf's pose belongs to the body's.
std::vector<Part> parts_of(const Leaf& leaf, Inputs& inputs, bool one_placement) {
  const Node& node = *leaf.node;
  if (node.kind == Node::Kind::solid) {
    const std::shared_ptr<const Solid> solid = scaled(node.solid, leaf.scale);
    Part part = inputs.solid(*solid, LoadOptions{});
    const Pose inner = one_placement ? Pose{} : leaf.pose;
    part.solid = Solid{Solid::Kind::placed, {}, {solid}, inner}.text();
    return {std::move(part)};
  }
  const std::vector<Part>& parts = load_file(inputs, node.file, leaf.scale, node.recover);
  if (node.part == 0) return parts;
  if (static_cast<std::size_t>(node.part) > parts.size())
    fail(ErrorKind::input, "{}: has no part {}; it has {} (modelParts lists them)", node.file, node.part, parts.size());
  return {parts[static_cast<std::size_t>(node.part) - 1]};
}

std::string stem_of(const std::string& file) {
  const std::size_t slash = file.find_last_of('/');
  const std::string name = slash == std::string::npos ? file : file.substr(slash + 1);
  return name.substr(0, name.find_last_of('.'));
}

// Entities differ in their fields' names; each gets its points moved and its directions turned.
struct Placer {
  const Pose& X;
  void point(Vector3d& p) const { p = X * p; }
  void turn(Vector3d& v) const { v = X.rotation * v; }

  template <typename Entity>
  void operator()(Entity& entity) const {
    if constexpr (requires { entity.point; }) point(entity.point);
    if constexpr (requires { entity.center; }) point(entity.center);
    if constexpr (requires { entity.normal; }) turn(entity.normal);
    if constexpr (requires { entity.direction; }) turn(entity.direction);
    if constexpr (requires { entity.x_axis; }) turn(entity.x_axis);
  }
};

}  // namespace

const std::vector<Part>& load_file(Inputs& inputs, const std::string& file, double scale, bool recover) {
  VERISIM_ASSERT(scale > 0);  // to the loader 0 would mean: as the file has it
  LoadOptions options;
  options.recover = recover;
  if (scale != 1) options.scale = scale;
  return inputs.model(file, options);
}

Part placed(const Part& part, const Pose& X) {
  VERISIM_ASSERT(is_placement(X));
  Part result = part;
  const Placer place{X};
  for (Vector3d& p : result.mesh.vertices) place.point(p);
  for (Face& face : result.faces) std::visit(place, face.surface);
  for (Edge& edge : result.edges) {
    std::visit(place, edge.curve);
    for (Vector3d& p : edge.polyline) place.point(p);
  }
  place.point(result.mass.centroid);
  const Matrix3d R = X.rotation.toRotationMatrix();
  result.mass.inertia = R * result.mass.inertia * R.transpose();
  return result;
}

std::shared_ptr<const Solid> scaled(const std::shared_ptr<const Solid>& solid, double scale) {
  VERISIM_ASSERT(solid != nullptr);
  VERISIM_ASSERT(scale > 0);
  if (scale == 1) return solid;
  auto result = std::make_shared<Solid>(*solid);
  for (double& size : result->sizes) size *= scale;
  result->placement.position *= scale;
  for (auto& child : result->children) child = scaled(child, scale);
  return result;
}

Node::~Node() {
  std::vector<std::shared_ptr<Node>> waiting = std::move(children);
  while (!waiting.empty()) {
    const std::shared_ptr<Node> node = std::move(waiting.back());
    waiting.pop_back();
    if (node.use_count() > 1) continue;
    std::move(node->children.begin(), node->children.end(), std::back_inserter(waiting));
    node->children.clear();
  }
}

PlacedParts resolve(const std::vector<std::shared_ptr<Node>>& nodes, Inputs& inputs) {
  Gatherer gatherer;
  for (const auto& node : nodes) {
    VERISIM_ASSERT(node != nullptr);
    gatherer.visit(*node, 1, Pose{}, 1);
  }
  const std::vector<Leaf>& leaves = gatherer.leaves;
  if (leaves.empty()) fail(ErrorKind::input, "the object has no geometry; give it a Model or a Solid");
  for (const Leaf& leaf : leaves)
    if (!is_placement(leaf.pose) || !is_positive(leaf.scale))
      fail(ErrorKind::input, "the object's transforms take it beyond all numbers; give smaller positions and scales");
  PlacedParts result;
  bool one_placement = true;
  for (const Leaf& leaf : leaves) one_placement = one_placement && same(leaf.pose, leaves.front().pose);
  if (one_placement) result.pose = leaves.front().pose;
  for (const Leaf& leaf : leaves) {
    for (const Part& part : parts_of(leaf, inputs, one_placement))
      result.parts.push_back(one_placement ? part : placed(part, leaf.pose));
    if (result.stem.empty() && leaf.node->kind == Node::Kind::model) result.stem = stem_of(leaf.node->file);
  }
  return result;
}

}  // namespace verisim::script
