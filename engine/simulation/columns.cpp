// What a row of a run file holds (INTERFACES section 2), in one table: make_schema names the columns, fill_row fills
// them in the same order. The row's state bytes, chained to the hash of the row before, are the state hash.
#include <cstring>

#include "engine/base/hash.hpp"
#include "engine/simulation/world.hpp"
#include "engine/wii/head.hpp"

namespace verisim {
namespace {

const std::vector<std::string> kConstraintNames(kConstraintKindNames.begin(), kConstraintKindNames.end());

/// Appends values to a row in the order of the schema's columns.
class RowWriter {
 public:
  explicit RowWriter(std::vector<std::byte>& row) : at_(row.data()) {}
  template <typename T>
  void put(T value) {
    std::memcpy(at_, &value, sizeof value);
    at_ += sizeof value;
  }
  void put(const Vector3d& v) {
    for (int i = 0; i < 3; ++i) put(v[i]);
  }
  void put(const Pose& X) {
    put(X.position);
    for (const double q : {X.rotation.x(), X.rotation.y(), X.rotation.z(), X.rotation.w()}) put(q);
  }
  void put(const Wrench& w) {
    put(w.force);
    put(w.torque);
  }
  [[nodiscard]] const std::byte* at() const { return at_; }

 private:
  std::byte* at_;
};

/// Counts the reports of a frame. A frame that took some adds a row to the head's datasets: the last of them.
std::string reports_of(const wii::Head& head) {
  return "/cost/wii/" + head.name() + "/reports";
}

}  // namespace

void Simulation::Implementation::make_schema() {
  const auto add = [&](const std::string& path, Dtype dtype, std::size_t width, const char* units, const char* what) {
    schema.add({path, dtype, width, units, what, 0, {}});
  };
  add("/state/time", Dtype::f64, 1, "s", "simulated time at the end of the frame");
  for (const Body& body : bodies) {
    const std::string path = "/state/body/" + body.name;
    add(path + "/pose", Dtype::f64, 7, "m, 1", "world pose of the body coordinates: position, quaternion x y z w");
    add(path + "/twist", Dtype::f64, 6, "m/s, rad/s", "velocity of the centre of mass, angular velocity; world");
    add(path + "/force", Dtype::f64, 6, "N, N m",
        "contact wrench on the body as applied, about its centre of mass; world");
  }
  for (const auto& device : devices) {
    const std::string path = "/state/device/" + device->name();
    add(path + "/handle_pose", Dtype::f64, 7, "m, 1", "virtual handle: position, quaternion x y z w");
    add(path + "/raw_pose", Dtype::f64, 7, "m, 1", "what the hardware reports: position, quaternion x y z w");
    add(path + "/wrench", Dtype::f64, 6, "N, N m", "what the hardware is told to render, about the handle");
  }
  for (const Link& link : links) {
    const std::string path = "/state/link/" + bodies[link.first].name + "~" + bodies[link.second].name;
    add(path + "/contacts", Dtype::u32, 1, "1",
        "colliding voxel pairs; places of precise contact where the method is exact");
    add(path + "/cache_hits", Dtype::u32, 1, "1", "constraint look-ups that were memoized");
    add(path + "/cache_misses", Dtype::u32, 1, "1", "constraint look-ups that had to be recognized");
    schema.add({path + "/constraint", Dtype::u8, 1, "1",
                "strongest recognized constraint; none where the method is exact or off", 0, kConstraintNames});
    add(path + "/alignment", Dtype::f64, 1, "1", "alignment alpha of that constraint");
    add(path + "/max_penetration", Dtype::f64, 1, "m", "deepest contact");
    add(path + "/wrench", Dtype::f64, 6, "N, N m",
        "on the second body by the first as applied, about the second's centre of mass; world");
  }
  for (const auto& head : heads) {
    const std::string path = "/state/wii/" + head->name();
    const std::string due = reports_of(*head);
    const auto add_at_reports = [&](const char* name, Dtype dtype, std::size_t width, const char* units,
                                    const char* what) {
      schema.add({path + name, dtype, width, units, what, 0, {}, due});
    };
    add_at_reports("/time", Dtype::f64, 1, "s", "when the remote took the report");
    add_at_reports("/channels", Dtype::f64, wii::kChannels, "1, g, pixel",
                   "battery, acceleration x y z, four times u v size (-1: nothing seen)");
    add_at_reports("/truth_pose", Dtype::f64, 7, "m, 1", "true head in levelled coordinates; NaN if not known");
    add_at_reports("/estimate_pose", Dtype::f64, 7, "m, 1", "what the tracker says, in levelled coordinates");
    add_at_reports("/valid", Dtype::u8, 1, "1", "1: the tracker stands by it");
  }
  add("/state/energy", Dtype::f64, 8, "J",
      "kinetic, coupling springs, gravity, dissipated, given to contact, numerical, input by hands, residual of their "
      "balance");
  add("/state/hash", Dtype::u64, 1, "1",
      "XXH3-64 of all values of /state in this row, seeded with the hash of the row before");
  add("/cost/pairs_tested", Dtype::u32, 1, "1", "pairs of bodies queried");
  add("/cost/clusters", Dtype::u32, 1, "1", "clusters of points looked at");
  add("/cost/points_tested", Dtype::u32, 1, "1", "points transformed and looked up");
  add("/cost/voxels_read", Dtype::u32, 1, "1", "voxels read");
  add("/cost/contacts", Dtype::u32, 1, "1", "contacts found");
  add("/cost/lookups", Dtype::u32, 1, "1", "pairs of feature sets looked up");
  add("/cost/recognitions", Dtype::u32, 1, "1", "pairs of entities that recognition looked at");
  add("/cost/exact_samples", Dtype::u32, 1, "1", "samples of precise edges tried against precise faces");
  add("/cost/solver_steps", Dtype::u32, 1, "1", "Newton iterations of the exact response");
  add("/cost/bytes_touched", Dtype::u32, 1, "B", "of voxels, points and contacts, by the queries");
  for (const auto& head : heads) add(reports_of(*head), Dtype::u32, 1, "1", "reports tracked");
  row.assign(schema.row_bytes(), std::byte{0});
}

void Simulation::Implementation::fill_row() {
  RowWriter out(row);
  out.put(static_cast<double>(frame) * dt);
  for (const Body& body : bodies) {
    out.put(body.rigid.pose());
    out.put(body.rigid.v_C);
    out.put(body.rigid.omega);
    out.put(body.contact_wrench);
  }
  for (const auto& device : devices) {
    out.put(device->reading().handle);
    out.put(device->reading().raw);
    out.put(device->rendered());
  }
  for (const Link& link : links) {
    out.put(link.contacts);
    out.put(link.cache_hits);
    out.put(link.cache_misses);
    out.put(static_cast<std::uint8_t>(link.constraint));
    out.put(link.alpha);
    out.put(link.depth_max);
    out.put(link.on_second);
  }
  for (const auto& head : heads) {
    out.put(head->sensed().t);
    for (const double channel : head->sensed().channels) out.put(channel);
    out.put(head->sensed().X_LH);
    out.put(head->estimate().pose);
    out.put(static_cast<std::uint8_t>(head->estimate().valid));
  }
  for (const double e : {energy.kinetic, energy.coupling, energy.gravity, ledger.dissipated(), ledger.contact(),
                         ledger.numerical(), ledger.input(), ledger.residual(energy)})
    out.put(e);
  VERISIM_ASSERT(out.at() == row.data() + schema.state_bytes());
  hash = hash_bytes(row.data(), schema.state_bytes(), hash);
  out.put(hash);
  for (const std::uint64_t count :
       {cost.pairs_tested, cost.clusters, cost.points_tested, cost.voxels_read, cost.contacts, cost.lookups,
        cost.recognitions, cost.exact_samples, cost.solver_steps, cost.bytes_touched})
    out.put(static_cast<std::uint32_t>(count));
  for (const auto& head : heads) out.put(std::uint32_t{head->taken()});
  VERISIM_ASSERT(out.at() == row.data() + row.size());
}

}  // namespace verisim
