#include "engine/robot/rolling_base.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "engine/base/contract.hpp"
#include "engine/base/error.hpp"

namespace verisim::robot {
namespace {

constexpr int kTrialsMax = 12;
// A flank is left or met by more than what sums of this size round to.
constexpr double kGapRounding = 1e-13;    // rad
constexpr double kTorqueRounding = 1e-9;  // N m

int sign_of(double x) {
  return x < 0 ? -1 : 1;
}

/// Of the stretches.
double squares(const WheelState& w) {
  return w.stretch_along * w.stretch_along + w.stretch_across * w.stretch_across +
         w.stretch_rolling * w.stretch_rolling;
}

}  // namespace

RollingBase::RollingBase(const PlantParameters& parameters, double step)
    : parameters_(parameters.wheel),
      gear_(parameters.gear),
      motor_inertia_(parameters.motor.inertia),
      motor_dry_friction_(dry_friction(parameters.motor)),
      wheel_radius_(parameters.geometry.wheel_radius),
      h_(step),
      per_h_(1 / step),
      motor_inertia_per_h_(motor_inertia_ / step),
      wheel_inertia_per_h_(parameters.wheel.inertia / step),
      per_ratio_(1 / parameters.gear.ratio),
      half_backlash_(parameters.gear.backlash / 2),
      hold_(parameters.wheel.stiffness * step + parameters.wheel.damping),
      per_stiffness_(1 / parameters.wheel.stiffness),
      mass_(parameters.body.mass, parameters.body.mass, parameters.body.inertia),
      mass_per_h_(mass_ / step) {
  VERISIM_ASSERT(is_positive(step));
  const auto [cx, cy] = parameters.body.centre_of_mass;
  for (std::size_t i = 0; i < kWheels; ++i) {
    const auto [p, a] = wheel_place(parameters.geometry, i);
    const auto row = [&, x = p[0] - cx, y = p[1] - cy](double ax, double ay) {
      return Vector3d(ax, ay, x * ay - y * ax);
    };
    place_[i] = {row(a[0], a[1]), row(-a[1], a[0]), wheel_radius_ * a[0], wheel_radius_ * -a[1]};
  }
}

double RollingBase::efficiency_factor(const Guess& guess) const {
  return guess.motor == guess.flank ? gear_.efficiency : 1 / gear_.efficiency_driven;
}

void RollingBase::eliminate(std::size_t i, const MotorDrive& drive) {
  const Guess& guess = guess_[i];
  const Place& place = place_[i];
  Elimination& e = eliminated_[i];
  e.holds_along = guess.along == 0 ? hold_ : 0;
  e.holds_across = guess.across == 0 ? hold_ : 0;
  e.holds_rolling = guess.rolling == 0 ? hold_ : 0;
  e.motor_term = motor_inertia_per_h_ + drive.torque.per_speed / 2;
  e.motor_weight = guess.flank == 0 ? 0 : gear_.ratio * efficiency_factor(guess);
  e.per_motor_term = 1 / e.motor_term;
  e.per_motor_weight = guess.flank == 0 ? 0 : 1 / e.motor_weight;
  e.q = place.lever_along * e.holds_along * place.along + place.lever_across * e.holds_across * place.across;
  const bool is_held = guess.flank != 0 && guess.motor == 0;
  const double P = wheel_inertia_per_h_ + e.motor_weight * gear_.ratio * e.motor_term +
                   place.lever_along * place.lever_along * e.holds_along +
                   place.lever_across * place.lever_across * e.holds_across +
                   wheel_radius_ * wheel_radius_ * e.holds_rolling;
  e.inverse = is_held ? 0 : 1 / P;
}

void RollingBase::factorize(const std::array<MotorDrive, kWheels>& drive) {
  Matrix3d A = mass_per_h_.asDiagonal();
  for (std::size_t i = 0; i < kWheels; ++i) {
    eliminate(i, drive[i]);
    const Elimination& e = eliminated_[i];
    A += e.holds_along * place_[i].along * place_[i].along.transpose() +
         e.holds_across * place_[i].across * place_[i].across.transpose() - e.inverse * e.q * e.q.transpose();
  }
  inverse_ = A.ldlt().solve(Matrix3d::Identity());
  factorized_ = guess_;
  is_factorized_ = true;
}

void RollingBase::solve(const std::array<MotorDrive, kWheels>& drive, const PerWheel& load, const Vector3d& wrench) {
  Vector3d b = mass_per_h_.cwiseProduct(u_) + wrench;
  for (std::size_t i = 0; i < kWheels; ++i) {
    const Guess& guess = guess_[i];
    const Elimination& e = eliminated_[i];
    const WheelState& old = before_[i];
    const double along =
        guess.along == 0 ? parameters_.stiffness * old.stretch_along : -guess.along * parameters_.friction * load[i];
    const double across = guess.across == 0 ? parameters_.stiffness * old.stretch_across
                                            : -guess.across * parameters_.roller_resistance * load[i];
    const double rolling = guess.rolling == 0 ? parameters_.stiffness * old.stretch_rolling
                                              : -guess.rolling * parameters_.rolling_resistance * load[i];
    const double catch_up = guess.flank == 0 ? 0 : (old.gap - guess.flank * half_backlash_) * per_h_;
    const double motor = (motor_inertia_per_h_ - drive[i].torque.per_speed / 2) * old.motor_speed +
                         drive[i].torque.at_rest - guess.motor * motor_dry_friction_;
    double Q = wheel_inertia_per_h_ * old.wheel_speed + place_[i].lever_along * along +
               place_[i].lever_across * across - wheel_radius_ * rolling +
               e.motor_weight * (motor + e.motor_term * gear_.ratio * catch_up);
    Q *= e.inverse;
    if (e.inverse == 0) Q = catch_up;  // the motor stands, and so the wheel
    WheelState& now = wheel_[i];
    WheelForces& forces = forces_[i];
    forces.along = -along;  // completed by follow, as the speeds are
    forces.across = -across;
    forces.rolling = -rolling;
    now.wheel_speed = Q;
    now.motor_speed = guess.flank == 0 ? (guess.motor == 0 ? 0 : motor * e.per_motor_term) : catch_up;
    b += e.q * Q - place_[i].along * along - place_[i].across * across;
  }
  u_new_ = inverse_.col(0) * b.x() + inverse_.col(1) * b.y() + inverse_.col(2) * b.z();
}

/// What the wheel does when the base moves as solved.
void RollingBase::follow(std::size_t i, const MotorDrive& drive) {
  const Guess& guess = guess_[i];
  const Elimination& e = eliminated_[i];
  const Place& place = place_[i];
  const WheelState& old = before_[i];
  WheelState& now = wheel_[i];
  WheelForces& forces = forces_[i];
  now.wheel_speed += e.inverse * e.q.dot(u_new_);
  if (guess.flank != 0)  // what solve left there is catch_up
    now.motor_speed = guess.motor == 0 ? 0 : gear_.ratio * (now.wheel_speed - now.motor_speed);
  forces.slip = place.along.dot(u_new_) - place.lever_along * now.wheel_speed;
  forces.roll = place.across.dot(u_new_) - place.lever_across * now.wheel_speed;
  forces.along -= e.holds_along * forces.slip;
  forces.across -= e.holds_across * forces.roll;
  forces.rolling -= e.holds_rolling * wheel_radius_ * now.wheel_speed;
  forces.gear_torque = guess.flank == 0 ? 0
                                        : wheel_inertia_per_h_ * (now.wheel_speed - old.wheel_speed) +
                                              place.lever_along * forces.along + place.lever_across * forces.across -
                                              wheel_radius_ * forces.rolling;
  if (guess.motor == 0) {
    forces.gear_load = forces.gear_torque * per_ratio_;
    forces.motor_friction =
        forces.gear_load - drive.torque.at_rest - (motor_inertia_per_h_ - drive.torque.per_speed / 2) * old.motor_speed;
  } else {
    forces.gear_load = forces.gear_torque * e.per_motor_weight;
    forces.motor_friction = -guess.motor * motor_dry_friction_;
  }
}

int RollingBase::corrected_flank(std::size_t i) const {
  const Guess& guess = guess_[i];
  const WheelState& now = wheel_[i];
  const WheelForces& forces = forces_[i];
  if (guess.flank != 0) return guess.flank * forces.gear_torque < -kTorqueRounding ? 0 : guess.flank;
  const double gap = before_[i].gap + h_ * (now.motor_speed * per_ratio_ - now.wheel_speed);
  return std::abs(gap) > half_backlash_ + kGapRounding ? sign_of(gap) : 0;
}

int RollingBase::corrected_motor(std::size_t i, const MotorDrive& drive) const {
  const Guess& guess = guess_[i];
  const WheelState& now = wheel_[i];
  const WheelForces& forces = forces_[i];
  if (drive.blocked) return 0;
  if (guess.motor != 0) return guess.motor * now.motor_speed < 0 ? 0 : guess.motor;
  // Friction must hold what drives the motor, against the gear's torque as driving or being driven would feel it.
  const double driving = forces.gear_load - forces.motor_friction;
  const double driven_load = forces.gear_load * gear_.efficiency_driven,
               driving_load = forces.gear_load / gear_.efficiency;
  if (driving > std::max(driven_load, driving_load) + motor_dry_friction_) return 1;
  if (driving < std::min(driven_load, driving_load) - motor_dry_friction_) return -1;
  return 0;
}

/// Corrects the guess by what came of it. Whether it was right.
bool RollingBase::correct(std::size_t i, const MotorDrive& drive, double load) {
  const WheelState& old = before_[i];
  const WheelState& now = wheel_[i];
  const WheelForces& forces = forces_[i];
  const auto slides = [this](double stretch, double slip, double bound) {
    const double force = -(parameters_.stiffness * stretch + hold_ * slip);
    return std::abs(force) < bound ? 0 : sign_of(force);
  };
  const int motor = corrected_motor(i, drive), flank = corrected_flank(i);
  const int along = slides(old.stretch_along, forces.slip, parameters_.friction * load);
  const int across = slides(old.stretch_across, forces.roll, parameters_.roller_resistance * load);
  const int rolling =
      slides(old.stretch_rolling, wheel_radius_ * now.wheel_speed, parameters_.rolling_resistance * load);
  Guess& guess = guess_[i];
  const bool right = motor == guess.motor && flank == guess.flank && along == guess.along && across == guess.across &&
                     rolling == guess.rolling;
  guess.motor = motor;
  guess.flank = flank;
  guess.along = along;
  guess.across = across;
  guess.rolling = rolling;
  return right;
}

void RollingBase::finish(std::size_t i) {
  WheelState& now = wheel_[i];
  const WheelForces& forces = forces_[i];
  const Guess& guess = factorized_[i];  // that of which the forces came, also where nothing settled
  now.stretch_along = guess.along == 0 ? now.stretch_along + h_ * forces.slip : -forces.along * per_stiffness_;
  now.stretch_across = guess.across == 0 ? now.stretch_across + h_ * forces.roll : -forces.across * per_stiffness_;
  now.stretch_rolling = guess.rolling == 0 ? now.stretch_rolling + h_ * wheel_radius_ * now.wheel_speed
                                           : -forces.rolling * per_stiffness_;
  now.gap =
      guess.flank == 0 ? now.gap + h_ * (now.motor_speed * per_ratio_ - now.wheel_speed) : guess.flank * half_backlash_;
}

/// Every force times the mean of the velocities before and after: that much the kinetic energies change, exactly.
void RollingBase::enter(std::size_t i, const WindingTorque& torque) {
  const WheelState& old = before_[i];
  const WheelState& now = wheel_[i];
  const WheelForces& forces = forces_[i];
  const double motor = (old.motor_speed + now.motor_speed) / 2, wheel = (old.wheel_speed + now.wheel_speed) / 2;
  const Vector3d u = (u_ + u_new_) / 2;
  const double slip = place_[i].along.dot(u) - place_[i].lever_along * wheel;
  const double roll = place_[i].across.dot(u) - place_[i].lever_across * wheel;
  book_.motors += h_ * (torque.at_rest - torque.per_speed * motor) * motor;
  book_.friction -= h_ * forces.motor_friction * motor;
  book_.gears += h_ * (forces.gear_load * motor - forces.gear_torque * wheel);
  book_.floor -= h_ * (forces.along * slip + forces.across * roll + forces.rolling * wheel_radius_ * wheel) +
                 parameters_.stiffness / 2 * (squares(now) - squares(old));
}

double RollingBase::kinetic_energy() const {
  double twice = mass_.dot(u_.cwiseProduct(u_));
  for (const WheelState& w : wheel_)
    twice += parameters_.inertia * w.wheel_speed * w.wheel_speed + motor_inertia_ * w.motor_speed * w.motor_speed;
  return twice / 2;
}

double RollingBase::stored_energy() const {
  double sum = 0;
  for (const WheelState& w : wheel_) sum += squares(w);
  return parameters_.stiffness / 2 * sum;
}

void RollingBase::step(const std::array<MotorDrive, kWheels>& drive, const PerWheel& load, const Vector3d& wrench) {
  before_ = wheel_;
  for (std::size_t i = 0; i < kWheels; ++i) {
    VERISIM_ASSERT(load[i] >= 0);
    guess_[i].conducts = drive[i].torque.per_speed > 0 ? 1 : 0;
    if (drive[i].blocked) guess_[i].motor = 0;
  }
  bool settled = false;
  for (int trial = 0; trial < kTrialsMax && !settled; ++trial) {
    if (!is_factorized_ || guess_ != factorized_) factorize(drive);
    solve(drive, load, wrench);
    settled = true;
    for (std::size_t i = 0; i < kWheels; ++i) {
      follow(i, drive[i]);
      settled = correct(i, drive[i], load[i]) && settled;
    }
  }
  unsettled_ += settled ? 0 : 1;
  floor_force_ = Vector3d::Zero();
  for (std::size_t i = 0; i < kWheels; ++i) {
    finish(i);
    enter(i, drive[i].torque);
    floor_force_ += place_[i].along * forces_[i].along + place_[i].across * forces_[i].across;
  }
  book_.outside += h_ * wrench.dot(u_ + u_new_) / 2;
  u_ = u_new_;
}

void RollingBase::turn_coordinates(double cosine, double sine) {
  const double x = u_.x();
  u_.x() = cosine * x + sine * u_.y();
  u_.y() = cosine * u_.y() - sine * x;
}

}  // namespace verisim::robot
