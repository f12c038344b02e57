// Long episodes of the contract that tests/fuzz checks call by call, with bytes of a generator in place of a fuzzer's: half of them
// calm, so that maps grow old. PLANEFOLD_EPISODES: how many (100), or PLANEFOLD_SECONDS: for how long; PLANEFOLD_SEED: which (1);
// PLANEFOLD_EPISODE: that one alone.
#include <unity.h>

#include <chrono>
#include <csignal>

#include "../fuzz/contract_episode.h"

void setUp(void) {}
void tearDown(void) {}

namespace {

long now_at = 0;
unsigned long seed = 1;

long wanted(const char* name, long usual) {
  const char* const text = std::getenv(name);
  return text != nullptr ? std::atol(text) : usual;
}

void say_where(int) {
  std::fprintf(stderr, "in episode %ld of seed %lu\n", now_at, seed);
  std::_Exit(1);
}

void play(long episode, ContractRun::Seen* all) {
  now_at = episode;
  const long refused_before = all->refused_gauge;
  play_episode(seed, episode, all);
  if (all->refused_gauge > refused_before)
    std::printf("episode %ld: %ld readings of the gauge refused\n", episode, all->refused_gauge - refused_before);
}

void test_long_episodes_should_keep_the_contract() {
  seed = static_cast<unsigned long>(wanted("PLANEFOLD_SEED", 1));
  const long only = wanted("PLANEFOLD_EPISODE", -1), seconds = wanted("PLANEFOLD_SECONDS", 0);
  const long last = wanted("PLANEFOLD_EPISODES", seconds > 0 ? 1000000000 : 100);
  std::signal(SIGABRT, say_where);
  ContractRun::Seen all{};
  const auto begin = std::chrono::steady_clock::now();
  long episode = std::max(only, 0L);
  for (; only >= 0 ? episode == only : episode < last; ++episode) {
    if (seconds > 0 && std::chrono::steady_clock::now() - begin > std::chrono::seconds(seconds)) break;
    play(episode, &all);
    if (episode % 100 != 99) continue;
    std::printf("%ld episodes, %ld frames\n", episode + 1, all.frames);
    std::fflush(stdout);
  }
  std::printf(
      "seed %lu, %ld episodes, %ld frames: %ld tracked, %ld with planes, %ld with patches, %ld metric, %ld repaired; "
      "%ld readings of the gauge refused\n",
      seed, only >= 0 ? 1 : episode, all.frames, all.tracked, all.planes, all.patches, all.metric, all.repaired,
      all.refused_gauge);
  TEST_ASSERT_TRUE(all.frames > 0);
}

}  // namespace

int main() {
  UNITY_BEGIN();
  RUN_TEST(test_long_episodes_should_keep_the_contract);
  return UNITY_END();
}
