#include "engine/simulation/stages/contacts.hpp"

#include "engine/base/error.hpp"
#include "engine/simulation/stages/neighbours.hpp"
#include "engine/simulation/stages/pair_methods.hpp"

namespace verisim {
Contacts::Contacts(const World& world)
    : of_body_(world.bodies.size(), 0), p_WC_(world.bodies.size(), Vector3d::Zero()) {}

void Contacts::add_link(const World& world, std::size_t l) {
  VERISIM_ASSERT(l == links_.size());
  const Body& first = world.bodies[world.links[l].first];
  const Body& second = world.bodies[world.links[l].second];
  VERISIM_ASSERT(first.voxels != nullptr);
  VERISIM_ASSERT(second.voxels != nullptr);
  links_.push_back(std::make_unique<CollisionLink>(*first.voxels, *second.voxels));
  if (first.mesh) links_.back()->find_by_triangles(*first.mesh, *second.mesh);
  meets_.push_back(false);
  asked_.push_back(false);
}

Pose Contacts::X_AB(const World& world, std::size_t l) const {
  VERISIM_ASSERT(l < links_.size());
  const Pose X_W1 = world.bodies[world.links[l].first].rigid.pose();
  const Pose X_W2 = world.bodies[world.links[l].second].rigid.pose();
  return links_[l]->first_is_map() ? X_W1.inverse() * X_W2 : X_W2.inverse() * X_W1;
}

void Contacts::query(const World& world, const Neighbours& neighbours, const PairMethods& methods, FrameCost& cost) {
  for (const std::size_t i : world.busy) {
    of_body_[i] = 0;
    p_WC_[i] = world.bodies[i].rigid.p_WC;
  }
  for (const std::size_t l : world.near_links) {
    if (asked_[l]) links_[l]->clear();
    asked_[l] = false;
    const auto [i, j, number] = world.links[l];
    meets_[l] = gap(neighbours.box(i), neighbours.box(j)) <= 0;
    if (!meets_[l]) continue;
    ++cost.pairs_tested;
    if (!methods.needs_voxels(l)) continue;
    asked_[l] = true;
    query_link(world, l, cost);
    if (const PairMethod* method = methods.acting(l)) method->take_over(links_[l]->contacts());
    const std::uint32_t found = count(l);
    cost.contacts += found;
    of_body_[i] += found;
    of_body_[j] += found;
  }
}

void Contacts::query_link(const World& world, std::size_t l, FrameCost& cost) {
  const auto [first, second, number] = world.links[l];
  QueryCost work;
  links_[l]->query(world.bodies[first].rigid.pose(), world.bodies[second].rigid.pose(), work);
  cost.clusters += work.clusters;
  cost.points_tested += work.points;
  cost.voxels_read += work.points;
  cost.bytes_touched += bytes_touched(work);
  cost.contacts_left_out += work.left_out;
}

}  // namespace verisim
