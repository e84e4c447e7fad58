// Other people's engines on two tasks: the driven insertion of ../shared/reference/peers/README.md, and contact queries
// at given poses. An engine gets the shapes that it is best with; whatever it is given, its errors are measured from
// poses alone, in closed form (insertion.hpp).
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/peers/insertion.hpp"

namespace verisim::peers {

/// A pin that is pushed.
class Pusher {
 public:
  Pusher() = default;
  virtual ~Pusher() = default;
  Pusher(const Pusher&) = delete;
  Pusher& operator=(const Pusher&) = delete;

  [[nodiscard]] virtual Motion motion() const = 0;
  /// One step of kStep. Returns the force of the hand.
  virtual Vector3d step(const Hand& hand) = 0;
};

/// A pin whose contacts are asked for.
class Finder {
 public:
  Finder() = default;
  virtual ~Finder() = default;
  Finder(const Finder&) = delete;
  Finder& operator=(const Finder&) = delete;

  /// Puts the pin there, outside of every clock.
  virtual void place(const Pose& X_WB) = 0;
  /// What the engine says of the contacts at that pose: its deepest penetration [m]; below 0: minus the gap; kNothing:
  /// it sees none.
  virtual double query() = 0;
};
inline constexpr double kNothing = -1;

/// One choice of what an engine's users can choose, in words.
struct PushSetting {
  std::string text;
  bool round = false;  ///< it was given the round hole; else the polygon of kWedges
  std::function<std::unique_ptr<Pusher>(const Insertion&, const Pose& start)> make;
};
struct FindSetting {
  std::string text;
  std::function<std::unique_ptr<Finder>(double clearance)> make;
};

/// An engine and the grids over its own dials. Without any it was not there when this was built.
struct Engine {
  std::string name, version;
  std::string package;  ///< Debian's
  std::vector<PushSetting> pushes = {};
  std::vector<FindSetting> finds = {};
};

/// This project's methods, each as an engine of its own.
[[nodiscard]] std::vector<Engine> engines_here();
[[nodiscard]] Engine peer_mujoco();
[[nodiscard]] Engine peer_bullet();
[[nodiscard]] std::vector<FindSetting> bullet_finds();
[[nodiscard]] Engine peer_ode();
[[nodiscard]] Engine peer_fcl();

}  // namespace verisim::peers
