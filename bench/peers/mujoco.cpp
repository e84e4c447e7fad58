// MuJoCo: 64 convex wedges and its own cylinder.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "bench/peers/peer.hpp"
#include "engine/base/error.hpp"

namespace verisim::peers {
namespace {

/// Contact parameters; whether the friction cone is elliptic and convex shapes may touch at several points.
struct MuJoCoOptions {
  std::string contact;
  bool elliptic = false;
};

class MuJoCo final : public Peer {
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
    double nearest = 1;
    for (int i = 0; i < data_->ncon; ++i) nearest = std::min(nearest, data_->contact[i].dist);
    return -nearest;
  }

 private:
  [[nodiscard]] std::string scene(const Insertion& task, const MuJoCoOptions& options) const {
    std::string meshes, geoms;
    for (int i = 0; i < kWedges; ++i) {
      std::string vertices;
      for (const Vector3d& p : wedge(i, task.chamfer))
        vertices += fmt::format("{:.17g} {:.17g} {:.17g} ", p.x(), p.y(), p.z());
      meshes += fmt::format("<mesh name='w{}' vertex='{}'/>", i, vertices);
      geoms += fmt::format("<geom type='mesh' mesh='w{}' contype='1' conaffinity='2'/>", i);
    }
    const Vector3d I = coupling_.inertia();
    return fmt::format(
        "<mujoco><size nconmax='2000' njmax='8000'/><option timestep='{}' gravity='0 0 0' cone='{}' iterations='200' "
        "tolerance='1e-12'><flag multiccd='{}'/></option><default><geom condim='1' margin='0.0005' "
        "gap='0' {}/></default>"
        "<asset>{}</asset><worldbody><body><freejoint/><inertial pos='0 0 0' mass='1' diaginertia='{} {} {}'/>"
        "<geom type='cylinder' size='{:.17g} {:.17g}' contype='2' conaffinity='1'/></body>{}</worldbody></mujoco>",
        kStep, options.elliptic ? "elliptic" : "pyramidal", options.elliptic ? "enable" : "disable", options.contact,
        meshes, I.x(), I.y(), I.z(), coupling_.radius, kPinLength / 2, geoms);
  }
  Coupling coupling_;
  std::unique_ptr<mjModel, decltype(&mj_deleteModel)> model_{nullptr, &mj_deleteModel};
  std::unique_ptr<mjData, decltype(&mj_deleteData)> data_{nullptr, &mj_deleteData};
};

}  // namespace

std::vector<Setting> settings_of_mujoco() {
  std::vector<Setting> settings;
  for (const char* time_constant : {"0.02", "0.004", "0.002"})  // 2 steps are the least that it takes
    for (const char* impedance : {"0.9 0.95 0.001", "0.95 0.99 0.001", "0.99 0.9999 0.001"})
      for (const bool elliptic : {false, true}) {
        const MuJoCoOptions options{fmt::format("solref='{} 1' solimp='{}'", time_constant, impedance), elliptic};
        settings.push_back({.engine = "MuJoCo",
                            .text = options.contact + (elliptic ? " elliptic multiccd" : " pyramidal"),
                            .make = [options](const Insertion& task, const Pose& start) -> std::unique_ptr<Peer> {
                              return std::make_unique<MuJoCo>(task, options, start);
                            }});
      }
  return settings;
}

}  // namespace verisim::peers
