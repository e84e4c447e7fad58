// The passivity controller of the contacts (dynamics/integrator.hpp): contacts that a method changed, or that appeared
// when one was switched off, give no more energy than all contacts were given.
//
// Bodies that move and touch each other are one group. One scale acts for all of a group: what is taken from
// one side of a contact is taken from the other, and momentum stays. A group with a body that the exact response moves
// has all of its contacts: that response takes them as they are.
#pragma once

#include <vector>

#include "engine/dynamics/ledger.hpp"
#include "engine/simulation/stages/exact_response.hpp"

namespace verisim {

class Passivity {
 public:
  explicit Passivity(const World& world);
  void add_link() { watched_in_.push_back(kNone); }  ///< between frames

  /// Finds the scale of each body's contact forces in this frame.
  void bound(const World& world, const Contacts& contacts, const PairMethods& methods, const Response& response,
             const ExactResponse& exact, const Ledger& ledger);
  /// 0 to 1.
  [[nodiscard]] double scale(std::size_t body) const { return scale_[body]; }

 private:
  [[nodiscard]] bool watch_links(const World& world, const Contacts& contacts, const PairMethods& methods);
  void bound_groups(const World& world, const Response& response, const ExactResponse& exact, double budget);

  /// The last frame in which a link was watched: since its method changed something, until the two bodies part.
  std::vector<std::uint64_t> watched_in_;
  std::vector<bool> watched_;       ///< bodies, groups by their first body
  std::vector<bool> unbounded_;     ///< groups, by their first body
  std::vector<std::size_t> group_;  ///< of each body: the first body of its group
  std::vector<ContactWork> work_;   ///< of groups, by their first body
  std::vector<double> scale_;
};

}  // namespace verisim
