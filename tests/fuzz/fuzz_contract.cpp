// The whole contract (lib/docs/results/robustness.md): a config that is right, then calls in any order, most of which mean something and
// some of which are hostile. Every status is one that the header names, what is refused or only asks leaves the block as it was, nothing
// is written outside of the block, and what comes out is finite, with covariances that are covariances, already before the getters mend
// what rounding left of them. slow/test_contract_episodes.cpp draws longer ones.
#include <planefold/planefold.h>

#include "contract_run.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Bytes bytes(data, size);
  ContractRun run(bytes);
  if (run.usable()) run.play();
  return 0;
}
