#include "engine/simulation/stages/contacts.hpp"

#include <algorithm>

#include "engine/simulation/stages/pair_methods.hpp"

namespace verisim {
namespace {

std::vector<BroadPhaseBody> boxes_of(const World& world) {
  std::vector<BroadPhaseBody> boxes;
  for (const Body& body : world.bodies) {
    const Vector3d half = 0.5 * body.bounds_B.size() + Vector3d::Constant(grown_by(body));
    boxes.push_back({body.bounds_B.center(), half, body.can_move});
  }
  return boxes;
}

std::unique_ptr<CollisionLink> link_between(const Body& first, const Body& second) {
  if (!first.voxels || !second.voxels) return nullptr;
  auto link = std::make_unique<CollisionLink>(*first.voxels, *second.voxels);
  if (first.mesh) link->find_by_triangles(*first.mesh, *second.mesh);
  return link;
}

}  // namespace

Contacts::Contacts(const World& world)
    : broad_phase_(boxes_of(world)),
      link_of_pair_(world.bodies.size() * world.bodies.size(), kNone),
      near_(world.links.size(), false),
      of_body_(world.bodies.size(), 0),
      p_WC_(world.bodies.size(), Vector3d::Zero()) {
  for (std::size_t l = 0; l < world.links.size(); ++l) {
    const auto [first, second] = world.links[l];
    link_of_pair_[first * world.bodies.size() + second] = l;
    links_.push_back(link_between(world.bodies[first], world.bodies[second]));
  }
  for (std::size_t i = 0; i < world.bodies.size(); ++i) broad_phase_.set_pose(i, world.bodies[i].rigid.pose());
}

Pose Contacts::X_AB(const World& world, std::size_t l) const {
  const Pose X_W1 = world.bodies[world.links[l].first].rigid.pose();
  const Pose X_W2 = world.bodies[world.links[l].second].rigid.pose();
  return links_[l]->first_is_map() ? X_W1.inverse() * X_W2 : X_W2.inverse() * X_W1;
}

void Contacts::query(const World& world, const PairMethods& methods, FrameCost& cost) {
  std::fill(near_.begin(), near_.end(), false);
  std::fill(of_body_.begin(), of_body_.end(), 0);
  for (const auto& link : links_)
    if (link) link->clear();
  for (std::size_t i = 0; i < world.bodies.size(); ++i) {
    p_WC_[i] = world.bodies[i].rigid.p_WC;
    if (world.bodies[i].can_move) broad_phase_.set_pose(i, world.bodies[i].rigid.pose());
  }
  for (const auto& [i, j] : broad_phase_.find()) {
    const std::size_t l = link_of_pair_[i * world.bodies.size() + j];
    if (!links_[l]) continue;
    near_[l] = true;
    ++cost.pairs_tested;
    const PairMethod* method = methods.acting(l);
    if (method != nullptr && !method->needs_voxels()) continue;
    query_link(world, l, cost);
    if (method != nullptr) method->take_over(links_[l]->contacts());
    const std::uint32_t found = count(l);
    cost.contacts += found;
    of_body_[i] += found;
    of_body_[j] += found;
  }
}

void Contacts::query_link(const World& world, std::size_t l, FrameCost& cost) {
  const auto [first, second] = world.links[l];
  QueryCost work;
  links_[l]->query(world.bodies[first].rigid.pose(), world.bodies[second].rigid.pose(), work);
  cost.clusters += work.clusters;
  cost.points_tested += work.points;
  cost.voxels_read += work.points;
  cost.bytes_touched += bytes_touched(work);
  cost.contacts_left_out += work.left_out;
}

}  // namespace verisim
