// MuJoCo: 64 convex wedges and its own cylinder.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>

#include "bench/peers/peer.hpp"
#include "engine/base/error.hpp"

namespace verisim::peers {
namespace {

/// Contact parameters; whether the friction cone is elliptic, whether convex shapes may touch at several points, and
/// how far off contacts are told.
struct MuJoCoOptions {
  std::string contact;
  bool elliptic = false, several = false;
  double margin = 0;        ///< m; it pushes from there, so an insertion has none: it would close the hole
  double tolerance = 1e-6;  ///< of the search for the deepest point (mpr_tolerance)
  int wedges = kWedges;
  int rows = 8000;  ///< of the contact problem, whose matrix is reserved: 512 MB
};

class MuJoCo final : public Pusher, public Finder {
 public:
  MuJoCo(const Insertion& task, const MuJoCoOptions& options, const Pose& start)
      : coupling_{kHoleRadius - task.clearance} {
    const std::string xml = scene(task, options);
    auto files = std::make_unique<mjVFS>();  // 1 MB of tables: not on the stack
    mj_defaultVFS(files.get());
    mj_makeEmptyFileVFS(files.get(), "pin.xml", static_cast<int>(xml.size()));
    std::memcpy(files->filedata[0], xml.data(), xml.size());
    char reason[1000] = "";
    model_.reset(mj_loadXML("pin.xml", files.get(), reason, sizeof reason));
    mj_deleteVFS(files.get());
    if (!model_) fail(ErrorKind::input, "MuJoCo refuses the scene: {}", reason);
    data_.reset(mj_makeData(model_.get()));
    place(start);
  }
  [[nodiscard]] Motion motion() const override {
    const double *q = data_->qpos, *v = data_->qvel;
    if (blown_up_) return {{Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()), Quaterniond::Identity()}};
    Motion m{{{q[0], q[1], q[2]}, Quaterniond(q[3], q[4], q[5], q[6])}};
    m.v = {v[0], v[1], v[2]};
    m.omega = m.X_WB.rotation * Vector3d(v[3], v[4], v[5]);
    return m;
  }
  Vector3d step(const Hand& hand) override {
    const Wrench w = coupling_.pull(hand, motion());
    double* applied = data_->xfrc_applied + 6;  // of the first body after the world
    for (int i = 0; i < 3; ++i) applied[i] = w.force[i], applied[3 + i] = w.torque[i];
    mj_step(model_.get(), data_.get());
    // It begins again where the model has the pin: within the hole, as if it had come through.
    for (const int warning : {mjWARN_BADQPOS, mjWARN_BADQVEL, mjWARN_BADQACC})
      blown_up_ = blown_up_ || data_->warning[warning].number > 0;
    return w.force;
  }
  void place(const Pose& X) override {
    const Quaterniond& q = X.rotation;
    const double values[7] = {X.position.x(), X.position.y(), X.position.z(), q.w(), q.x(), q.y(), q.z()};
    std::copy(values, values + 7, data_->qpos);
    mj_kinematics(model_.get(), data_.get());
  }
  double query() override {
    mj_collision(model_.get(), data_.get());
    double nearest = -kNothing;
    for (int i = 0; i < data_->ncon; ++i) nearest = std::min(nearest, data_->contact[i].dist);
    return -nearest;
  }

 private:
  [[nodiscard]] std::string scene(const Insertion& task, const MuJoCoOptions& options) const {
    std::string meshes, geoms;
    for (int i = 0; i < options.wedges; ++i) {
      std::string vertices;
      for (const Vector3d& p : wedge(i, {.chamfer = task.chamfer, .wedges = options.wedges}))
        vertices += fmt::format("{:.17g} {:.17g} {:.17g} ", p.x(), p.y(), p.z());
      meshes += fmt::format("<mesh name='w{}' vertex='{}'/>", i, vertices);
      geoms += fmt::format("<geom type='mesh' mesh='w{}' contype='1' conaffinity='2'/>", i);
    }
    const Vector3d I = coupling_.inertia();
    return fmt::format(
        "<mujoco><size nconmax='2000' njmax='{}'/><option timestep='{}' gravity='0 0 0' cone='{}' iterations='200' "
        "tolerance='1e-12' mpr_tolerance='{}' mpr_iterations='200'><flag multiccd='{}'/></option>"
        "<default><geom condim='1' margin='{}' gap='0' {}/></default>"
        "<asset>{}</asset><worldbody><body><freejoint/><inertial pos='0 0 0' mass='1' diaginertia='{} {} {}'/>"
        "<geom type='cylinder' size='{:.17g} {:.17g}' contype='2' conaffinity='1'/></body>{}</worldbody></mujoco>",
        options.rows, kStep, options.elliptic ? "elliptic" : "pyramidal", options.tolerance,
        options.several ? "enable" : "disable", options.margin, options.contact, meshes, I.x(), I.y(), I.z(),
        coupling_.radius, kPinLength / 2, geoms);
  }
  Coupling coupling_;
  bool blown_up_ = false;
  std::unique_ptr<mjModel, decltype(&mj_deleteModel)> model_{nullptr, &mj_deleteModel};
  std::unique_ptr<mjData, decltype(&mj_deleteData)> data_{nullptr, &mj_deleteData};
};

}  // namespace

Engine peer_mujoco() {
  Engine engine{.name = "MuJoCo", .version = mj_versionString(), .package = "libmujoco-dev"};
  for (const char* time_constant : {"0.02", "0.004", "0.002"})  // 2 steps are the least that it takes
    for (const char* impedance : {"0.9 0.95 0.001", "0.95 0.99 0.001", "0.99 0.9999 0.001"})
      for (const bool elliptic : {false, true}) {
        const MuJoCoOptions options{.contact = fmt::format("solref='{} 1' solimp='{}'", time_constant, impedance),
                                    .elliptic = elliptic,
                                    .several = elliptic};
        engine.pushes.push_back(
            {.text = options.contact + (elliptic ? " elliptic multiccd" : " pyramidal"),
             .make = [options](const Insertion& task, const Pose& start) -> std::unique_ptr<Pusher> {
               return std::make_unique<MuJoCo>(task, options, start);
             }});
      }
  for (const int wedges : {64, 256})
    for (const double margin : {0.0, 0.0005, 0.005})
      for (const bool several : {false, true})
        for (const double tolerance : {1e-6, 1e-9}) {
          const MuJoCoOptions options{
              .contact = "", .several = several, .margin = margin, .tolerance = tolerance, .wedges = wedges, .rows = 1};
          engine.finds.push_back({.text = fmt::format("{} wedges, margin {:g} mm, mpr_tolerance {:g}{}", wedges,
                                                      1e3 * margin, tolerance, several ? ", multiccd" : ""),
                                  .make = [options](double clearance) -> std::unique_ptr<Finder> {
                                    return std::make_unique<MuJoCo>(Insertion{.clearance = clearance}, options, Pose());
                                  }});
        }
  return engine;
}

}  // namespace verisim::peers
