// Whose arm it is: measured impedances and tremors, and how persons differ.
//
//              mass kg  damping N s/m  stiffness N/m   source
//   measured   0.554    6.45           135             one trial of one participant, arm in a posture, handle of a
//                                                      HapticMaster (van Beek et al. 2015, Sci. Rep. 5:18004, figure 3)
//   drawn      each of these between half and twice that, by the seed: log-uniform. That persons, directions and grips
//              differ is reported (Fu & Cavusoglu, three-dimensional arm models for a stylus; Hasser & Cutkosky:
//              stiffness and damping of a pinch grow with its force); the factor of two is an order of magnitude.
//
//   tremor of a drawn person: 0.05 to 0.25 mm rms, log-uniform, if none is given: from eye surgeons who hold an
//   instrument still (49 um rms, Riviere, Rader & Khosla 1997) to a braced instrument without sight of it (254 um rms
//   in the worst axis of a typical subject, PMC3032442, figure 4).
#pragma once

#include "engine/device/hand.hpp"

namespace verisim {

/// Gives the hand the mass, damping and stiffness, and a drawn one the tremor, that its `arm` says.
void become(HandDescription& hand);

}  // namespace verisim
