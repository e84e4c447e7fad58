#include "engine/constraint/recognition.hpp"

#include "engine/constraint/recognizers.hpp"

namespace verisim {

Constraint recognize(const Entity& a, const Entity& b, const Tolerances& tolerances) {
  return recognize_by<Recognizers>(a, b, tolerances);
}

}  // namespace verisim
