#pragma once

#include <random>

#include "contract_run.h"

/// Episodes of the contract that a seed tells, for tests without a fuzzer.

/// Plays one and adds what it saw. Half a megabyte of bytes, of which it takes what it needs.
inline void play_episode(unsigned long seed, long episode, ContractRun::Seen* all) {
  std::seed_seq start{static_cast<unsigned>(seed), static_cast<unsigned>(episode)};
  std::mt19937_64 draw(start);
  const bool calm = draw() % 2 == 0;
  const int steps = static_cast<int>(calm ? 100 + draw() % 900 : 5 + draw() % 400);
  std::vector<uint8_t> drawn(size_t{1} << 19);
  for (uint8_t& b : drawn) b = static_cast<uint8_t>(draw() >> 32);
  Bytes bytes(drawn.data(), drawn.size());
  ContractRun run(bytes, calm);
  if (!run.usable()) return;
  if (sizeof(pf::Scalar) == sizeof(float)) run.trust_told_repairs();
  run.play(steps);
  const ContractRun::Seen& seen = run.seen();
  all->frames += seen.frames;
  all->tracked += seen.tracked;
  all->metric += seen.metric;
  all->planes += seen.planes;
  all->patches += seen.patches;
  all->repaired += seen.repaired;
  all->refused_gauge += seen.refused_gauge;
}
