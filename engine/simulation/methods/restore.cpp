// `restore`: degree-of-freedom restoration (dissertation section 8.4.2). Each contact's force, before the sum, loses
// what opposes a motion that a recognized constraint leaves free.
//
// A contact's force is a strength times its normal, and restoration is linear in the force: so the normals are
// restored, before anything is computed from them. Spring, damper, matrices and forces are then all of the same
// direction, and what a contact gives back is what it was given.
#include "engine/simulation/methods/set_look_up.hpp"

namespace verisim {
namespace {

class RestorePair final : public PairMethod {
 public:
  explicit RestorePair(const Pair& pair) : sets_(pair) {}
  bool act_on_normals(ContactList& contacts, const Pose& X_AB) override {
    const bool any = sets_.restore_normals(contacts, X_AB);
    look_ups_ = sets_.look_ups();
    return any;
  }

 private:
  SetLookUp sets_;
};

constinit const MethodByPair<RestorePair> kRestore("restore", 10);

}  // namespace

constinit const Hybrid hybrid::restore = &kRestore;

}  // namespace verisim
