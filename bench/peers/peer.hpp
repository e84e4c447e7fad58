// Other people's engines on one task: the driven insertion of ../shared/reference/peers/README.md, and contact queries
// at given poses. An engine gets the shapes that it is best with; whatever it is given, its errors are measured from
// poses alone, in closed form (insertion.hpp).
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/peers/insertion.hpp"

namespace verisim::peers {

class Peer {
 public:
  Peer() = default;
  virtual ~Peer() = default;
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  [[nodiscard]] virtual Motion motion() const = 0;
  /// One step of kStep. Returns the force of the hand.
  virtual Vector3d step(const Hand& hand) = 0;
  /// Puts the pin there, outside of every clock.
  virtual void place(const Pose& X_WB) = 0;
  /// What the engine says of the contacts at that pose: its deepest penetration [m]; below 0: it sees none.
  virtual double query() = 0;
};

/// An engine with one choice of what its users can choose.
struct Setting {
  std::string engine, text;
  bool round = false;     ///< it was given the round hole; else the polygon of kWedges
  bool with_hand = true;  ///< false: asked for contacts only
  std::function<std::unique_ptr<Peer>(const Insertion&, const Pose& start)> make;
};

/// Each a grid over the engine's own dials; empty if it was not there when this was built.
[[nodiscard]] std::vector<Setting> settings_here();
[[nodiscard]] std::vector<Setting> settings_of_mujoco();
[[nodiscard]] std::vector<Setting> settings_of_bullet();
[[nodiscard]] std::vector<Setting> settings_of_ode();
[[nodiscard]] std::vector<Setting> settings_of_fcl();

}  // namespace verisim::peers
