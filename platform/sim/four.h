#pragma once

#include <cstdint>

namespace pf::sim {

/// Four numbers that go the same way through a formula. Each lane rounds as a float does, on every processor.
using Four = float __attribute__((vector_size(16)));
/// Four integers; as a condition each is 0 or -1.
using FourInts = std::int32_t __attribute__((vector_size(16)));

inline Four four(float x) { return Four{x, x, x, x}; }
inline FourInts four(std::int32_t i) { return FourInts{i, i, i, i}; }
inline bool any(FourInts condition) { return (condition[0] | condition[1] | condition[2] | condition[3]) != 0; }
inline bool all_equal(FourInts i) { return !any(i != four(i[0])); }

}  // namespace pf::sim
