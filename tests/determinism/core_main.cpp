// A body pulled by a spring for ten thousand steps, and the hash of where it ends.
#include <cstdio>

#include "engine/base/hash.hpp"
#include "engine/base/pose.hpp"

int main() {
  verisim::Vector3d w{0.1, 0.2, 0.3};
  verisim::Quaterniond q = verisim::Quaterniond::Identity();
  for (int i = 0; i < 10000; ++i) q = (q * verisim::rotation_from_vector(w * (1.0 / (i + 1)))).normalized();
  std::puts(verisim::to_hex(verisim::hash_bytes(q.coeffs().data(), 32, 0)).c_str());
}
