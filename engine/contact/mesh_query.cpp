#include "engine/contact/mesh_query.hpp"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>

#include <algorithm>
#include <limits>
#include <tuple>
#include <unordered_map>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim {

struct MeshTree::Implementation {
  fcl::BVHModel<fcl::OBBRSSd> tree;
};

MeshTree::MeshTree(const TriangleMesh& mesh) : implementation_(std::make_unique<Implementation>()) {
  for (const Vector3d& v : mesh.vertices) VERISIM_ASSERT(is_finite(v));
  std::vector<fcl::Triangle> triangles;
  for (const auto& [a, b, c] : mesh.triangles) {
    VERISIM_ASSERT(std::max({a, b, c}) < mesh.vertices.size());
    const Vector3d ab = mesh.vertices[b] - mesh.vertices[a];
    const Vector3d ac = mesh.vertices[c] - mesh.vertices[a];
    // A triangle that is thinner than rounding has no plane.
    if (ab.cross(ac).norm() > 1e-12 * ab.norm() * ac.norm()) triangles.emplace_back(a, b, c);
  }
  auto& tree = implementation_->tree;
  tree.beginModel(static_cast<int>(triangles.size()), static_cast<int>(mesh.vertices.size()));
  tree.addSubModel(mesh.vertices, triangles);
  tree.endModel();
}

MeshTree::~MeshTree() = default;

namespace {

/// By corner, the shallowest first; then by number, so that the order is the mesh's and not the tree's.
bool comes_before(const fcl::Contactd& a, const fcl::Contactd& b) {
  const auto key = [](const fcl::Contactd& c) {
    return std::make_tuple(c.pos.x(), c.pos.y(), c.pos.z(), c.penetration_depth, c.b1, c.b2);
  };
  return key(a) < key(b);
}

void append(ContactList& contacts, const fcl::Contactd& found, const Vector3d& origin_A) {
  const std::uint32_t at = contacts.size++;
  contacts.point[at] = static_cast<std::uint32_t>(found.b2);
  contacts.slot[at] = static_cast<std::uint32_t>(found.b1);
  const Eigen::Vector3f p = (found.pos - origin_A).cast<float>();
  const Eigen::Vector3f n = found.normal.cast<float>();
  contacts.x[at] = p.x(), contacts.y[at] = p.y(), contacts.z[at] = p.z();
  contacts.nx[at] = n.x(), contacts.ny[at] = n.y(), contacts.nz[at] = n.z();
  contacts.depth[at] = static_cast<float>(found.penetration_depth);
}

/// The least depth of every triangle's contacts, by number.
using LeastDepths = std::unordered_map<std::intptr_t, double>;

void lower(LeastDepths& least, std::intptr_t triangle, double depth) {
  const auto [at, is_new] = least.try_emplace(triangle, depth);
  if (!is_new) at->second = std::min(at->second, depth);
}

/// Contacts that are the shallowest of a triangle of either body: the others are depths to the face around an edge.
std::vector<fcl::Contactd> without_depths_around_edges(const std::vector<fcl::Contactd>& found) {
  LeastDepths of_a, of_b;
  for (const fcl::Contactd& c : found) {
    lower(of_a, c.b1, c.penetration_depth);
    lower(of_b, c.b2, c.penetration_depth);
  }
  std::vector<fcl::Contactd> kept;
  for (const fcl::Contactd& c : found)
    if (c.penetration_depth == of_a[c.b1] || c.penetration_depth == of_b[c.b2]) kept.push_back(c);
  return kept;
}

}  // namespace

void query(const MeshTree& a, const MeshTree& b, const Pose& X_AB, const Vector3d& origin_A, ContactList& contacts,
           QueryCost& cost) {
  contacts.size = 0;
  if (!X_AB.position.allFinite() || !X_AB.rotation.coeffs().allFinite()) return;
  VERISIM_ASSERT(is_unit(X_AB.rotation));
  VERISIM_ASSERT(is_finite(origin_A));
  fcl::Transform3d placed = fcl::Transform3d::Identity();
  placed.linear() = X_AB.rotation.toRotationMatrix();
  placed.translation() = X_AB.position;
  const fcl::CollisionRequestd request(std::numeric_limits<std::size_t>::max(), /*enable_contact=*/true);
  fcl::CollisionResultd result;
  fcl::collide(&a.implementation_->tree, fcl::Transform3d::Identity(), &b.implementation_->tree, placed, request,
               result);
  std::vector<fcl::Contactd> found;
  result.getContacts(found);
  found = without_depths_around_edges(found);
  std::sort(found.begin(), found.end(), comes_before);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const bool is_shallowest = i == 0 || found[i].pos != found[i - 1].pos;
    if (!is_shallowest || !(static_cast<float>(found[i].penetration_depth) > 0)) continue;
    if (contacts.size < contacts.capacity())
      append(contacts, found[i], origin_A);
    else
      ++cost.left_out;
  }
}

}  // namespace verisim
