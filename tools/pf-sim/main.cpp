// pf-sim: rendered sequences on disk, and Monte Carlo runs of the filter against geometric truth.

#include <CLI/CLI.hpp>

#include "../lib/command_line.h"
#include "commands.h"
#include "planefold_platform/version.h"

int main(int argc, char** argv) {
  CLI::App app{"Simulations: rendered sequences, and Monte Carlo runs against exact truth"};
  app.require_subcommand(1);
  app.set_version_flag("--version", "pf-sim " PF_VERSION_TEXT);
  int result = 0;
  pfsim::add_render(app, result);
  pfsim::add_room(app, result);
  pfsim::add_gee2007(app, result);
  pfsim::add_rendered(app, result);
  pfsim::add_kidnap(app, result);
  pfsim::add_rest(app, result);
  pfsim::add_box(app, result);
  pfsim::add_street(app, result);
  pfsim::add_loop(app, result);
  pfsim::add_vio(app, result);
  pfsim::add_templates(app, result);
  pf::tools::check_numbers(app, {"--k1", "--focal-error", "--delay", "--turn"});
  int code = 0;
  return pf::tools::parse_command_line(app, "pf-sim", argc, argv, code) ? result : code;
}
