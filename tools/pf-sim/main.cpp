// pf-sim: rendered sequences on disk, and Monte Carlo runs of the filter against geometric truth.

#include <CLI/CLI.hpp>

#include "commands.h"

int main(int argc, char** argv) {
  CLI::App app{"Simulations: rendered sequences, and Monte Carlo runs against exact truth"};
  app.require_subcommand(1);
  int result = 0;
  pfsim::add_render(app, result);
  pfsim::add_room(app, result);
  pfsim::add_gee2007(app, result);
  pfsim::add_rendered(app, result);
  CLI11_PARSE(app, argc, argv);
  return result;
}
