// As many updates of 20 rows on a state of 300 as asked for, with the fastest kernel set: what is counted under emulation.
#include <cstdlib>

#include "covariance/select.h"
#include "covariance_problem.h"

int main(int argc, char** argv) {
  const pf::Kernels* kernels = pf::select_kernels(0);
  bench::Problem problem(300, 20);
  for (int i = 0; argc > 1 && i < std::atoi(argv[1]); ++i) problem.update(*kernels, 0, 0, 0);
  return pf::kernels_id(kernels) == 5 ? 0 : 1;
}
