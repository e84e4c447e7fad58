#include "engine/stability/ledger.hpp"

#include <algorithm>
#include <cmath>

namespace verisim::stability {
namespace {

/// Volume, first and second moments of what triangles enclose: tetrahedra from the origin, each with the closed form of
/// its moments. Nothing of engine/geometry's own integration takes part.
struct Moments {
  double volume = 0;
  Vector3d first = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();  ///< of x x^T

  void add(const TriangleMesh& mesh) {
    for (const auto& [i, j, k] : mesh.triangles) {
      const Vector3d &a = mesh.vertices[i], &b = mesh.vertices[j], &c = mesh.vertices[k];
      const double v = a.dot(b.cross(c)) / 6;
      const Vector3d sum = a + b + c;
      volume += v;
      first += v / 4 * sum;
      second += v / 20 * (sum * sum.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
    }
  }
  /// About the centre of mass, of density 1.
  [[nodiscard]] Matrix3d inertia() const {
    const Matrix3d central = second - first * first.transpose() / volume;
    return central.trace() * Matrix3d::Identity() - central;
  }
};

}  // namespace

EnergyAudit::EnergyAudit(const Scene& scene) {
  for (const BodyDescription& description : scene.bodies) {
    Moments moments;
    for (const Part& part : description.parts) moments.add(part.mesh);
    Body& body = bodies_.emplace_back();
    body.density = description.density;
    body.mass = description.density * moments.volume;
    body.inertia_B = description.density * moments.inertia();
  }
}

double EnergyAudit::kinetic_of(const Body& body, std::size_t i, const Simulation& simulation) const {
  const Twist twist = simulation.body_twist(i);
  const Vector3d omega_B = simulation.body_pose(i).rotation.conjugate() * twist.angular;
  return 0.5 * body.mass * twist.linear.squaredNorm() + 0.5 * omega_B.dot(body.inertia_B * omega_B);
}

void EnergyAudit::start(const Simulation& simulation) {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    bodies_[i].before = simulation.body_twist(i);
    kinetic_start_ += kinetic_of(bodies_[i], i, simulation);
  }
  kinetic_ = kinetic_start_;
}

void EnergyAudit::look(const Simulation& simulation) {
  kinetic_ = 0;
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    Body& body = bodies_[i];
    const Twist now = simulation.body_twist(i);
    const Wrench wrench = simulation.body_force(i);
    const double half = 0.5 * simulation.dt();
    const double work = half * (wrench.force.dot(body.before.linear + now.linear) +
                                wrench.torque.dot(body.before.angular + now.angular));
    contact_ -= work;
    turnover_ += std::abs(work);
    kinetic_ += kinetic_of(body, i, simulation);
    body.before = now;
  }
  const Simulation::Energy book = simulation.energy();
  created_ = std::max(created_, -contact_);
  created_by_book_ = std::max(created_by_book_, -book.contact);
  difference_ = std::max(difference_, std::abs(contact_ - book.contact));
}

Row EnergyAudit::row(const std::string& what, const Simulation& simulation) const {
  const Simulation::Energy book = simulation.energy();
  const double through = turnover_ + std::abs(book.input) + book.dissipated;
  const double bound = 1e-6 + 0.01 * through;
  Row row;
  row.what = what;
  row.theory = "contacts create less than 1 uJ and 1 % of what went through";
  row.figures = {{"input", "J", book.input},
                 {"dissipated", "J", book.dissipated},
                 {"contact", "J", book.contact},
                 {"kinetic", "J", book.kinetic},
                 {"coupling", "J", book.coupling},
                 {"gravity", "J", book.gravity},
                 {"numerical", "J", book.numerical},
                 {"closing_error", "J", book.residual},
                 {"contact_recomputed", "J", contact_},
                 {"kinetic_recomputed", "J", kinetic_},
                 {"difference", "J", difference_},
                 {"went_through", "J", through},
                 {"created", "J", std::max(created_, created_by_book_)},
                 {"frames", "1", static_cast<double>(simulation.frame())}};
  const bool created = std::max(created_, created_by_book_) > bound;
  const bool agree = difference_ <= bound && std::abs(kinetic_ - book.kinetic) <= bound;
  const bool closes = std::abs(book.residual) <= 1e-9 * std::max(1.0, through);
  row.holds = !created && agree && closes;
  row.outcome = created ? Outcome::diverged : Outcome::stable;
  if (created) row.why = "contacts create energy";
  if (!agree) row.why += std::string(row.why.empty() ? "" : "; ") + "the book and poses with wrenches disagree";
  if (!closes) row.why += std::string(row.why.empty() ? "" : "; ") + "the book does not close";
  return row;
}

}  // namespace verisim::stability
