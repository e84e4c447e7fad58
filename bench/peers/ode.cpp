// ODE in double precision: a closed mesh of the block, or boxes around the hole, and its own cylinder.
#include <fmt/format.h>
#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <memory>

#include "bench/peers/peer.hpp"
#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"

namespace verisim::peers {
namespace {

struct OdeOptions {
  bool boxes = false;
  double erp = 0.2;
  int iterations = 0;  ///< of dWorldQuickStep; 0: dWorldStep
  int sides = kWedges;
};

constexpr int kContactsOfAPair = 64;

class Ode final : public Pusher, public Finder {
 public:
  Ode(const Insertion& task, const OdeOptions& options, const Pose& start)
      : coupling_{kHoleRadius - task.clearance}, options_(options) {
    static const int kOnce = dInitODE2(0);
    if (kOnce == 0) fail(ErrorKind::io, "ODE does not start");
    world_ = dWorldCreate();
    space_ = dHashSpaceCreate(nullptr);
    joints_ = dJointGroupCreate(0);
    dWorldSetERP(world_, options.erp);
    dWorldSetCFM(world_, 1e-10);
    if (options.iterations > 0) dWorldSetQuickStepNumIterations(world_, options.iterations);
    body_ = dBodyCreate(world_);
    const Vector3d I = coupling_.inertia();
    dMass mass;
    dMassSetParameters(&mass, 1, 0, 0, 0, I.x(), I.y(), I.z(), 0, 0, 0);
    dBodySetMass(body_, &mass);
    dGeomSetBody(dCreateCylinder(space_, coupling_.radius, kPinLength), body_);
    if (options.boxes)
      add_boxes(task.chamfer);
    else
      add_mesh(task.chamfer);
    place(start);
  }
  ~Ode() override {
    dJointGroupDestroy(joints_);
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
    if (mesh_ != nullptr) dGeomTriMeshDataDestroy(mesh_);
  }
  [[nodiscard]] Motion motion() const override {
    const double *p = dBodyGetPosition(body_), *q = dBodyGetQuaternion(body_), *v = dBodyGetLinearVel(body_),
                 *w = dBodyGetAngularVel(body_);
    return {{{p[0], p[1], p[2]}, Quaterniond(q[0], q[1], q[2], q[3])}, {v[0], v[1], v[2]}, {w[0], w[1], w[2]}};
  }
  Vector3d step(const Hand& hand) override {
    const Wrench w = coupling_.pull(hand, motion());
    dBodyAddForce(body_, w.force.x(), w.force.y(), w.force.z());
    dBodyAddTorque(body_, w.torque.x(), w.torque.y(), w.torque.z());
    query();
    for (const dContactGeom& geom : contacts_) {
      dContact contact{};
      contact.geom = geom;  // without friction
      dJointAttach(dJointCreateContact(world_, joints_, &contact), dGeomGetBody(geom.g1), dGeomGetBody(geom.g2));
    }
    if (options_.iterations > 0)
      dWorldQuickStep(world_, kStep);
    else
      dWorldStep(world_, kStep);
    dJointGroupEmpty(joints_);
    return w.force;
  }
  void place(const Pose& X) override {
    const Quaterniond& q = X.rotation;
    const std::array<dReal, 4> rotation{q.w(), q.x(), q.y(), q.z()};
    dBodySetPosition(body_, X.position.x(), X.position.y(), X.position.z());
    dBodySetQuaternion(body_, rotation.data());
  }
  double query() override {
    contacts_.clear();
    dSpaceCollide(space_, this, &Ode::collide);
    double deepest = kNothing;
    for (const dContactGeom& contact : contacts_) deepest = std::max(deepest, static_cast<double>(contact.depth));
    return deepest;
  }

 private:
  static void collide(void* self, dGeomID a, dGeomID b) {
    auto& ode = *static_cast<Ode*>(self);
    if (dGeomGetBody(a) == dGeomGetBody(b)) return;
    std::array<dContactGeom, kContactsOfAPair> found;
    const int n = dCollide(a, b, kContactsOfAPair, found.data(), sizeof(dContactGeom));
    ode.contacts_.insert(ode.contacts_.end(), found.begin(), found.begin() + n);
  }
  void add_mesh(double chamfer) {
    const Mesh mesh = block_mesh(chamfer, options_.sides);
    for (const Vector3d& v : mesh.vertices) vertices_.insert(vertices_.end(), {v.x(), v.y(), v.z()});
    for (const auto& [a, b, c] : mesh.triangles)
      for (const int i : {a, b, c}) triangles_.push_back(static_cast<dTriIndex>(i));
    mesh_ = dGeomTriMeshDataCreate();
    dGeomTriMeshDataBuildDouble(mesh_, vertices_.data(), 3 * sizeof(double), static_cast<int>(mesh.vertices.size()),
                                triangles_.data(), static_cast<int>(triangles_.size()), 3 * sizeof(dTriIndex));
    dCreateTriMesh(space_, mesh_, nullptr, nullptr, nullptr);
  }
  /// A box, turned about z by `angle` and then tilted by `tilt` about its own y, whose inner face has its middle `at`.
  void add_box(double angle, double tilt, const Vector3d& at, const Vector3d& size) {
    const Quaterniond q =
        rotation_from_vector(angle * Vector3d::UnitZ()) * rotation_from_vector(tilt * Vector3d::UnitY());
    const Vector3d centre = rotation_from_vector(angle * Vector3d::UnitZ()) * at + q * Vector3d(size.x() / 2, 0, 0);
    dGeomID box = dCreateBox(space_, size.x(), size.y(), size.z());
    const std::array<dReal, 4> rotation{q.w(), q.x(), q.y(), q.z()};
    dGeomSetPosition(box, centre.x(), centre.y(), centre.z());
    dGeomSetQuaternion(box, rotation.data());
  }
  void add_boxes(double chamfer) {
    constexpr double kThick = 0.05;
    const int sides = options_.sides;
    for (int i = 0; i < sides; ++i) {
      const double angle = 2 * pinned::kPi * (i + 0.5) / sides, side = 2 * std::tan(pinned::kPi / sides);
      add_box(angle, 0, {kHoleRadius, 0, -chamfer / 2}, {kThick, side * kHoleRadius, kBlockHeight - chamfer});
      if (chamfer <= 0) continue;
      const double outer = kHoleRadius + chamfer, middle = kHoleRadius + chamfer / 2;
      add_box(angle, pinned::kPi / 4, {middle, 0, kBlockHeight / 2 - chamfer / 2},
              {chamfer / 2, side * outer, chamfer * std::sqrt(2.0)});
      add_box(angle, 0, {outer, 0, kBlockHeight / 2 - chamfer / 2}, {kThick, side * outer, chamfer});
    }
  }

  Coupling coupling_;
  OdeOptions options_;
  dWorldID world_ = nullptr;
  dSpaceID space_ = nullptr;
  dJointGroupID joints_ = nullptr;
  dBodyID body_ = nullptr;
  dTriMeshDataID mesh_ = nullptr;
  std::vector<double> vertices_;
  std::vector<dTriIndex> triangles_;
  std::vector<dContactGeom> contacts_;
};

}  // namespace

Engine peer_ode() {
  Engine engine{.name = "ODE", .version = VERISIM_ODE_VERSION, .package = "libode-dev"};
  for (const bool boxes : {true, false})
    for (const int iterations : {0, 20, 200})
      for (const double erp : {0.2, 0.8}) {
        const OdeOptions options{boxes, erp, iterations};
        engine.pushes.push_back(
            {.text = fmt::format("{}, {}, ERP {}", boxes ? "boxes" : "mesh",
                                 iterations > 0 ? fmt::format("QuickStep of {}", iterations) : "Step", erp),
             .make = [options](const Insertion& task, const Pose& start) -> std::unique_ptr<Pusher> {
               return std::make_unique<Ode>(task, options, start);
             }});
      }
  for (const bool boxes : {true, false})
    for (const int sides : {64, 256}) {
      const OdeOptions options{.boxes = boxes, .sides = sides};
      engine.finds.push_back({.text = boxes ? fmt::format("{} boxes", sides) : fmt::format("mesh of {} sides", sides),
                              .make = [options](double clearance) -> std::unique_ptr<Finder> {
                                return std::make_unique<Ode>(Insertion{.clearance = clearance}, options, Pose());
                              }});
    }
  return engine;
}

}  // namespace verisim::peers
