// `restore`: degree-of-freedom restoration (dissertation section 8.4.2). Each contact's force, before the sum, loses
// what opposes a motion that a recognized constraint leaves free.
//
// An implicit step needs the matrices of restored contacts, so it restores their normals before anything is computed
// from them. An explicit one needs forces alone, and its stiffness stays that of the voxels' contacts.
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
  void act_on_forces(ContactList& contacts, const Pose& X_AB) override {
    sets_.restore_forces(contacts, X_AB);
    look_ups_ = sets_.look_ups();
  }

 private:
  SetLookUp sets_;
};

constinit const MethodByPair<RestorePair> kRestore("restore", 10);

}  // namespace

constinit const Hybrid hybrid::restore = &kRestore;

}  // namespace verisim
