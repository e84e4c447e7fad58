// Who gave energy to a run, and who took it: what the engine's own book says (dynamics/ledger.hpp), and the same
// recomputed from poses, velocities and wrenches alone, with masses and moments integrated here from the triangles.
#pragma once

#include <vector>

#include "engine/simulation/simulation.hpp"
#include "engine/stability/row.hpp"

namespace verisim::stability {

class EnergyAudit {
 public:
  /// What of the scene is needed; before a simulation takes it.
  explicit EnergyAudit(const Scene& scene);
  /// Before the first step.
  void start(const Simulation& simulation);
  /// After every step.
  void look(const Simulation& simulation);
  /// `created`: the most that all contacts together had given beyond what they were given, by either account.
  /// Outcome stable, unless that is beyond the bound: 1 uJ and 1 % of what went through.
  [[nodiscard]] Row row(const std::string& what, const Simulation& simulation) const;

 private:
  struct Body {
    double density = 0;
    double mass = 0;
    Matrix3d inertia_B = Matrix3d::Zero();  ///< about the centre of mass
    Twist before;
  };
  [[nodiscard]] double kinetic_of(const Body& body, std::size_t i, const Simulation& simulation) const;

  std::vector<Body> bodies_;
  double kinetic_start_ = 0, kinetic_ = 0;
  double contact_ = 0;   ///< J, taken by contacts, recomputed
  double turnover_ = 0;  ///< J, of all works of contacts, each counted positive
  double created_ = 0, created_by_book_ = 0, difference_ = 0;
};

}  // namespace verisim::stability
