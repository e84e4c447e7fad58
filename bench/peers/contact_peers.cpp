// One contact query of the pin in the block, over the recorded poses, beside MuJoCo and FCL in the same run. Prints a
// table: microseconds per pose (median and 99th percentile over poses) and the ratio to this project's query.
//
// Each peer has the model it is fastest with (../shared/reference/peers/README.md): MuJoCo 64 convex wedges and its own
// cylinder; FCL two meshes, with each of its oriented bounding volumes. Placing the bodies is outside every clock.
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <cstdio>
#include <cstring>
#include <memory>

#include "bench/peg_scene.hpp"
#include "bench/plain_loop.hpp"
#include "bench/pose_times.hpp"
#include "engine/base/error.hpp"
#include "engine/base/pinned_math.hpp"
#include "engine/contact/query.hpp"

namespace verisim::bench {
namespace {

constexpr double kVoxelSize = 0.0045;

class MuJoCo {
 public:
  MuJoCo() {
    const std::string xml = scene();
    auto files = std::make_unique<mjVFS>();  // 1 MB of tables: not on the stack
    mj_defaultVFS(files.get());
    mj_makeEmptyFileVFS(files.get(), "peg.xml", static_cast<int>(xml.size()));
    std::memcpy(files->filedata[0], xml.data(), xml.size());
    char reason[1000] = "";
    model_ = mj_loadXML("peg.xml", files.get(), reason, sizeof reason);
    mj_deleteVFS(files.get());
    if (model_ == nullptr) fail(ErrorKind::input, "MuJoCo refuses the scene: {}", reason);
    data_ = mj_makeData(model_);
  }
  ~MuJoCo() {
    mj_deleteData(data_);
    mj_deleteModel(model_);
  }
  MuJoCo(const MuJoCo&) = delete;
  MuJoCo& operator=(const MuJoCo&) = delete;

  void place(const Pose& X_AB) {
    const Quaterniond& q = X_AB.rotation;
    const double values[7] = {X_AB.position.x(), X_AB.position.y(), X_AB.position.z(), q.w(), q.x(), q.y(), q.z()};
    std::copy(values, values + 7, data_->qpos);
    mj_kinematics(model_, data_);
  }
  int query() {
    mj_collision(model_, data_);
    return data_->ncon;
  }

 private:
  /// A wedge per sector between the hole, whose polygon's sides touch its circle, and the block's outer square.
  static std::string scene() {
    constexpr int kWedges = 64;
    std::string meshes;
    std::string geoms;
    for (int i = 0; i < kWedges; ++i) {
      std::string vertices;
      for (const int k : {i, i + 1}) {
        const double angle = 2 * pinned::kPi * k / kWedges;
        const Eigen::Vector2d d(std::cos(angle), std::sin(angle));
        const Eigen::Vector2d inner = kHoleRadius / std::cos(pinned::kPi / kWedges) * d;
        const Eigen::Vector2d outer = kBlockHalf.x() / d.cwiseAbs().maxCoeff() * d;
        for (const auto& p : {inner, outer}) {
          for (const double z : {-kBlockHalf.z(), kBlockHalf.z()}) {
            vertices += fmt::format("{:.17g} {:.17g} {:.17g} ", p.x(), p.y(), z);
          }
        }
      }
      meshes += fmt::format("<mesh name='w{}' vertex='{}'/>", i, vertices);
      geoms += fmt::format("<geom type='mesh' mesh='w{}' contype='1' conaffinity='2'/>", i);
    }
    return fmt::format(
        "<mujoco><size nconmax='2000' njmax='8000'/><asset>{}</asset><worldbody>{}<body><freejoint/>"
        "<geom type='cylinder' size='{} {}' contype='2' conaffinity='1'/></body></worldbody></mujoco>",
        meshes, geoms, kPinRadius, kPinHeight / 2);
  }

  mjModel* model_ = nullptr;
  mjData* data_ = nullptr;
};

template <typename BoundingVolume>
class Fcl {
 public:
  explicit Fcl(int facets) : block_(tree_of(shapes::trial_block(facets))), pin_(tree_of(pin_mesh(facets))) {
    request_.num_max_contacts = 1000000;
    request_.enable_contact = true;
  }
  void place(const Pose& X_AB) {
    X_AB_ = fcl::Transform3d::Identity();
    X_AB_.linear() = X_AB.rotation.toRotationMatrix();
    X_AB_.translation() = X_AB.position;
  }
  std::size_t query() {
    fcl::CollisionResultd result;
    return fcl::collide(&block_, fcl::Transform3d::Identity(), &pin_, X_AB_, request_, result);
  }

 private:
  using Tree = fcl::BVHModel<BoundingVolume>;
  static Tree tree_of(const TriangleMesh& mesh) {
    Tree tree;
    tree.beginModel();
    std::vector<fcl::Triangle> triangles;
    for (const auto& [a, b, c] : mesh.triangles) triangles.emplace_back(a, b, c);
    tree.addSubModel(mesh.vertices, triangles);
    tree.endModel();
    return tree;
  }
  Tree block_, pin_;
  fcl::Transform3d X_AB_;
  fcl::CollisionRequestd request_;
};

struct Row {
  std::string name;
  PoseTimes times;
  std::size_t contacts = 0;
};

template <typename Peer>
void run_round(Peer& peer, Row& row) {
  row.times.round([&](const Pose& X) { peer.place(X); },
                  [&](const Pose&) { row.contacts += static_cast<std::size_t>(peer.query()); });
}

int compare() {
  const std::vector<Pose> poses = load_peg_poses().X_AB;
  if (poses.empty()) {
    std::puts("../shared/reference/peers/peg_poses.csv is absent: nothing to compare on");
    return 0;
  }
  const PegScene scene = make_peg_scene(kVoxelSize);
  const PlainLoop plain(scene.block.voxmap, scene.pin.shell);
  ContactList contacts(scene.pin.shell.size());
  QueryCost cost;
  MuJoCo mujoco;
  constexpr int kFacets = 152;  // the block's mesh needs a multiple of four
  Fcl<fcl::OBBRSSd> obbrss(kFacets);
  Fcl<fcl::OBBd> obb(kFacets);
  Fcl<fcl::kIOSd> kios(kFacets);

  const auto row = [&](const char* name) { return Row{name, PoseTimes(poses)}; };
  Row rows[] = {row("verisim"),
                row("plain voxmap loop, scalar"),
                row("MuJoCo, 64 wedges and a cylinder"),
                row("FCL mesh, OBBRSS"),
                row("FCL mesh, OBB"),
                row("FCL mesh, kIOS")};
  double force = 0;
  for (int round = 0; round < 5; ++round) {
    rows[0].times.round([&](const Pose& X) { query(scene.block.voxmap, scene.pin.shell, X, contacts, cost); });
    rows[1].times.round([&](const Pose& X) { force += plain.force(X, 1000).force.norm(); });
    run_round(mujoco, rows[2]);
    run_round(obbrss, rows[3]);
    run_round(obb, rows[4]);
    run_round(kios, rows[5]);
  }
  fmt::print("{} poses, {} points of {} mm, {}; us per query\n", poses.size(), scene.pin.shell.size(),
             1000 * kVoxelSize, simd_targets().front());
  fmt::print("{:36} {:>9} {:>9} {:>9}\n", "", "median", "p99", "ratio");
  const double unit = rows[0].times.percentile(0.5);
  for (const Row& r : rows) {
    const double median = r.times.percentile(0.5);
    fmt::print("{:36} {:9.2f} {:9.2f} {:9.1f}\n", r.name, median, r.times.percentile(0.99), median / unit);
  }
  return force > 0 && rows[2].contacts > 0 && rows[3].contacts > 0 ? 0 : 1;  // all of them must have found contacts
}

}  // namespace
}  // namespace verisim::bench

int main() {
  return verisim::bench::compare();
}
